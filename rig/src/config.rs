//! What the rig is made of, and how much its surroundings move: data, checked before use.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Constants of the rig. Defaults: the reference rig (paper where it prints a value, else our choice; docs/theory.md).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RigConfig {
    /// Ambient temperature, degC.
    pub ambient: f64,
    /// Static gain K at T1, degC per % of heater power.
    pub gain: f64,
    /// Time constant of the heater node, s.
    pub heater_time: f64,
    /// Dead time from heater to T1, s.
    pub dead_time: f64,
    /// Lag of thermistor T1, s.
    pub t1_lag: f64,
    /// Lag of thermistor T2, s.
    pub t2_lag: f64,
    /// Transport from T1 to T2, s.
    pub t2_delay: f64,
    /// Share of the rise lost between T1 and T2.
    pub heat_loss: f64,
    /// Lag of the ambient thermistor, s.
    pub t0_lag: f64,
    /// Time constants go with air flow to the power of minus this.
    pub flow_exponent: f64,
    /// Standard deviation of the air's turbulence at T1 and at T2, degC.
    pub turbulence: f64,
    /// Correlation time of the turbulence, s.
    pub turbulence_time: f64,
    /// Standard deviation of the white measurement noise, degC.
    pub white_noise: f64,
    /// Bits of the ADC; codes are given on the 12-bit scale whatever their number.
    pub adc_bits: u32,
    /// Thermistors: resistance at 25 degC, ohm.
    pub r25: f64,
    /// Thermistors: beta, K.
    pub beta: f64,
    /// Pull-up from VDDA to the ADC input, ohm.
    pub pull_up: f64,
}

impl Default for RigConfig {
    fn default() -> Self {
        Self {
            ambient: 22.5,
            gain: 0.3,
            heater_time: 0.45,
            dead_time: 0.1,
            t1_lag: 0.05,
            t2_lag: 0.40,
            t2_delay: 0.1,
            heat_loss: 0.08,
            t0_lag: 0.40,
            flow_exponent: 0.8,
            turbulence: 0.12,
            turbulence_time: 0.15,
            white_noise: 0.03,
            adc_bits: 12,
            r25: 10e3,
            beta: 3950.0,
            pull_up: 10e3,
        }
    }
}

impl RigConfig {
    /// Checks every constant.
    ///
    /// # Errors
    /// The name of the first that is out of bounds, its value and the bounds.
    pub fn validate(&self) -> anyhow::Result<()> {
        let check = |name: &str, value: f64, min: f64, max: f64| {
            anyhow::ensure!(value >= min && value <= max, "rig.{name} is {value}, expected {min} to {max}");
            Ok(())
        };
        check("ambient", self.ambient, -20.0, 60.0)?;
        check("gain", self.gain, 0.001, 100.0)?;
        check("heater_time", self.heater_time, 0.01, 1000.0)?;
        check("dead_time", self.dead_time, 0.0, 5.0)?;
        check("t1_lag", self.t1_lag, 0.001, 100.0)?;
        check("t2_lag", self.t2_lag, 0.001, 100.0)?;
        check("t2_delay", self.t2_delay, 0.0, 5.0)?;
        check("heat_loss", self.heat_loss, 0.0, 0.9)?;
        check("t0_lag", self.t0_lag, 0.001, 100.0)?;
        check("flow_exponent", self.flow_exponent, 0.0, 3.0)?;
        check("turbulence", self.turbulence, 0.0, 10.0)?;
        check("turbulence_time", self.turbulence_time, 0.001, 100.0)?;
        check("white_noise", self.white_noise, 0.0, 10.0)?;
        check("adc_bits", f64::from(self.adc_bits), 6.0, 24.0)?;
        check("r25", self.r25, 10.0, 10e6)?;
        check("beta", self.beta, 500.0, 10e3)?;
        check("pull_up", self.pull_up, 10.0, 10e6)
    }
}

/// How much the surroundings move during a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Disturbance {
    /// Nothing moves but the turbulence.
    None,
    /// The room drifts by up to 1 degC an hour and wanders by 0.05 degC.
    #[default]
    Calm,
    /// Calm, and air flow and mains power disturbance by 0.4 %.
    Lively,
}

impl FromStr for Disturbance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "none" => Ok(Self::None),
            "calm" => Ok(Self::Calm),
            "lively" => Ok(Self::Lively),
            _ => Err("expected none, calm or lively".into()),
        }
    }
}

impl fmt::Display for Disturbance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}
