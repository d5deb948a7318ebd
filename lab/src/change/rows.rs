//! Rows in a trace: of the signature tables, and faults that were taught, each by its place from 1 and the text that the console has for it.
//!
//! `diagnosis.isolation.4=4 0 +1 0 -1 0 hand;likelihood.taught.1=cap 0 0 0 0 150 -150 0 0 0 0 0`; `none` for one that has gone.

use anyhow::Context;
use fdi_core::Config;
use fdi_core::diagnosis::signature::{Pattern, Rows, Signature, WIDTH};
use fdi_core::likelihood::taught::{EFFECTS, Response, Responses};
use fdi_core::name::Name;

/// Rows of a configuration, as text.
struct Table {
    /// The beginning of their names.
    start: &'static str,
    texts: fn(&Config) -> Vec<String>,
    /// `None` where a text is no row, or where there are too many.
    put: fn(&mut Config, &[String]) -> Option<()>,
}

static TABLES: [Table; 3] = [
    Table {
        start: "diagnosis.detection.",
        texts: |config| config.diagnosis.detection.iter().map(signature_text).collect(),
        put: |config, texts| signatures(texts).map(|rows| config.diagnosis.detection = rows),
    },
    Table {
        start: "diagnosis.isolation.",
        texts: |config| config.diagnosis.isolation.iter().map(signature_text).collect(),
        put: |config, texts| signatures(texts).map(|rows| config.diagnosis.isolation = rows),
    },
    Table {
        start: "likelihood.taught.",
        texts: |config| config.likelihood.taught.iter().map(response_text).collect(),
        put: |config, texts| responses(texts).map(|rows| config.likelihood.taught = rows),
    },
];

/// The rows of `to` that `from` has not, and those that have gone: of these the last first, since those behind a row move up.
pub(super) fn between(from: &Config, to: &Config) -> Vec<String> {
    TABLES.iter().flat_map(|table| table.between(from, to)).collect()
}

/// Sets a row where this is the name of one; `None` where it is not.
pub(super) fn set(config: &mut Config, name: &str, words: &str) -> Option<anyhow::Result<()>> {
    let (table, place) = TABLES.iter().find_map(|table| Some((table, name.strip_prefix(table.start)?)))?;
    Some(table.set(config, place, words).with_context(|| format!("{name} can't be {words:?}")))
}

impl Table {
    fn between(&self, from: &Config, to: &Config) -> Vec<String> {
        let (old, new) = ((self.texts)(from), (self.texts)(to));
        let gone = (new.len()..old.len()).rev().map(|i| (i, "none"));
        let changed = new.iter().enumerate().filter(|(i, text)| old.get(*i) != Some(text));
        let all = gone.chain(changed.map(|(i, text)| (i, text.as_str())));
        all.map(|(i, text)| format!("{}{}={text}", self.start, i + 1)).collect()
    }

    fn set(&self, config: &mut Config, place: &str, words: &str) -> Option<()> {
        let mut texts = (self.texts)(config);
        let i = place.parse::<usize>().ok()?.checked_sub(1)?;
        match words {
            "none" => drop(texts.drain(i.min(texts.len())..texts.len().min(i + 1))),
            _ if i == texts.len() => texts.push(words.to_owned()),
            _ => words.clone_into(texts.get_mut(i)?),
        }
        (self.put)(config, &texts)
    }
}

fn signature_text(row: &Signature) -> String {
    format!("{} {} {}", row.number, row.pattern, row.name).trim_end().to_owned()
}

fn signatures(texts: &[String]) -> Option<Rows> {
    let rows: Vec<Signature> = texts.iter().map(|text| signature(text)).collect::<Option<_>>()?;
    Rows::from_slice(&rows).ok()
}

fn signature(text: &str) -> Option<Signature> {
    let words: Vec<&str> = text.split(' ').collect();
    let (number, rest) = words.split_first()?;
    let (pattern, name) = rest.split_at_checked(WIDTH)?;
    let pattern: Pattern = pattern.join(" ").parse().ok()?;
    let name = match name {
        [] => Name::NONE,
        [name] => name.parse().ok()?,
        _ => return None,
    };
    Some(Signature { number: number.parse().ok()?, pattern, name })
}

fn response_text(response: &Response) -> String {
    let effects: String = response.effects.iter().map(|effect| format!(" {effect}")).collect();
    format!("{}{effects}", response.name)
}

fn responses(texts: &[String]) -> Option<Responses> {
    let rows: Vec<Response> = texts.iter().map(|text| response(text)).collect::<Option<_>>()?;
    Responses::from_slice(&rows).ok()
}

fn response(text: &str) -> Option<Response> {
    let (name, effects) = text.split_once(' ')?;
    let effects: Vec<i16> = effects.split(' ').map(|effect| effect.parse().ok()).collect::<Option<_>>()?;
    let effects: [i16; EFFECTS] = effects.try_into().ok()?;
    Some(Response { name: name.parse().ok()?, effects })
}

#[cfg(test)]
mod tests {
    use super::super::{apply, between};
    use super::*;

    const CAP: &str = "likelihood.taught.1=cap 0 0 0 0 150 -150 0 0 0 0 -32768";
    const HAND: &str = "diagnosis.isolation.4=4 0 +1 0 -1 x hand";

    fn with(text: &str) -> Config {
        let mut config = Config::default();
        apply(&mut config, text).unwrap();
        config
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
