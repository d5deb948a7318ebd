//! Settings in a trace: in what one configuration differs from another, as text that leads to the same bits again.
//!
//! `pid.kp=3;identification.adaptation=forgetting 0.99`; rows of tables by their places.

mod rows;

use anyhow::Context;
use fdi_core::settings::{Form, Kind, Value};
use fdi_core::{Config, Setting};

/// The settings in force, and what a trace has yet to tell of them: on its first row those that are not the defaults, on another what has
/// changed before it; a `|` stands before each change that follows something on its row, and before each that comes with the first.
#[derive(Clone, Debug)]
pub struct Settings {
    in_force: Config,
    untold: String,
    begun: bool,
}

impl Settings {
    /// Those at the start.
    pub fn new(start: &Config) -> Self {
        Self { in_force: start.clone(), untold: between(&Config::default(), start), begun: false }
    }

    /// The settings in force.
    pub fn in_force(&self) -> &Config {
        &self.in_force
    }

    /// Others are in force now.
    pub fn change(&mut self, to: Config) {
        if !self.begun || !self.untold.is_empty() {
            self.untold.push('|');
        }
        self.untold += &between(&self.in_force, &to);
        self.in_force = to;
    }

    /// Whether there is something to tell.
    pub fn tell(&self) -> bool {
        !self.untold.is_empty()
    }

    /// What the row that comes next has to tell.
    pub fn take(&mut self) -> String {
        self.begun = true;
        std::mem::take(&mut self.untold)
    }
}

/// In what `to` differs from `from`; empty where in nothing.
pub fn between(from: &Config, to: &Config) -> String {
    let changed = Config::settings().filter(|setting| from.get(setting) != to.get(setting));
    let texts = changed.map(|setting| format!("{}={}", setting.name, text(setting, to.get(setting))));
    texts.chain(rows::between(from, to)).collect::<Vec<_>>().join(";")
}

/// Puts what such a text says into a configuration; whether it is in bounds is for the core to judge.
///
/// # Errors
/// A setting that there is not, or a value that it cannot have.
pub fn apply(config: &mut Config, text: &str) -> anyhow::Result<()> {
    for change in text.split(';').filter(|change| !change.is_empty()) {
        let (name, words) = change.split_once('=').with_context(|| format!("{change:?} is no setting"))?;
        match rows::set(config, name, words) {
            Some(done) => done?,
            None => set(config, setting(name)?, words)?,
        }
    }
    Ok(())
}

/// Sets what is written as a number, true or false, or a form's word with its numbers.
pub(crate) fn set(config: &mut Config, setting: &Setting, words: &str) -> anyhow::Result<()> {
    let value = value(setting.kind, words).filter(|value| config.set(setting, *value));
    value.map(drop).with_context(|| format!("{} can't be {words:?}", setting.name))
}

pub(crate) fn setting(name: &str) -> anyhow::Result<&'static Setting> {
    Config::settings().find(|setting| setting.name == name).with_context(|| format!("no setting {name:?}"))
}

fn text(setting: &Setting, value: Value) -> String {
    match (value, setting.kind) {
        (Value::Number(x), _) => x.to_string(),
        (Value::Whole(x), _) => x.to_string(),
        (Value::Switch(on), _) => on.to_string(),
        (Value::Choice { form, numbers }, Kind::Choice(forms)) => {
            let Some(Form { word, numbers: wanted }) = forms.get(form) else { return String::new() };
            let numbers = numbers.iter().take(wanted.len()).map(|x| format!(" {x}"));
            format!("{word}{}", numbers.collect::<String>())
        }
        (Value::Choice { .. }, _) => String::new(),
    }
}

fn value(kind: Kind, text: &str) -> Option<Value> {
    match kind {
        Kind::Number { .. } => text.parse().ok().map(Value::Number),
        Kind::Whole { .. } => text.parse().ok().map(Value::Whole),
        Kind::Switch => text.parse().ok().map(Value::Switch),
        Kind::Choice(forms) => {
            let mut words = text.split(' ');
            let word = words.next()?;
            let form = forms.iter().position(|form| form.word == word)?;
            let mut numbers = [0.0; 2];
            for number in numbers.iter_mut().take(forms[form].numbers.len()) {
                *number = words.next()?.parse().ok()?;
            }
            words.next().is_none().then_some(Value::Choice { form, numbers })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset;

    #[test]
    fn what_is_told_leads_to_the_same_settings() {
        for name in ["oven", "hotend", "tclab"] {
            let to = preset::config(name).unwrap();
            let mut config = Config::default();
            apply(&mut config, &between(&Config::default(), &to)).unwrap();
            assert_eq!(config, to, "{name}");
        }
        assert_eq!(between(&Config::default(), &Config::default()), "");
        for (text, words) in [("kp", "no setting"), ("pid.kq=1", "pid.kq"), ("pid.kp=much", "much")] {
            let error = apply(&mut Config::default(), text).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
