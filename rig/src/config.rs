//! What the rig is made of, and how much its surroundings move: data, checked before use.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, de::Error};

use crate::constants::constants;
use crate::fan::{FanChanges, FanConfig};
use crate::heater::{HeaterChanges, HeaterConfig};
use crate::mains::{MainsChanges, MainsConfig};
use crate::pickup::{PickupChanges, PickupConfig};
use crate::room::{RoomChanges, RoomConfig};
use crate::thermistor::{SensorChanges, SensorConfig};
use crate::wall::{WallChanges, WallConfig};

constants! {
    /// Constants of the rig. Defaults: the reference rig (paper where it prints a value, else our choice; docs/theory.md).
    pub struct RigConfig / RigChanges in "rig" {
        /// Ambient temperature, degC.
        ambient: f64 = 22.5, -20.0..=60.0;
        /// Static gain K at T1, degC per % of heater power.
        gain: f64 = 0.3, 0.001..=100.0;
        /// Time constant of the heater node, s.
        heater_time: f64 = 0.45, 0.01..=1000.0;
        /// Dead time from heater to T1, s.
        dead_time: f64 = 0.1, 0.0..=60.0;
        /// Lag of thermistor T1, s.
        t1_lag: f64 = 0.05, 0.001..=100.0;
        /// Lag of thermistor T2, s.
        t2_lag: f64 = 0.40, 0.001..=100.0;
        /// Transport from T1 to T2, s.
        t2_delay: f64 = 0.1, 0.0..=60.0;
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
    } from preset with {
        /// The wall of the tube.
        wall: WallConfig / WallChanges;
        /// The mains.
        mains: MainsConfig / MainsChanges;
        /// How the thermistors differ from their data sheet.
        thermistor: SensorConfig / SensorChanges;
        /// The fan.
        fan: FanConfig / FanChanges;
        /// Drive and wire of the heater.
        heater: HeaterConfig / HeaterChanges;
        /// The room.
        room: RoomConfig / RoomChanges;
        /// Hum on the wires.
        pickup: PickupConfig / PickupChanges;
    }
}

impl RigConfig {
    /// Resistance of a thermistor by the data sheet at 25 degC over that of the divider.
    pub(crate) fn r25_over_pull_up(&self) -> f64 {
        self.r25 / self.pull_up
    }
}

impl<'de> Deserialize<'de> for RigConfig {
    /// Keys that are left out are those of the preset that `preset` names, without it the defaults.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let changes = RigChanges::deserialize(deserializer)?;
        let start = changes.preset.as_deref().map_or(Ok(Self::default()), Self::preset);
        Ok(start.map_err(D::Error::custom)?.changed(changes))
    }
}

/// How much the surroundings move during a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Disturbance {
    /// Nothing moves but the turbulence.
    None,
    /// The room drifts by up to 1 degC an hour, to and fro within 2 degC, and wanders by 0.05 degC.
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
