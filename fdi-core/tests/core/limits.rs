//! Limits are marked where they are declared: none is widened while the heater is on, what is wider than the default is told, and none can be
//! wider than the plant's scale allows.

use fdi_core::control::Controller;
use fdi_core::settings::{Value, Wider};
use fdi_core::{
    AdcCode, Command, Config, Feedback, Instrument, Mode, RawSample, Refusal, RetuneError, Setting,
    TripReason,
};

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
            refused(|c| c.supervisor.cooling_time.0 = 65.0),
            "supervisor.cooling_time is 65, expected at most 64: 32 times identification.answer_time (2)",
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

/// A controller that is armed in a room, with what the diagnosis says of T1 from then on; in which tick it trips, and why.
fn tripped(config: &Config, found: Feedback) -> Option<(u32, TripReason)> {
    let controller = Controller::new(config).unwrap();
    let mut state = controller.start(config.setpoint);
    controller.command(&mut state, Command::Arm).unwrap();
    (0..400).find_map(|k| {
        controller.feed_back(&mut state, found);
        let code = AdcCode(AMBIENT + (k % 2) as f32);
        let raw = RawSample { t0: code, t1: code, t2: code, ..RawSample::default() };
        match controller.step(&mut state, raw).mode {
            Mode::Tripped(trip) => Some((k, trip.reason)),
            _ => None,
        }
    })
}

/// Every limit as wide as it can be at the default answer time and sample time.
fn widest() -> Config {
    let mut config = Config::default();
    let kept = ["sample_time", "identification.answer_time", "supervisor.go_on_without_t1"];
    for setting in limits().filter(|setting| !kept.contains(&setting.name)) {
        let limit = setting.limit.expect("a limit");
        let (up, answers) = (limit.wider == Wider::Above, f32::from(limit.answers) * 2.0);
        let bound =
            setting.kind.bounds().map_or(f32::from(u8::from(up)), |(min, max)| if up { max } else { min });
        let candidates = [bound, if answers > 0.0 { answers } else { 0.1 * bound + 0.9 * limit.default }];
        let wider =
            candidates.map(|x| with(&config, setting, x)).into_iter().find(|c| Instrument::new(c).is_ok());
        config = wider.unwrap_or(config); // `learn_start` is held back by `learn_end`
    }
    assert!(config.wider_than_default().count() >= 28);
    config
}

/// No settings have a part in it but the answer time, and that for five minutes at most.
#[test]
fn a_t1_that_is_named_out_of_the_tube_trips_whatever_the_settings() {
    let named = Feedback { t1_contradicted: true, ..Feedback::default() };
    // So little power that a T1 that shows nothing of it owes nothing.
    let mut config = widest();
    (config.pid.output_min.0, config.pid.output_max.0) = (0.0, 20.0);
    // All of it for 8 answer times is a set-point out of reach.
    assert_eq!(tripped(&config, Feedback::default()), Some((148, TripReason::OutOfReach)));
    // 4 answer times of 2 s are 73 ticks.
    assert_eq!(tripped(&config, named), Some((73, TripReason::T1Contradicted)));
    // What goes on by T2 and the models does not need T1.
    config.supervisor.go_on_without_t1 = true;
    let virtual_t1 = Feedback { t1_faulty: true, virtual_rise: Some(15.0), ..named };
    assert_eq!(tripped(&config, virtual_t1), None);
}

/// A T1 that stays as cold as the room while the heater works, with every other rule out of the way.
#[test]
fn power_that_t1_does_not_account_for_trips() {
    let mut config = Config::default();
    // Full power; a T1 that flickers by a count has not risen.
    config.pid.kp = 100.0;
    let (tick, reason) = tripped(&config, Feedback::default()).expect("trips");
    // A third of what is declared would have shown 8 degC after an answer time, 18 ticks.
    assert!(reason == TripReason::NoResponse && (5..40).contains(&tick), "{tick} {reason:?}");
}
