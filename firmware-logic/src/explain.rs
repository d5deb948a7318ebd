//! The refusals of the core as text. `fdi-core` has texts of its own, with the conversions of `core`; these are for the
//! board, where those would take a tenth of the flash.

use core::fmt;

use fdi_core::supervisor::{FASTEST_FAN, LONGEST_SHELVING};
use fdi_core::{ConfigError, Refusal};

use crate::decimal::{Fixed, Short};

/// A refusal, to be shown.
pub struct Explained<'a, T>(pub &'a T);

impl fmt::Display for Explained<'_, ConfigError> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self.0 {
            ConfigError::NonFinite { name } => write!(f, "{name} must be a finite number"),
            ConfigError::OutOfRange { name, value, min, max } => {
                write!(f, "{name} is {}, expected {} to {}", Short(value), Short(min), Short(max))
            }
            ConfigError::NotAbove { name, value, other, limit } => {
                write!(f, "{name} is {}, expected more than {other} ({})", Short(value), Short(limit))
            }
            ConfigError::BeyondScale { name, value, max, times, of, scale } => {
                let [value, max, times, scale] = [value, max, times, scale].map(Short);
                write!(f, "{name} is {value}, expected at most {max}: {times} times {of} ({scale})")
            }
            ConfigError::AmbiguousRows { name, first, second } => {
                let (first, second) = (first + 1, second + 1); // as the console numbers them
                write!(
                    f,
                    "{name}: rows {first} and {second} match the same symptoms, expected at most one to match"
                )
            }
        }
    }
}

impl fmt::Display for Explained<'_, Refusal> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self.0 {
            Refusal::NotInMode(mode) => write!(f, "not possible in mode {mode}"),
            Refusal::CausePersists(reason) => {
                write!(f, "refused, for it persists (trip {}): {}", reason.number(), reason.words())
            }
            Refusal::WidensLimit(name) => {
                write!(f, "{name} can't be widened while the heater is on, expected `stop` first")
            }
            Refusal::SetPoint { wanted, min, max } => {
                let [wanted, min, max] = [wanted, min, max].map(Short);
                write!(f, "set-point {wanted} degC refused, expected {min} to {max} degC")
            }
            Refusal::Shelving(time) => {
                let [time, max] = [time, LONGEST_SHELVING.0].map(Short);
                write!(f, "shelving for {time} s refused, expected 0 to {max} s")
            }
            Refusal::NotAtRest(readings) => {
                let [t0, t1, t2] = readings.map(|t| Fixed(t, 1));
                write!(
                    f,
                    "T0, T1 and T2 read {t0}, {t1} and {t2} degC, expected within 3 degC at rest: let the rig cool, `check` it"
                )
            }
            Refusal::Fan(level) => {
                let [level, max] = [level, FASTEST_FAN].map(Short);
                write!(f, "fan level {level} % refused, expected 0 to {max} %")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::{Config, Instrument, Percent};

    use super::*;

    #[test]
    fn says_the_same_as_the_core() {
        let mut config = Config::default();
        config.pid.kp = -1.0;
        let mut slow = Config::default();
        slow.supervisor.cooling_time.0 = 100.0;
        let errors = [
            Instrument::new(&config).expect_err("below its bounds"),
            Instrument::new(&slow).expect_err("more than its answer time allows"),
            ConfigError::NonFinite { name: "pid.kp" },
            ConfigError::NotAbove { name: "a", value: 0.5, other: "b", limit: Percent(2.25).0 },
        ];
        for error in errors {
            assert_eq!(Explained(&error).to_string(), error.to_string());
        }
        let set_point = Refusal::SetPoint { wanted: 99.5, min: 20.0, max: 65.0 };
        for refusal in [
            Refusal::NotInMode("off"),
            set_point,
            Refusal::Shelving(1e6),
            Refusal::Fan(250.5),
            Refusal::NotAtRest([22.04, 29.96, 30.0]),
        ] {
            assert_eq!(Explained(&refusal).to_string(), refusal.to_string());
        }
    }
}
