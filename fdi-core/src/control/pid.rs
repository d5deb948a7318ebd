//! Digital PID in velocity form (paper, section 2.2).
//!
//! ```text
//! u[k] = u[k-1] + Kp ( -(y[k] - y[k-1]) + Ts/Ti e[k] - Td/Ts (y[k] - 2 y[k-1] + y[k-2]) ),   clamped
//! ```
//!
//! At a constant set-point this is the paper's law, for `e[k] - e[k-1] = -(y[k] - y[k-1])`. A change of the set-point
//! enters by the integral part alone and a change of the gains alters increments only, so neither bumps the output.
//! The clamped output is the only memory of the integral part: it cannot wind up.
//!
//! ```
//! use fdi_core::control::pid::{Pid, PidConfig, PidState};
//! use fdi_core::{Celsius, Percent, Seconds};
//!
//! let pid = Pid::new(&PidConfig::default(), Seconds(0.11))?;
//! let (mut state, mut y, mut power) = (PidState::default(), 20.0, Percent(0.0));
//! for _ in 0..200 {
//!     y += 0.2 * (20.0 + 0.3 * power.0 - y); // a plant of first order: 0.3 degC per % above 20 degC
//!     power = pid.step(&mut state, Celsius(35.0), Celsius(y));
//! }
//! assert!((y - 35.0).abs() < 0.1);
//! # Ok::<(), fdi_core::ConfigError>(())
//! ```

use crate::bounds::bounded;
use crate::error::{ConfigError, above};
use crate::settings::{check, settings};
use crate::units::{Celsius, Percent, Seconds};

settings! {
    /// Temperature controller: a PID in velocity form. Kp K = 0.72 with the reference rig: stable, gain margin 5.
    pub struct PidConfig: Pid "pid." {
        /// Proportional gain Kp.
        kp: f32 = 2.4, 0.0..=1000.0, in "%/degC";
        /// Integral time Ti.
        ti: Seconds = 0.5, 0.01..=1e4;
        /// Derivative time Td.
        td: Seconds = 0.075, 0.0..=100.0;
        /// Lowest output.
        output_min: Percent = 0.0, 0.0..=20.0, limit above;
        /// Highest output.
        output_max: Percent = 100.0, 0.0..=100.0, limit above;
    }
}

/// A validated PID: the gains of the recursion, in % per degC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pid {
    kp: f32,
    /// Kp Ts / Ti.
    ki: f32,
    /// Kp Td / Ts.
    kd: f32,
    min: f32,
    max: f32,
}

/// The memory of a [`Pid`].
#[derive(Clone, Copy, Debug, Default)]
pub struct PidState {
    output: f32,
    /// y[k-1] and y[k-2], and how many of the two are from the ticks just before.
    y1: f32,
    y2: f32,
    known: u8,
}

impl Pid {
    /// Builds the recursion for the sample time.
    ///
    /// # Errors
    /// The parameter that is out of bounds.
    pub fn new(c: &PidConfig, sample_time: Seconds) -> Result<Self, ConfigError> {
        check(PidConfig::SETTINGS[0], c)?;
        above("pid.output_max", c.output_max.0, "pid.output_min", c.output_min.0)?;
        Ok(Self {
            kp: c.kp,
            ki: c.kp * sample_time.0 / c.ti.0,
            kd: c.kp * c.td.0 / sample_time.0,
            min: c.output_min.0,
            max: c.output_max.0,
        })
    }

    /// One step on a valid measurement; both inputs must be finite.
    pub fn step(&self, state: &mut PidState, setpoint: Celsius, y: Celsius) -> Percent {
        let y = y.0;
        let mut change = self.ki * (setpoint.0 - y);
        if state.known >= 1 {
            change -= self.kp * (y - state.y1);
        }
        if state.known >= 2 {
            change -= self.kd * (y - 2.0 * state.y1 + state.y2);
        }
        let output = self.clamp(state.output + change);
        *state = PidState { output, y1: y, y2: state.y1, known: (state.known + 1).min(2) };
        Percent(output)
    }

    /// From here on another sensor is regulated, which reads `y` now: the step from the one to the other is no change of
    /// the temperature, and must not act as one.
    pub fn change_sensor(&self, state: &mut PidState, y: Celsius) {
        let step = y.0 - state.y1;
        state.y1 += step;
        state.y2 += step;
    }

    /// A tick without a measurement: the output is held, and the derivative waits for two samples in a row.
    pub fn hold(&self, state: &mut PidState) -> Percent {
        state.known = state.known.min(1);
        state.output = self.clamp(state.output);
        Percent(state.output)
    }

    /// Adds the excitation and saturates: what can be applied.
    pub fn saturate(&self, output: Percent, excitation: Percent) -> Percent {
        Percent(self.clamp(output.0 + excitation.0))
    }

    /// Whether an output lies at one of the limits.
    pub fn at_limit(&self, output: Percent) -> bool {
        output.0 <= self.min || output.0 >= self.max
    }

    /// Limits to the output range; the lower limit where the argument is NaN.
    fn clamp(&self, x: f32) -> f32 {
        bounded(x, self.min, self.max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What T1 has moved over a gap is no change within a tick.
    #[test]
    fn the_derivative_waits_for_two_samples_behind_one_that_is_lost() {
        let pid = Pid::new(&PidConfig::default(), Seconds(0.11)).unwrap();
        let mut state = PidState::default();
        for _ in 0..3 {
            pid.step(&mut state, Celsius(35.0), Celsius(30.0));
        }
        let held = pid.hold(&mut state).0;
        let without = held + pid.ki * (35.0 - 31.0) - pid.kp * (31.0 - 30.0);
        assert_eq!(pid.step(&mut state, Celsius(35.0), Celsius(31.0)).0, without);
    }
}
