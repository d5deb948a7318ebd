//! Values of settings as text: what the console and a trace show and read. They differ in how they show and read a number.

use core::fmt::{self, Display};

use fdi_core::settings::{Form, Kind, Value};

use super::error::Expected;
use crate::decimal;

/// Writes a value, without its unit; a number as `number` shows it.
///
/// # Errors
/// Those of the formatter.
pub fn write<N: Display>(
    f: &mut fmt::Formatter<'_>,
    kind: Kind,
    value: Value,
    number: fn(f32) -> N,
) -> fmt::Result {
    match value {
        Value::Number(x) => number(x).fmt(f),
        Value::Whole(x) => u32::from(x).fmt(f),
        Value::Switch(x) => f.write_str(if x { "true" } else { "false" }),
        Value::Choice { form, numbers } => {
            let Kind::Choice(forms) = kind else { return Ok(()) };
            let Some(form) = forms.get(form) else { return Ok(()) };
            f.write_str(form.word)?;
            numbers.iter().take(form.numbers.len()).try_for_each(|x| write!(f, " {}", number(*x)))
        }
    }
}

/// Reads a value of a kind; a number as `number` reads it.
///
/// # Errors
/// What was expected instead.
pub fn parse(kind: Kind, text: &str, number: impl Fn(&str) -> Option<f32>) -> Result<Value, Expected> {
    match kind {
        Kind::Number { .. } => number(text).map(Value::Number).ok_or(Expected::Words(decimal::EXPECTED)),
        Kind::Whole { min, max } => {
            decimal::whole(text).map(Value::Whole).ok_or(Expected::Whole { min, max })
        }
        Kind::Switch => text.parse().map(Value::Switch).map_err(|_| Expected::Words("true or false")),
        Kind::Choice(forms) => choice(forms, text, number).ok_or(Expected::Forms(forms)),
    }
}

/// A form's word, and its numbers behind it.
fn choice(forms: &[Form], text: &str, read: impl Fn(&str) -> Option<f32>) -> Option<Value> {
    let mut words = text.split_ascii_whitespace();
    let word = words.next()?;
    let form = forms.iter().position(|form| form.word == word)?;
    let mut numbers = [0.0; 2];
    for number in numbers.iter_mut().take(forms.get(form)?.numbers.len()) {
        *number = read(words.next()?)?;
    }
    words.next().is_none().then_some(Value::Choice { form, numbers })
}
