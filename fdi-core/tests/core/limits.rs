//! Limits are marked where they are declared: none is widened while the heater is on, what is wider than the default is told, and none can be
//! wider than the plant's scale allows.

use fdi_core::settings::{Value, Wider};
use fdi_core::{Command, Config, Instrument, Refusal, RetuneError, Setting};

use crate::supervision::{AMBIENT, tick};

/// Those that protect, by name and by which way they get wider: whoever takes a mark away is seen here.
const MARKED: &str = include_str!("limits.txt");

fn limits() -> impl Iterator<Item = &'static Setting> {
    Config::settings().filter(|setting| setting.limit.is_some())
}

fn with(config: &Config, setting: &Setting, x: f32) -> Config {
    let mut config = config.clone();
    let value = match config.get(setting) {
        Value::Switch(_) => Value::Switch(x != 0.0),
        _ => Value::Number(x),
    };
    assert!(config.set(setting, value), "{}", setting.name);
    config
}

/// Somewhat wider than its default, or narrower, where the bounds leave room.
fn beside(setting: &Setting, wider: bool) -> Option<Config> {
    let limit = setting.limit.expect("a limit");
    let up = (limit.wider == Wider::Above) == wider;
    let default = limit.default;
    let x = match setting.kind.bounds() {
        None => f32::from(u8::from(up)),
        // Other settings bound it, too: by little.
        Some(_) if up => default + 0.005 * default.abs().max(0.1),
        Some(_) => default - 0.005 * default.abs().max(0.1),
    };
    let config = with(&Config::default(), setting, x);
    (x != default && Instrument::new(&config).is_ok()).then_some(config)
}

#[test]
fn the_marked_ones_are_those_that_protect() {
    let told = |setting: &Setting| {
        let limit = setting.limit.expect("a limit");
        let side = if limit.wider == Wider::Above { "above" } else { "below" };
        match limit.answers {
            0 => format!("{} {side} {}", setting.name, limit.default),
            n => format!("{} {side} {} within {n} answers", setting.name, limit.default),
        }
    };
    let marked: Vec<_> = limits().map(told).collect();
    assert_eq!(marked, MARKED.lines().collect::<Vec<_>>(), "write them into limits.txt if that is meant");
}

#[test]
fn no_marked_limit_is_widened_while_the_heater_is_on() {
    let mut widened = 0;
    for setting in limits() {
        let mut instrument = Instrument::new(&Config::default()).unwrap();
        instrument.command(Command::Arm).unwrap();
        tick(&mut instrument, AMBIENT, 0);
        if let Some(config) = beside(setting, true) {
            let refused = RetuneError::Refused(Refusal::WidensLimit(setting.name));
            assert_eq!(instrument.retune(&config), Err(refused), "{}", setting.name);
            widened += 1;
        }
        if let Some(config) = beside(setting, false) {
            instrument.retune(&config).unwrap_or_else(|e| panic!("{} is made narrower: {e}", setting.name));
        }
    }
    // All but `pid.output_max`, of which nothing is wider.
    assert_eq!(widened, limits().count() - 1);
}

#[test]
fn what_is_wider_than_the_default_is_told_and_nothing_else() {
    assert_eq!(Config::default().wider_than_default().count(), 0);
    for setting in limits() {
        let told = |config: Config| config.wider_than_default().map(|wider| wider.name).collect::<Vec<_>>();
        if let Some(config) = beside(setting, true) {
            assert_eq!(told(config), [setting.name]);
        }
        if let Some(config) = beside(setting, false) {
            assert!(told(config).is_empty(), "{}", setting.name);
        }
    }
}

#[test]
fn what_the_plants_scale_does_not_allow_is_refused_with_the_reason() {
    let refused = |change: fn(&mut Config)| {
        let mut config = Config::default();
        change(&mut config);
        Instrument::new(&config).map(drop).expect_err("too wide").to_string()
    };
    for (text, expected) in [
        (
            refused(|c| c.supervisor.response_time.0 = 33.0),
            "supervisor.response_time is 33, expected at most 32: 16 times identification.answer_time (2)",
        ),
        (
            refused(|c| c.identification.answer_time.0 = 0.45),
            "supervisor.signal_timeout is 0.5, expected at most 0.45: 1 times identification.answer_time (0.45)",
        ),
        (
            refused(|c| c.supervisor.max_disagreement.0 = 14.0),
            "supervisor.max_disagreement is 14, expected at most 13.75: 0.25 times supervisor.over_temperature above a room of 20 degC (55)",
        ),
        (
            refused(|c| (c.plausibility.max.0, c.supervisor.over_temperature.0) = (300.0, 111.0)),
            "supervisor.over_temperature is 111, expected at most 110: 2 times supervisor.setpoint_max above a room of 20 degC (45)",
        ),
    ] {
        assert_eq!(text, expected);
    }
}
