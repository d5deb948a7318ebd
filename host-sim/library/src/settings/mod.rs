//! The instrument's settings as files: read from TOML, written as commented TOML and as a table for the documents. What a
//! setting is called, does, and may be comes from its declaration in `fdi-core`.

mod markdown;
#[cfg(test)]
mod tables;
mod toml_text;
mod tuning;

use std::path::Path;

use anyhow::Context;
use fdi_core::settings::{Form, Kind, Value};
use fdi_core::{Config, Setting};
use pt326_lab::preset::TEXTS;
use toml::Table;

pub use markdown::markdown;
pub use toml_text::{commented_toml, commented_toml_of};
pub use tuning::tuning;

/// Reads a configuration; keys that the file leaves out have their defaults. Without a path all have.
///
/// # Errors
/// The file, and the line and key that are wrong.
pub fn read(path: Option<&Path>) -> anyhow::Result<Config> {
    read_over(Table::new(), path)
}

/// The same over the settings of a preset, which are those of the keys that the file leaves out.
///
/// # Errors
/// The file, and the line and key that are wrong.
pub fn read_over(preset: Table, path: Option<&Path>) -> anyhow::Result<Config> {
    let Some(path) = path else { return from_table(preset) };
    let place = || path.display().to_string();
    let text = std::fs::read_to_string(path).with_context(|| format!("can't read {}", place()))?;
    let mut config = parse(&text).with_context(place)?;
    if !preset.is_empty() {
        let mut table = preset;
        merge(&mut table, &text.parse().with_context(place)?);
        config = from_table(table).with_context(place)?;
    }
    fdi_core::Instrument::new(&config).with_context(place)?;
    Ok(config)
}

/// What the settings of a preset change; nothing for any other name.
///
/// # Errors
/// The text is no TOML, which a test excludes.
pub fn preset(name: &str) -> anyhow::Result<Table> {
    let text = TEXTS.iter().find(|(known, _)| *known == name).map_or("", |(_, text)| text);
    Ok(text.parse()?)
}

/// Puts every key of `over` into `table`.
pub fn merge(table: &mut Table, over: &Table) {
    for (key, value) in over {
        match (table.get_mut(key), value) {
            (Some(toml::Value::Table(inner)), toml::Value::Table(over)) => merge(inner, over),
            _ => drop(table.insert(key.clone(), value.clone())),
        }
    }
}

/// Reads a configuration from text, without a check of its bounds.
fn parse(text: &str) -> anyhow::Result<Config> {
    let explain = |error| match text.parse() {
        Ok(table) => explained(error, &table),
        Err(_) => error.into(),
    };
    toml::from_str(text).map_err(explain)
}

/// A configuration from a table, without a check of its bounds.
///
/// # Errors
/// The key that is wrong.
pub fn from_table(table: Table) -> anyhow::Result<Config> {
    table.clone().try_into().map_err(|error| explained(error, &table))
}

/// The error, with the new name of a setting that stands in the table under its former name.
fn explained(error: toml::de::Error, table: &Table) -> anyhow::Error {
    let names = Config::documented().flat_map(|group| group.settings.iter().zip(group.settings_about));
    let mut renamed = names.filter_map(|(setting, about)| Some((about.was?, setting.name)));
    match renamed.find(|(was, _)| stands_in(table, was)) {
        Some((was, name)) => anyhow::Error::from(error).context(format!("{was} was renamed to {name}")),
        None => error.into(),
    }
}

/// Whether a table has a value of this name.
fn stands_in(table: &Table, name: &str) -> bool {
    match name.split_once('.') {
        Some((head, rest)) => {
            table.get(head).and_then(|inner| inner.as_table()).is_some_and(|inner| stands_in(inner, rest))
        }
        None => table.contains_key(name),
    }
}

/// The table of TOML that a group of settings is; `None` for those that are in none.
fn table_of(settings: &[Setting]) -> Option<&'static str> {
    Some(settings.first()?.name.rsplit_once('.')?.0)
}

/// What a setting may be, in words.
fn range(setting: &Setting) -> String {
    match (setting.kind, setting.kind.bounds()) {
        (_, Some((min, max))) => format!("{} to {}", short(min), short(max)),
        (Kind::Choice(forms), _) => forms.iter().map(form_range).collect::<Vec<_>>().join(", or "),
        _ => "true or false".into(),
    }
}

/// A form with the bounds of its numbers.
fn form_range(form: &Form) -> String {
    let numbers = form.numbers.iter().map(|n| format!(" {} {} to {}", n.key, short(n.min), short(n.max)));
    form.word.to_owned() + &numbers.collect::<Vec<_>>().join(",")
}

/// A number without its many zeros.
fn short(x: f32) -> String {
    if x != 0.0 && !(1e-4..1e6).contains(&x.abs()) { format!("{x:e}") } else { format!("{x}") }
}

/// The form that a value has, with its numbers.
fn form(kind: Kind, value: Value) -> Option<(&'static Form, Vec<f32>)> {
    let (Kind::Choice(forms), Value::Choice { form, numbers }) = (kind, value) else {
        return None;
    };
    let form = forms.get(form)?;
    Some((form, numbers[..form.numbers.len()].to_vec()))
}

#[cfg(test)]
mod tests {
    use firmware_logic::settings::schema::Name;

    use super::*;

    #[test]
    fn commented_toml_gives_the_defaults_and_has_every_setting() {
        let text = commented_toml();
        assert_eq!(parse(&text).unwrap(), Config::default());
        let table: Table = text.parse().unwrap();
        for setting in Config::settings() {
            assert!(stands_in(&table, setting.name), "{}", setting.name);
        }
    }

    /// The lab reads presets line by line.
    #[test]
    fn a_preset_is_the_same_to_the_lab() {
        for (name, _) in TEXTS {
            let config = from_table(preset(name).unwrap()).unwrap();
            assert_ne!(config, Config::default());
            assert_eq!(config, pt326_lab::preset::config(name).unwrap(), "{name}");
        }
        assert!(preset("paper").unwrap().is_empty());
    }

    /// A value that a setting has not by default, as TOML and as the console reads it.
    fn another(setting: &Setting) -> (String, String) {
        let default = Config::default().get(setting);
        match (setting.kind, default) {
            (Kind::Number { .. }, Value::Number(x)) => {
                let (min, max) = setting.kind.bounds().unwrap();
                let other = if x == max { min } else { max };
                (format!("{other:?}"), format!("{other:e}"))
            }
            (Kind::Whole { .. }, Value::Whole(x)) => (format!("{}", x + 1), format!("{}", x + 1)),
            (Kind::Switch, Value::Switch(on)) => (format!("{}", !on), format!("{}", !on)),
            (Kind::Choice(forms), _) => {
                let form = forms[1];
                let numbers = form.numbers.iter().map(|n| (n.key, (n.min + n.max) / 2.0));
                let keys: Vec<_> = numbers.clone().map(|(key, x)| format!("{key} = {x:?}")).collect();
                let words: String = numbers.map(|(_, x)| format!(" {x}")).collect();
                let toml = match keys.is_empty() {
                    true => format!("{:?}", form.word),
                    false => format!("{{ {} = {{ {} }} }}", form.word, keys.join(", ")),
                };
                (toml, form.word.to_owned() + &words)
            }
            _ => panic!("{}: its value is of another kind", setting.name),
        }
    }

    #[test]
    fn every_setting_reaches_toml_console_and_listing_alike() {
        let defaults = Config::default();
        let listing: Vec<String> =
            firmware_logic::settings::listing::lines(&defaults).map(|line| line.to_string()).collect();
        for setting in Config::settings() {
            let (toml, words) = another(setting);
            let read = parse(&format!("{} = {toml}", setting.name)).unwrap();
            assert_ne!(read, defaults, "{}", setting.name);
            let mut typed = defaults.clone();
            let name = Name::find(setting.name).unwrap();
            name.set(&mut typed, setting.name, &words).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(typed, read, "{}", setting.name);
            assert!(!name.same(&typed, &defaults), "{}", setting.name);
            let line = listing.iter().find(|line| line.starts_with(&format!("{} = ", setting.name))).unwrap();
            assert_eq!(line.ends_with(')'), setting.kind.bounds().is_some(), "{line}");
        }
    }

    #[test]
    fn wrong_keys_and_values_are_named_with_their_line() {
        let error = |text: &str| format!("{:#}", parse(text).unwrap_err());
        let unknown = error("setpoint = 30\n[pid]\nkq = 1\n");
        assert!(unknown.contains("line 3") && unknown.contains("kq") && unknown.contains("kp"), "{unknown}");
        let kind = error("setpoint = 30\n[prbs]\nbits = 9.5\n");
        assert!(kind.contains("line 3") && kind.contains("9.5") && kind.contains("u8"), "{kind}");
    }

    #[test]
    fn a_former_name_is_told_the_new_one() {
        let error = format!("{:#}", parse("\n[parity]\nfit_time = 50.0\n").unwrap_err());
        let told = "parity.fit_time was renamed to likelihood.fit_time";
        assert!(error.contains(told) && error.contains("line 2"), "{error}");
        let table = "[plausibility]\nroom_stuck_time = 1.0".parse().unwrap();
        let error = format!("{:#}", from_table(table).unwrap_err());
        assert!(error.contains("renamed to plausibility.ambient_stuck_time"), "{error}");
    }

    #[test]
    fn the_document_is_not_stale() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/settings.md");
        let committed = std::fs::read_to_string(path).unwrap();
        assert!(committed == markdown(), "stale: cargo run -- config --markdown > docs/settings.md");
    }
}
