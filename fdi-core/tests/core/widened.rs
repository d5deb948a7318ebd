//! Each limit of the supervisor by itself: wider at rest only, narrower at any time.

use fdi_core::settings::Value;
use fdi_core::{Command, Config, Instrument, Refusal, RetuneError};

use crate::supervision::{AMBIENT, tick};

/// Each limit, a little wider and a little narrower than its default.
const LIMITS: [(&str, f32, f32); 7] = [
    ("supervisor.over_temperature", 76.0, 74.0),
    ("supervisor.signal_timeout", 0.55, 0.45),
    ("supervisor.max_disagreement", 5.6, 5.4),
    ("supervisor.disagreement_time", 1.3, 1.1),
    ("supervisor.cooling_time", 15.5, 14.5),
    ("supervisor.min_air_flow", 49.0, 51.0),
    ("supervisor.setpoint_max", 66.0, 64.0),
];

#[test]
fn each_limit_is_widened_at_rest_only() {
    for (name, wider, narrower) in LIMITS {
        let with = |value| {
            let mut config = Config::default();
            let setting = Config::settings().find(|setting| setting.name == name).expect("a setting");
            assert!(config.set(setting, Value::Number(value)));
            config
        };
        let mut instrument = Instrument::new(&Config::default()).unwrap();
        instrument.command(Command::Arm).unwrap();
        tick(&mut instrument, AMBIENT, 0);
        let refused = Err(RetuneError::Refused(Refusal::WidensLimit(name)));
        assert_eq!(instrument.retune(&with(wider)), refused);
        instrument.retune(&with(narrower)).unwrap_or_else(|e| panic!("{name}, narrower: {e}"));
        assert_eq!(instrument.retune(&Config::default()), refused, "nor back again");
        instrument.command(Command::Stop).unwrap();
        instrument.retune(&with(wider)).unwrap_or_else(|e| panic!("{name}, at rest: {e}"));
    }
}
