//! The table of settings: ids that outlive every update, bounds that the constructors enforce, defaults within them.

use fdi_core::settings::{Kind, Value};
use fdi_core::{Config, ConfigError, Instrument};

/// Every id that was ever given, a line each: id, name, and `retired` behind it once the setting is gone.
const IDS: &str = include_str!("setting_ids.txt");

/// Id, name, and whether it is retired.
fn ids() -> Vec<(u16, &'static str, bool)> {
    let lines = IDS.lines().filter(|line| !line.starts_with('#'));
    let words = lines.map(|line| line.split(' ').collect::<Vec<_>>());
    words
        .map(|words| (u16::from_str_radix(words[0], 16).unwrap(), words[1], words.get(2) == Some(&"retired")))
        .collect()
}

#[test]
fn an_id_once_given_is_kept_or_retired_and_never_given_again() {
    let ids = ids();
    for (i, (id, name, _)) in ids.iter().enumerate() {
        assert!(ids[..i].iter().all(|(other, ..)| other != id), "{id:04x} {name}: the id is there twice");
    }
    for setting in Config::settings() {
        let line = format!("{:04x} {}", setting.id, setting.name);
        let known = ids.iter().find(|(id, ..)| *id == setting.id);
        let Some((_, name, retired)) = known else {
            panic!(
                "a new setting: add {line:?} to setting_ids.txt; a renamed one: declare its former name with `was`"
            )
        };
        assert!(!retired, "{line}: this id was {name}, which is retired: choose another name");
        assert_eq!(*name, setting.name, "renamed: write {line:?} into setting_ids.txt");
    }
    for (id, name, retired) in &ids {
        let there = Config::settings().any(|setting| setting.id == *id);
        assert!(there != *retired, "{id:04x} {name} is no setting any more: write `retired` behind it");
    }
}

/// What a former name gave as id is the id still.
#[test]
fn a_renamed_setting_keeps_its_id() {
    let id = |name: &str| {
        let hash =
            name.bytes().fold(0x811C_9DC5u32, |hash, b| (hash ^ u32::from(b)).wrapping_mul(0x0100_0193));
        (hash ^ hash >> 16) as u16
    };
    let mut renamed = 0;
    for group in Config::documented() {
        for (setting, about) in group.settings.iter().zip(group.settings_about) {
            assert_eq!(setting.id, id(about.was.unwrap_or(setting.name)), "{}", setting.name);
            renamed += u32::from(about.was.is_some());
        }
    }
    assert!(renamed >= 8, "{renamed}");
}

/// A number just outside of its bounds is refused with its name and them; the default and the bounds are allowed.
#[test]
fn the_constructors_enforce_the_declared_bounds() {
    for setting in Config::settings() {
        let default = Config::default();
        assert_eq!(setting.check(default.get(setting)), Ok(()), "{}", setting.name);
        let Some((min, max)) = setting.kind.bounds() else { continue };
        for outside in [min - 0.01 * min.abs().max(1.0), max + 0.01 * max.abs().max(1.0), f32::NAN] {
            let value = match setting.kind {
                Kind::Whole { .. } if outside > max && max < 65535.0 => Value::Whole(max as u16 + 1),
                Kind::Whole { .. } => Value::Whole(0),
                _ => Value::Number(outside),
            };
            let mut config = default.clone();
            if !config.set(setting, value) {
                continue; // more than the type of the field holds
            }
            match Instrument::new(&config).expect_err(setting.name) {
                ConfigError::OutOfRange { name, min: lowest, max: highest, .. } => {
                    assert_eq!((name, lowest, highest), (setting.name, min, max));
                }
                error => assert_eq!(error, ConfigError::NonFinite { name: setting.name }),
            }
        }
    }
}

#[test]
fn numbers_of_a_form_have_bounds_too() {
    let adaptation = Config::settings().find(|setting| setting.name == "identification.adaptation").unwrap();
    for (form, numbers, name) in [
        (0, [0.4, 0.0], "identification.adaptation.forgetting.lambda"),
        (1, [2.0, 1.0], "identification.adaptation.random-walk.r1"),
        (1, [0.0, f32::NAN], "identification.adaptation.random-walk.r2"),
    ] {
        let mut config = Config::default();
        assert!(config.set(adaptation, Value::Choice { form, numbers }));
        let error = Instrument::new(&config).unwrap_err().to_string();
        assert!(error.starts_with(name), "{error}");
    }
}

#[test]
fn a_value_of_another_kind_changes_nothing() {
    for setting in Config::settings() {
        let mut config = Config::default();
        let wrong = if setting.kind == Kind::Switch { Value::Number(1.0) } else { Value::Switch(true) };
        assert!(!config.set(setting, wrong), "{}", setting.name);
        assert_eq!(config, Config::default());
    }
}
