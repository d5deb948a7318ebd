//! Settings of the supervisor, their bounds, and which of them may not be widened while the heater is on.

use crate::diagnosis::baseline::MIN_SAMPLES;
use crate::error::{ConfigError, above};
use crate::settings::{check, settings};
use crate::units::{Celsius, Percent, Seconds};

// Times are within four times what their defaults are in answer times, up to the next power of two; and within 600 s, twice what the slowest
// preset needs.
settings! {
    /// Supervisor: modes and trips.
    pub struct SupervisorConfig: Supervisor "supervisor." {
        /// Learning begins no earlier than this after arming.
        learn_start: Seconds = 180.0, 0.0..=86400.0, limit above;
        /// Learning ends no earlier than this; it takes `learn_end - learn_start` of accepted samples.
        learn_end: Seconds = 360.0, 0.0..=86400.0, limit above;
        /// "In regulation": the low-passed control error is within this share of the set-point.
        regulation_band: Percent = 5.0, 0.1..=100.0, limit below;
        /// Learning begins when the rig has been in regulation, unsaturated and excited for this time.
        regulation_time: Seconds = 20.0, 0.0..=3600.0, limit above;
        /// Smallest excitation, after saturation, that counts as one.
        min_excitation: Percent = 0.5, 0.01..=50.0, limit above;
        /// T1 or T2 above this switches the heater off.
        over_temperature: Celsius = 75.0, 30.0..=349.0, limit above;
        /// T1 without a valid sample for longer than this switches the heater off, whatever the reason.
        signal_timeout: Seconds = 0.5, 0.0..=5.0, limit above within 1 answers;
        /// T2 above T1 by more than this, beyond their learnt difference, switches the heater off.
        max_disagreement: Celsius = 5.5, 2.0..=100.0, limit above;
        /// How long T2 may stay above `max_disagreement`; longer than T2 lags behind T1.
        disagreement_time: Seconds = 1.2, 0.2..=600.0, limit above within 4 answers;
        /// Without power the rise of T1 and T2 must fall by a tenth in every such time, else the heater counts as stuck on.
        cooling_time: Seconds = 15.0, 2.0..=600.0, limit above within 32 answers;
        /// On: if T1 is named faulty or breaks, heating goes on by T2 and the models of the likelihood diagnosis (the virtual T1). Off: a broken
        /// T1 trips, and one that reads wrong is only reported. Set-point limits and over-temperature hold in either case.
        go_on_without_t1: bool = false, limit on;
        /// An air flow that is surely below this share of normal switches the heater off. With 0 it never does.
        min_air_flow: Percent = 50.0, 0.0..=95.0, limit below;
        /// The board refuses to arm until its self-test has passed since power-on. Only its control loop enforces it.
        check_before_arming: bool = true, limit off;
        /// Lowest set-point that is accepted.
        setpoint_min: Celsius = 20.0, 0.0..=300.0;
        /// Highest set-point that is accepted.
        setpoint_max: Celsius = 65.0, 0.0..=300.0, limit above;
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
}
