//! Values of settings as text: what the console shows and reads.

use core::fmt::{self, Display};

use fdi_core::settings::{Form, Kind, Value};

use super::error::Expected;
use crate::decimal::{self, Short};

/// Writes a value, without its unit.
pub(super) fn write(f: &mut fmt::Formatter<'_>, kind: Kind, value: Value) -> fmt::Result {
    match value {
        Value::Number(x) => Short(x).fmt(f),
        Value::Whole(x) => x.fmt(f),
        Value::Switch(x) => f.write_str(if x { "true" } else { "false" }),
        Value::Choice { form, numbers } => {
            let Kind::Choice(forms) = kind else { return Ok(()) };
            let Some(form) = forms.get(form) else { return Ok(()) };
            f.write_str(form.word)?;
            numbers.iter().take(form.numbers.len()).try_for_each(|x| write!(f, " {}", Short(*x)))
        }
    }
}

/// Reads a value of a kind.
///
/// # Errors
/// What was expected instead.
pub(super) fn parse(kind: Kind, text: &str) -> Result<Value, Expected> {
    match kind {
        Kind::Number { .. } => {
            decimal::parse(text).map(Value::Number).ok_or(Expected::Words(decimal::EXPECTED))
        }
        Kind::Whole { min, max } => text.parse().map(Value::Whole).map_err(|_| Expected::Whole { min, max }),
        Kind::Switch => text.parse().map(Value::Switch).map_err(|_| Expected::Words("true or false")),
        Kind::Choice(forms) => choice(forms, text).ok_or(Expected::Forms(forms)),
    }
}

/// A form's word, and its numbers behind it.
fn choice(forms: &[Form], text: &str) -> Option<Value> {
    let mut words = text.split_ascii_whitespace();
    let word = words.next()?;
    let form = forms.iter().position(|form| form.word == word)?;
    let mut numbers = [0.0; 2];
    for number in numbers.iter_mut().take(forms.get(form)?.numbers.len()) {
        *number = decimal::parse(words.next()?)?;
    }
    words.next().is_none().then_some(Value::Choice { form, numbers })
}
