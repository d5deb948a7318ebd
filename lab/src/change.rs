//! Settings in a trace: in what one configuration differs from another, as text that leads to the same bits again.
//!
//! `pid.kp=3;identification.adaptation=forgetting 0.99`, each as the console takes it. Rows of tables stand by their places, `none` for one that has gone:
//! `diagnosis.isolation.4=4 0 +1 0 -1 0 hand;likelihood.taught.1=cap 0 0 0 0 150 -150 0 0 0 0 0`.

use std::cmp::Reverse;
use std::fmt;

use anyhow::Context;
use fdi_core::Config;
use firmware_logic::settings::SetError;
use firmware_logic::settings::schema::Name;
use firmware_logic::settings::text::{parse, write};

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

/// In what `to` differs from `from`, rows of tables that have gone last: of a table the last row first, since those behind a row move up.
pub fn differing(from: &Config, to: &Config) -> impl Iterator<Item = Name> {
    let mut gone: Vec<(usize, Name)> = Name::all(from)
        .filter_map(|name| match name {
            Name::Row(table, place) => (place >= table.rows(to).len()).then_some((place, name)),
            Name::Response(place) => (place >= to.likelihood.taught.len()).then_some((place, name)),
            Name::Entry(_) => None,
        })
        .collect();
    gone.sort_by_key(|(place, _)| Reverse(*place));
    Name::all(to).filter(|name| !name.same(from, to)).chain(gone.into_iter().map(|(_, name)| name))
}

/// In what `to` differs from `from`, as text; empty where in nothing.
pub fn between(from: &Config, to: &Config) -> String {
    let texts = differing(from, to).map(|name| format!("{name}={}", text(name, to)));
    texts.collect::<Vec<_>>().join(";")
}

/// Puts what such a text says into a configuration; whether it is in bounds is for the core to judge.
///
/// # Errors
/// A setting that there is not, or a value that it cannot have.
pub fn apply(config: &mut Config, text: &str) -> anyhow::Result<()> {
    for change in text.split(';').filter(|change| !change.is_empty()) {
        let (name, words) = change.split_once('=').with_context(|| format!("{change:?} is no setting"))?;
        set(config, name, words)?;
    }
    Ok(())
}

/// Sets what is written as on the console, a number with any count of digits. A row that is to go may have gone before.
pub(crate) fn set(config: &mut Config, name: &str, words: &str) -> anyhow::Result<()> {
    let unfit = || format!("{name} can't be {words:?}");
    let told = |error: SetError<'_>| anyhow::anyhow!("{error}");
    match Name::find(name).map_err(told).with_context(unfit)? {
        Name::Entry(setting) => {
            let value = parse(setting.kind, words, |number| number.parse().ok()).ok();
            value.filter(|value| config.set(setting, *value)).map(drop).with_context(unfit)
        }
        row if words == "none" && row.value(config).to_string() == "none" => Ok(()),
        row => row.set(config, name, words).map_err(told).with_context(unfit),
    }
}

/// The text that [`set`] reads back to the same bits.
fn text(name: Name, config: &Config) -> String {
    match name {
        Name::Entry(setting) => {
            fmt::from_fn(|f| write(f, setting.kind, config.get(setting), |x| x)).to_string()
        }
        row => row.value(config).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset;

    const CAP: &str = "likelihood.taught.1=cap 0 0 0 0 150 -150 0 0 0 0 -32768";
    const HAND: &str = "diagnosis.isolation.4=4 0 +1 0 -1 x hand";

    fn with(text: &str) -> Config {
        let mut config = Config::default();
        apply(&mut config, text).unwrap();
        config
    }

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

    #[test]
    fn rows_are_told_as_the_console_has_them() {
        let taught = with(&format!("{HAND};{CAP}"));
        assert_eq!(
            (taught.diagnosis.isolation.len(), taught.likelihood.taught[0].effects[10]),
            (4, i16::MIN)
        );
        assert_eq!(between(&Config::default(), &taught), format!("{HAND};{CAP}"));
        assert_eq!(
            between(&taught, &Config::default()),
            "diagnosis.isolation.4=none;likelihood.taught.1=none"
        );
    }

    /// Rows that go, change and come lead to the same tables again, in force already or not.
    #[test]
    fn what_is_told_leads_to_the_same_rows() {
        let all = [
            Config::default(),
            with(CAP),
            with(&format!("{HAND};{CAP};likelihood.taught.2=low 1 2 3 4 5 6 7 8 9 10 11;pid.kp=3")),
            with("diagnosis.detection.2=none;diagnosis.detection.1=none;diagnosis.isolation.1=none"),
        ];
        for (from, to) in all.iter().flat_map(|from| all.iter().map(move |to| (from, to))) {
            let (mut config, told) = (from.clone(), between(from, to));
            for _ in 0..2 {
                apply(&mut config, &told).unwrap();
                assert_eq!(&config, to, "{told}");
            }
        }
    }

    #[test]
    fn what_is_no_row_is_refused() {
        let cap = CAP.split_once('=').unwrap().1;
        let eleven: Vec<String> = (1..=11).map(|place| format!("likelihood.taught.{place}={cap}")).collect();
        for wrong in [
            &eleven.join(";"),
            &format!("likelihood.taught.2={cap}"),
            &format!("likelihood.taught.0={cap}"),
            &format!("{CAP} 1"),
            "likelihood.taught.1=cap 1 2",
            "diagnosis.isolation.4=4 0 +1 0 -1",
            "diagnosis.isolation.4=4 0 +1 0 -1 x two words",
        ] {
            let error = apply(&mut Config::default(), wrong).unwrap_err().to_string();
            assert!(error.contains("can't be"), "{error}");
        }
    }
}
