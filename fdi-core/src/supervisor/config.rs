//! Settings of the supervisor, their bounds, and which of them may not be widened while the heater is on.

use crate::bounds::first_raised;
use crate::diagnosis::baseline::MIN_SAMPLES;
use crate::error::{ConfigError, above};
use crate::settings::{check, settings};
use crate::units::{Celsius, Percent, Seconds};

settings! {
    /// Supervisor: modes and trips.
    pub struct SupervisorConfig: Supervisor "supervisor." {
        /// Learning begins no earlier than this after arming.
        learn_start: Seconds = 180.0, 0.0..=86400.0;
        /// Learning ends no earlier than this; it takes `learn_end - learn_start` of accepted samples.
        learn_end: Seconds = 360.0, 0.0..=86400.0;
        /// "In regulation": the low-passed control error is within this share of the set-point.
        regulation_band: Percent = 5.0, 0.1..=100.0;
        /// In regulation, unsaturated and excited for so long before learning begins.
        regulation_time: Seconds = 20.0, 0.0..=3600.0;
        /// Smallest excitation, after saturation, that counts as one.
        min_excitation: Percent = 0.5, 0.01..=50.0;
        /// T1 or T2 above this switches the heater off.
        over_temperature: Celsius = 75.0, 30.0..=349.0;
        /// T1 without a valid sample for longer than this switches the heater off, whatever the reason.
        signal_timeout: Seconds = 0.5, 0.0..=5.0;
        /// Full power for so long, while T1 has not risen by `min_response` since arming, switches the heater off. Longer
        /// than the dead time and the lag of the rig.
        response_time: Seconds = 8.0, 1.0..=3600.0;
        /// The least that full power must do to T1.
        min_response: Celsius = 3.0, 0.5..=50.0;
        /// Power above what was learnt for the set-point by more than this, while T1 does not rise, switches the heater off.
        max_excess_power: Percent = 75.0, 10.0..=10000.0;
        /// How long the power may stay above that.
        excess_power_time: Seconds = 3.5, 1.0..=3600.0;
        /// T2 above T1 by more than this, beyond their learnt difference, switches the heater off.
        max_disagreement: Celsius = 5.5, 2.0..=100.0;
        /// How long T2 may stay above that; longer than T2 lags behind T1.
        disagreement_time: Seconds = 1.2, 0.2..=3600.0;
        /// Without power the rise of T1 and T2 must fall by a tenth in every such time, else the heater counts as stuck on.
        cooling_time: Seconds = 15.0, 5.0..=3600.0;
        /// Once T1 is named faulty, or breaks, go on with T2 through the models of the likelihood diagnosis; else what is broken
        /// trips and what reads wrong is only told. Set-point limits and over-temperature hold all the same.
        go_on_without_t1: bool = false;
        /// Air flow surely below this share of normal switches the heater off; 0 never does.
        min_air_flow: Percent = 50.0, 0.0..=95.0;
        /// The board refuses to arm until its self-test has passed since power-on. Only its control loop enforces it.
        check_before_arming: bool = true;
        /// Lowest set-point that is accepted.
        setpoint_min: Celsius = 20.0, 0.0..=300.0;
        /// Highest set-point that is accepted.
        setpoint_max: Celsius = 65.0, 0.0..=300.0;
    }
}

impl SupervisorConfig {
    /// Checks every setting, by itself and against those of the supervisor that it depends on.
    pub(super) fn validate(&self, sample_time: Seconds) -> Result<(), ConfigError> {
        check(Self::SETTINGS[0], self)?;
        let shortest = self.learn_start.0 + MIN_SAMPLES * sample_time.0;
        above("supervisor.learn_end", self.learn_end.0, "supervisor.learn_start + 100 samples", shortest)?;
        let (lowest, highest) = (self.setpoint_min.0, self.setpoint_max.0);
        above("supervisor.setpoint_max", highest, "supervisor.setpoint_min", lowest)?;
        above("supervisor.over_temperature", self.over_temperature.0, "supervisor.setpoint_max", highest)
    }

    /// The first limit that `new` would widen. While the heater is on, none may be.
    pub(super) fn widened(&self, new: &Self) -> Option<&'static str> {
        let limits = [
            ("supervisor.over_temperature", self.over_temperature.0, new.over_temperature.0),
            ("supervisor.signal_timeout", self.signal_timeout.0, new.signal_timeout.0),
            ("supervisor.response_time", self.response_time.0, new.response_time.0),
            ("supervisor.max_excess_power", self.max_excess_power.0, new.max_excess_power.0),
            ("supervisor.excess_power_time", self.excess_power_time.0, new.excess_power_time.0),
            ("supervisor.max_disagreement", self.max_disagreement.0, new.max_disagreement.0),
            ("supervisor.disagreement_time", self.disagreement_time.0, new.disagreement_time.0),
            ("supervisor.cooling_time", self.cooling_time.0, new.cooling_time.0),
            ("supervisor.setpoint_max", self.setpoint_max.0, new.setpoint_max.0),
            // Smaller ones are wider.
            ("supervisor.min_response", new.min_response.0, self.min_response.0),
            ("supervisor.min_air_flow", new.min_air_flow.0, self.min_air_flow.0),
        ];
        if new.go_on_without_t1 && !self.go_on_without_t1 {
            return Some("supervisor.go_on_without_t1");
        }
        first_raised(&limits)
    }
}
