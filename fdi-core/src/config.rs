//! The configuration as plain data; the paper's values are the default. It becomes something that steps only through a
//! constructor that checks it, such as [`crate::Instrument::new`].

use crate::control::pid::PidConfig;
use crate::control::prbs::PrbsConfig;
use crate::diagnosis::DiagnosisConfig;
use crate::error::{ConfigError, in_range};
use crate::identify::observer::IdentificationConfig;
use crate::likelihood::LikelihoodConfig;
use crate::sense::plausibility::PlausibilityConfig;
use crate::sense::thermistor::ThermistorConfig;
use crate::supervisor::SupervisorConfig;
use crate::units::{Celsius, Seconds};

/// Everything that a user can set.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Config {
    /// Sample time Ts.
    pub sample_time: Seconds,
    /// Set-point of T1.
    pub setpoint: Celsius,
    /// Thermistor constants and calibration.
    pub sensors: SensorsConfig,
    /// Limits of what a thermistor can truly read.
    pub plausibility: PlausibilityConfig,
    /// Temperature controller.
    pub pid: PidConfig,
    /// Excitation.
    pub prbs: PrbsConfig,
    /// ARX models.
    pub identification: IdentificationConfig,
    /// Residuals, thresholds, signatures.
    pub diagnosis: DiagnosisConfig,
    /// The second opinion.
    pub likelihood: LikelihoodConfig,
    /// Modes and trips.
    pub supervisor: SupervisorConfig,
}

/// One entry a thermistor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SensorsConfig {
    /// Room.
    pub t0: ThermistorConfig,
    /// Outlet, in the loop.
    pub t1: ThermistorConfig,
    /// Outlet, downstream.
    pub t2: ThermistorConfig,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            sample_time: Seconds(0.11),
            setpoint: Celsius(35.0),
            sensors: SensorsConfig::default(),
            plausibility: PlausibilityConfig::default(),
            pid: PidConfig::default(),
            prbs: PrbsConfig::default(),
            identification: IdentificationConfig::default(),
            diagnosis: DiagnosisConfig::default(),
            likelihood: LikelihoodConfig::default(),
            supervisor: SupervisorConfig::default(),
        }
    }
}

impl Config {
    /// Checks what every part divides by, first.
    pub(crate) fn validate_sample_time(&self) -> Result<(), ConfigError> {
        in_range("sample_time", self.sample_time.0, 0.001, 10.0)
    }
}
