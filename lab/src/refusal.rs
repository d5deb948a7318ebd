//! Refusals as a page takes them: in words, and as a code with its values, so that it can say them in its own language.

use std::fmt;

use fdi_core::supervisor::{FASTEST_FAN, LONGEST_SHELVING};
use fdi_core::{ConfigError, Refusal, RetuneError};
use serde_json::{Value, json};

/// What a session or a server refuses by itself.
#[derive(Clone, Debug, PartialEq)]
pub enum Refused {
    /// No setting of this name is a number that can be changed.
    Setting(String),
    /// Only a simulated rig can do this.
    NotSimulated,
    /// Only a board has a console.
    NoConsole,
    /// A recording takes no orders.
    Recorded,
    /// It goes by its own clock.
    OwnClock,
    /// No clock goes at this speed.
    Speed(f64),
    /// So many ticks at once are too many.
    Ticks(u32),
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Setting(name) => write!(f, "no setting \"{name}\" that can be changed here"),
            Self::NotSimulated => f.write_str("only a simulated rig can do this"),
            Self::NoConsole => f.write_str("only a board has a console"),
            Self::Recorded => f.write_str("a recording takes no orders"),
            Self::OwnClock => f.write_str("it goes by its own clock"),
            Self::Speed(speed) => write!(f, "speed is {speed}, expected 0 to 100"),
            Self::Ticks(ticks) => write!(f, "{ticks} ticks at once are too many"),
        }
    }
}

impl std::error::Error for Refused {}

/// The message of a refusal. `code` and `values` are there where it has a code.
pub fn message(error: &anyhow::Error) -> Value {
    let mut message = json!({ "type": "refused", "why": format!("{error:#}") });
    if let Some((code, values)) = coded(error) {
        message["code"] = json!(code);
        message["values"] = values;
    }
    message
}

fn coded(error: &anyhow::Error) -> Option<(&'static str, Value)> {
    if let Some(refused) = error.downcast_ref() {
        return Some(own(refused));
    }
    match error.downcast_ref() {
        Some(RetuneError::Config(error)) => return config(error),
        Some(RetuneError::Refused(refusal)) => return Some(instrument(refusal)),
        None => {}
    }
    error.downcast_ref().map(instrument).or_else(|| error.downcast_ref().and_then(config))
}

fn own(refused: &Refused) -> (&'static str, Value) {
    match refused {
        Refused::Setting(name) => ("setting", json!({ "name": name })),
        Refused::NotSimulated => ("not_simulated", json!({})),
        Refused::NoConsole => ("no_console", json!({})),
        Refused::Recorded => ("recorded", json!({})),
        Refused::OwnClock => ("own_clock", json!({})),
        Refused::Speed(value) => ("range", json!({ "name": "speed", "value": value, "min": 0, "max": 100 })),
        Refused::Ticks(value) => ("ticks", json!({ "value": value })),
    }
}

fn instrument(refusal: &Refusal) -> (&'static str, Value) {
    match *refusal {
        Refusal::NotInMode(mode) => ("mode", json!({ "mode": mode })),
        Refusal::CausePersists(reason) => ("persists", json!({ "trip": reason.name() })),
        Refusal::WidensLimit(name) => ("widens", json!({ "name": name })),
        Refusal::SetPoint { wanted, min, max } => {
            ("setpoint", json!({ "value": wanted, "min": min, "max": max }))
        }
        Refusal::Shelving(time) => {
            ("range", json!({ "name": "shelve", "value": time, "min": 0, "max": LONGEST_SHELVING.0 }))
        }
        Refusal::NotAtRest([t0, t1, t2]) => ("apart", json!({ "t0": t0, "t1": t1, "t2": t2 })),
        Refusal::Fan(level) => ("fan", json!({ "value": level, "min": 0, "max": FASTEST_FAN })),
    }
}

fn config(error: &ConfigError) -> Option<(&'static str, Value)> {
    match *error {
        ConfigError::NonFinite { name } => Some(("finite", json!({ "name": name }))),
        ConfigError::OutOfRange { name, value, min, max } => {
            Some(("range", json!({ "name": name, "value": value, "min": min, "max": max })))
        }
        ConfigError::NotAbove { name, value, other, limit } => {
            Some(("above", json!({ "name": name, "value": value, "other": other, "limit": limit })))
        }
        ConfigError::BeyondScale { name, value, max, times, of, scale } => {
            let values =
                json!({ "name": name, "value": value, "max": max, "times": times, "of": of, "scale": scale });
            Some(("scale", values))
        }
        ConfigError::AmbiguousRows { .. } => None,
    }
}
