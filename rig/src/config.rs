//! What the rig is made of, and how much its surroundings move: data, checked before use.

use std::fmt;
use std::str::FromStr;

use anyhow::ensure;
use serde::{Deserialize, Serialize};

/// A constant of the rig, as people read of it.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    /// Key under `[rig]`.
    pub name: &'static str,
    /// What it is, with its unit.
    pub about: &'static str,
    /// Its default, as TOML.
    pub default: &'static str,
    /// Smallest and largest value.
    pub bounds: [f64; 2],
}

/// Declares each constant once: what it is, its key, default and bounds. It gives the struct, its defaults, the check of the
/// bounds, and the table from which commented TOML is written.
macro_rules! constants {
    ($(#[doc = $about:literal])+ pub struct $Config:ident {
        $($(#[doc = $doc:literal])+ $name:ident: $Type:ty = $default:literal, $min:literal..=$max:literal;)+
    }) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $Config {
            $(
                $(#[doc = $doc])+
                #[doc = concat!("\n\nDefault ", stringify!($default), ", ", stringify!($min), " to ", stringify!($max), ".")]
                pub $name: $Type,
            )+
        }

        impl Default for $Config {
            fn default() -> Self {
                Self { $($name: $default,)+ }
            }
        }

        impl $Config {
            /// Every constant, in order.
            pub const CONSTANTS: &[Constant] = &[$(Constant {
                name: stringify!($name),
                about: concat!($($doc),+),
                default: stringify!($default),
                bounds: [$min, $max],
            }),+];

            /// Checks every constant.
            ///
            /// # Errors
            /// The name of the first that is out of bounds, its value and the bounds.
            pub fn validate(&self) -> anyhow::Result<()> {
                let values: [f64; Self::CONSTANTS.len()] = [$(self.$name.into()),+];
                for (constant, value) in Self::CONSTANTS.iter().zip(values) {
                    let (name, [min, max]) = (constant.name, constant.bounds);
                    ensure!(value >= min && value <= max, "rig.{name} is {value}, expected {min} to {max}");
                }
                Ok(())
            }
        }
    };
}

constants! {
    /// Constants of the rig. Defaults: the reference rig (paper where it prints a value, else our choice; docs/theory.md).
    pub struct RigConfig {
        /// Ambient temperature, degC.
        ambient: f64 = 22.5, -20.0..=60.0;
        /// Static gain K at T1, degC per % of heater power.
        gain: f64 = 0.3, 0.001..=100.0;
        /// Time constant of the heater node, s.
        heater_time: f64 = 0.45, 0.01..=1000.0;
        /// Dead time from heater to T1, s.
        dead_time: f64 = 0.1, 0.0..=5.0;
        /// Lag of thermistor T1, s.
        t1_lag: f64 = 0.05, 0.001..=100.0;
        /// Lag of thermistor T2, s.
        t2_lag: f64 = 0.40, 0.001..=100.0;
        /// Transport from T1 to T2, s.
        t2_delay: f64 = 0.1, 0.0..=5.0;
        /// Share of the rise lost between T1 and T2.
        heat_loss: f64 = 0.08, 0.0..=0.9;
        /// Lag of the ambient thermistor, s.
        t0_lag: f64 = 0.40, 0.001..=100.0;
        /// Time constants go with air flow to the power of minus this.
        flow_exponent: f64 = 0.8, 0.0..=3.0;
        /// Standard deviation of the air's turbulence at T1 and at T2, degC.
        turbulence: f64 = 0.12, 0.0..=10.0;
        /// Correlation time of the turbulence, s.
        turbulence_time: f64 = 0.15, 0.001..=100.0;
        /// Standard deviation of the white measurement noise, degC.
        white_noise: f64 = 0.03, 0.0..=10.0;
        /// Bits of the ADC; codes are given on the 12-bit scale whatever their number.
        adc_bits: u32 = 12, 6.0..=24.0;
        /// Thermistors: resistance at 25 degC, ohm.
        r25: f64 = 10000.0, 10.0..=10e6;
        /// Thermistors: beta, K.
        beta: f64 = 3950.0, 500.0..=10e3;
        /// Pull-up from VDDA to the ADC input, ohm.
        pull_up: f64 = 10000.0, 10.0..=10e6;
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
    /// Calm, and air flow and mains power wander by 0.4 %.
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
