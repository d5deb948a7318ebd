//! Settings as text: names, values, rows of the tables, faults that were taught; what is typed is taken over whole or refused whole.

use fdi_core::Config;
use fdi_core::identify::Adaptation;
use firmware_logic::settings::SetError;
use firmware_logic::settings::schema::Name;
use proptest::prelude::*;

fn set(config: &mut Config, name: &str, value: &str) -> Result<(), String> {
    let found = Name::find(name).map_err(|error| error.to_string())?;
    found.set(config, name, value).map_err(|error| error.to_string())
}

#[test]
fn every_setting_can_be_set_to_what_it_shows() {
    let mut config = Config::default();
    config.identification.adaptation = Adaptation::RandomWalk { r1: 1e-4, r2: 0.01 };
    set(&mut config, "diagnosis.isolation.4", "4 +1 x -1 0 -1 hand").expect("a row");
    set(&mut config, "likelihood.taught.1", &format!("cap{}", " -32768".repeat(11))).expect("a response");
    for name in Name::all(&config) {
        let (text, shown) = (name.to_string(), name.value(&config).to_string());
        let unit = match name {
            Name::Entry(setting) if !setting.unit.is_empty() => format!(" {}", setting.unit),
            _ => String::new(),
        };
        let value = shown.strip_suffix(&unit).expect("the unit is behind");
        let mut copy = config.clone();
        let found = Name::find(&text).expect("its own name");
        assert_eq!(found.set(&mut copy, &text, value), Ok(()), "{text} = {value}");
        assert_eq!(copy, config, "{text}");
    }
}

#[test]
fn names_and_kinds_are_checked() {
    let mut config = Config::default();
    let mut text = |name: &str, value: &str| {
        let result = Name::find(name).and_then(|n| n.set(&mut config, name, value));
        result.expect_err(name).to_string()
    };
    assert_eq!(text("pid.kq", "1"), "no setting \"pid.kq\", see `get`");
    assert_eq!(
        text("pid.kp", "two"),
        "pid.kp: \"two\" given, expected a number of up to 7 digits, such as 35, -0.25 or 1e5"
    );
    assert_eq!(text("prbs.bits", "10.5"), "prbs.bits: \"10.5\" given, expected a whole number from 3 to 16");
    assert!(text("identification.bandwidth", "fast").contains("rise-time or residence-time"));
    assert!(
        text("identification.adaptation", "forgetting").contains("forgetting LAMBDA or random-walk R1 R2")
    );
    assert!(text("diagnosis.isolation.1", "1 0 0 0").contains("expected five of -1, 0, +1, x"));
    assert!(text("diagnosis.isolation.9", "1 0 0 0 0 0").contains("there are 3, expected one from 1 to 4"));
    assert!(matches!(Name::find("diagnosis.isolation.14"), Err(SetError::Unknown(_))));
    assert_eq!(config, Config::default(), "a refused value changes nothing");
}

#[test]
fn rows_are_added_changed_and_taken_away() {
    let mut config = Config::default();
    let mut set = |name: &str, value: &str| {
        Name::find(name).expect(name).set(&mut config, name, value).expect(value);
        config.diagnosis.isolation.len()
    };
    assert_eq!(set("diagnosis.isolation.4", "7 -1 -1 -1 -1 -1"), 4);
    assert_eq!(set("diagnosis.isolation.4", "8 -1 -1 -1 -1 0"), 4);
    assert_eq!(set("diagnosis.isolation.1", "none"), 3);
    assert_eq!(config.diagnosis.isolation[2].number, 8);
}

#[test]
fn a_row_of_the_users_own_has_a_name() {
    let mut config = Config::default();
    let name = "diagnosis.isolation.4";
    let row = Name::find(name).expect(name);
    let set = |config: &mut Config, value| row.set(config, name, value).map_err(|error| error.to_string());
    set(&mut config, "4 0 +1 0 -1 0 hand-2").expect("a row");
    for wrong in
        ["4 0 +1 0 -1 0 2hands", "4 0 +1 0 -1 hand", "4 0 +1 0 -1 0 thirteen-long", "4 0 +1 0 -1 0 a b"]
    {
        assert!(set(&mut config, wrong).is_err(), "{wrong}");
    }
    assert_eq!(row.value(&config).to_string(), "4 0 +1 0 -1 0 hand-2");
    set(&mut config, "4 0 +1 0 -1 0").expect("a row");
    assert!(config.diagnosis.isolation[3].name.is_empty(), "a row told without a name has none");
}

#[test]
fn a_fault_that_was_taught_is_a_setting() {
    let mut config = Config::default();
    let low = "low 0 -37 31 -14 -113 24 -12 82 -44 13 -4";
    assert_eq!(set(&mut config, "likelihood.taught.1", low), Ok(()));
    assert_eq!(config.likelihood.taught[0].effects[4], -113);
    for wrong in [
        "low 1 2 3",
        "low 0 0 0 0 0 0 0 0 0 0 0 1",
        "low 0 0 0 0 0 0 0 0 0 0 0",
        "7up 0 0 0 0 0 0 0 0 0 0 0",
        "low 0 0 0 0 0 0 0 0 0 0 32768",
    ] {
        let error = set(&mut config, "likelihood.taught.2", wrong).expect_err(wrong);
        assert!(error.contains("expected a name and eleven whole numbers, not all 0; or none"), "{error}");
    }
    let gap = set(&mut config, "likelihood.taught.3", low).expect_err("a gap");
    assert_eq!(gap, "likelihood.taught.3: there are 1, expected one from 1 to 2");
    assert!(set(&mut config, "likelihood.taught.11", low).is_err(), "ten fit");
    assert_eq!(config.likelihood.taught.len(), 1);
    assert_eq!(set(&mut config, "likelihood.taught.1", "none"), Ok(()));
    assert_eq!(config, Config::default());
}

#[test]
fn the_listing_tells_bounds_that_the_core_enforces() {
    let config = Config::default();
    let lines: Vec<String> =
        firmware_logic::settings::listing::lines(&config).map(|l| l.to_string()).collect();
    assert!(lines.contains(&"setpoint = 35 degC   (0 to 300)".to_owned()), "{lines:?}");
    assert!(lines.contains(&"prbs.bits = 10   (3 to 16)".to_owned()), "{lines:?}");
    assert!(lines.contains(&"diagnosis.detection.2 = 2 +1 x -1 x x".to_owned()), "{lines:?}");
}

proptest! {
    #[test]
    fn no_name_or_value_panics(name in "[a-z0-9._]{0,30}", value in "[ -~]{0,40}") {
        let mut config = Config::default();
        if let Ok(found) = Name::find(&name) {
            let _ = found.set(&mut config, &name, &value);
        }
    }
}
