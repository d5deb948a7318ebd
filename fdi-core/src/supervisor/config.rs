//! Settings of the supervisor, their bounds, and which of them may not be widened while the heater is on.

use crate::bounds::first_raised;
use crate::config::Config;
use crate::diagnosis::baseline::MIN_SAMPLES;
use crate::error::{ConfigError, above, in_range, in_ranges};
use crate::units::{Celsius, Percent, Seconds};

/// Settings of the supervisor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SupervisorConfig {
    /// Learning begins no earlier than this after arming.
    pub learn_start: Seconds,
    /// Learning ends no earlier than this; it takes `learn_end - learn_start` of accepted samples.
    pub learn_end: Seconds,
    /// "In regulation": the low-passed control error is within this share of the set-point.
    pub regulation_band: Percent,
    /// In regulation, unsaturated and excited for so long before learning begins.
    pub regulation_time: Seconds,
    /// Smallest excitation, after saturation, that counts as one.
    pub min_excitation: Percent,
    /// T1 or T2 above this switches the heater off.
    pub over_temperature: Celsius,
    /// T1 without a valid sample for longer than this switches the heater off, whatever the reason.
    pub signal_timeout: Seconds,
    /// Full power for so long, while T1 has not risen by `min_response` since arming, switches the heater off. Longer
    /// than the dead time and the lag of the rig.
    pub response_time: Seconds,
    /// The least that full power must do to T1.
    pub min_response: Celsius,
    /// Power above what was learnt for the set-point by more than this, while T1 does not rise, switches the heater off.
    pub max_excess_power: Percent,
    /// For so long it may.
    pub excess_power_time: Seconds,
    /// T2 above T1 by more than this, beyond their learnt difference, switches the heater off.
    pub max_disagreement: Celsius,
    /// For so long it may; longer than T2 lags behind T1.
    pub disagreement_time: Seconds,
    /// Without power the rise of T1 and T2 must fall by a tenth in every such time, else the heater counts as stuck on.
    pub cooling_time: Seconds,
    /// Once T1 is named faulty, or breaks, go on with T2 through the models of the likelihood diagnosis; else what is broken
    /// trips and what reads wrong is only told. Set-point limits and over-temperature hold all the same.
    pub go_on_without_t1: bool,
    /// Air flow surely below this share of normal switches the heater off; 0 never does.
    pub min_air_flow: Percent,
    /// The board refuses to arm until its self-test has passed since power-on. Only its control loop enforces it.
    pub check_before_arming: bool,
    /// Lowest set-point that is accepted.
    pub setpoint_min: Celsius,
    /// Highest set-point that is accepted.
    pub setpoint_max: Celsius,
}

impl Default for SupervisorConfig {
    fn default() -> Self {
        Self {
            learn_start: Seconds(180.0),
            learn_end: Seconds(360.0),
            regulation_band: Percent(5.0),
            regulation_time: Seconds(20.0),
            min_excitation: Percent(0.5),
            over_temperature: Celsius(75.0),
            signal_timeout: Seconds(0.5),
            response_time: Seconds(8.0),
            min_response: Celsius(3.0),
            max_excess_power: Percent(75.0),
            excess_power_time: Seconds(3.5),
            max_disagreement: Celsius(5.5),
            disagreement_time: Seconds(1.2),
            cooling_time: Seconds(15.0),
            go_on_without_t1: false,
            min_air_flow: Percent(50.0),
            check_before_arming: true,
            setpoint_min: Celsius(20.0),
            setpoint_max: Celsius(65.0),
        }
    }
}

impl SupervisorConfig {
    /// Checks every setting, by itself and against those that it depends on.
    pub(super) fn validate(config: &Config) -> Result<(), ConfigError> {
        let c = &config.supervisor;
        in_range("supervisor.learn_start", c.learn_start.0, 0.0, 86400.0)?;
        in_range("supervisor.learn_end", c.learn_end.0, 0.0, 86400.0)?;
        let shortest = c.learn_start.0 + MIN_SAMPLES * config.sample_time.0;
        above("supervisor.learn_end", c.learn_end.0, "supervisor.learn_start + 100 samples", shortest)?;
        in_ranges! {
            "supervisor.regulation_band": c.regulation_band.0, 0.1, 100.0;
            "supervisor.regulation_time": c.regulation_time.0, 0.0, 3600.0;
            "supervisor.min_excitation": c.min_excitation.0, 0.01, 50.0;
            "supervisor.over_temperature": c.over_temperature.0, 30.0, 249.0;
            "supervisor.signal_timeout": c.signal_timeout.0, 0.0, 5.0;
            "supervisor.response_time": c.response_time.0, 1.0, 3600.0;
            "supervisor.min_response": c.min_response.0, 0.5, 50.0;
            "supervisor.max_excess_power": c.max_excess_power.0, 10.0, 10000.0;
            "supervisor.excess_power_time": c.excess_power_time.0, 1.0, 3600.0;
            "supervisor.max_disagreement": c.max_disagreement.0, 2.0, 100.0;
            "supervisor.disagreement_time": c.disagreement_time.0, 0.2, 3600.0;
            "supervisor.cooling_time": c.cooling_time.0, 5.0, 3600.0;
            "supervisor.min_air_flow": c.min_air_flow.0, 0.0, 95.0;
            "supervisor.setpoint_min": c.setpoint_min.0, 0.0, 200.0;
            "supervisor.setpoint_max": c.setpoint_max.0, 0.0, 200.0;
        }?;
        above("supervisor.setpoint_max", c.setpoint_max.0, "supervisor.setpoint_min", c.setpoint_min.0)?;
        let limit = c.over_temperature.0;
        above("supervisor.over_temperature", limit, "supervisor.setpoint_max", c.setpoint_max.0)?;
        // A reading beyond what is plausible is no temperature any more: the limit must be reached before.
        above("plausibility.max", config.plausibility.max.0, "supervisor.over_temperature", limit)?;
        in_range("setpoint", config.setpoint.0, c.setpoint_min.0, c.setpoint_max.0)
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
