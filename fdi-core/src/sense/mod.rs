//! From ADC codes to temperatures that say whether they can be trusted.
//!
//! ```
//! use fdi_core::sense::plausibility::PlausibilityConfig;
//! use fdi_core::sense::{Sensing, SensingState, SensorsConfig};
//! use fdi_core::{AdcCode, RawSample, Seconds, Validity};
//!
//! let sensing = Sensing::new(&SensorsConfig::default(), &PlausibilityConfig::default(), Seconds(0.11))?;
//! let mut state = SensingState::default();
//! let raw = RawSample { t0: AdcCode(2160.0), t1: AdcCode(1600.0), t2: AdcCode(4095.0), ..RawSample::default() };
//! let sample = sensing.step(&mut state, raw, false);
//! assert!(sample.t1.good().is_some_and(|celsius| celsius > 30.0)); // the code falls as it warms
//! assert_eq!(sample.t2.validity, Validity::Open);
//! # Ok::<(), fdi_core::ConfigError>(())
//! ```

mod logarithm;
pub mod plausibility;
pub mod supply;
pub mod thermistor;

use crate::error::ConfigError;
use crate::numbered::numbered;
use crate::units::{AdcCode, Celsius, Seconds};
use plausibility::{Plausibility, PlausibilityConfig, PlausibilityState};
use thermistor::{Thermistor, ThermistorConfig};

/// One conversion result of each input. NaN stands for "no sample".
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RawSample {
    /// Ambient thermistor.
    pub t0: AdcCode,
    /// Outlet thermistor in the control loop.
    pub t1: AdcCode,
    /// Second outlet thermistor, downstream.
    pub t2: AdcCode,
    /// Supply voltage of the heater; of no consequence where it is not measured.
    pub supply: AdcCode,
}

/// What is known about the trustworthiness of one reading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Validity {
    /// Plausible.
    Good,
    /// No code, or one that no 12-bit converter gives.
    #[default]
    Missing,
    /// The divider reads full scale: thermistor or wire broken.
    Open,
    /// The divider reads zero: thermistor or wire shorted.
    Short,
    /// A temperature that the rig cannot have.
    OutOfRange,
    /// A single jump that nothing has confirmed yet.
    Spike,
    /// Jumps again and again, and the next sample does not confirm it: a loose contact.
    Rate,
    /// Has not moved although the excitation should have moved it.
    Stuck,
}

numbered! {
    Validity from 0;
    Self::Good => 0, "good";
    Self::Missing => 1, "missing";
    Self::Open => 2, "open";
    Self::Short => 3, "short";
    Self::OutOfRange => 4, "out_of_range";
    Self::Spike => 5, "spike";
    Self::Rate => 6, "rate";
    Self::Stuck => 7, "stuck";
}

impl Validity {
    /// Those with which a thermistor reads nothing; with the others it does, be it believed or not.
    pub const READS_NOTHING: [Self; 3] = [Self::Missing, Self::Open, Self::Short];
}

/// A temperature with its validity. The number is finite whatever the input was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reading {
    /// Temperature; where no code came, the last one that did.
    pub celsius: Celsius,
    /// Whether `celsius` may be used.
    pub validity: Validity,
}

impl Reading {
    /// The temperature, if it may be used.
    pub fn good(&self) -> Option<f32> {
        (self.validity == Validity::Good).then_some(self.celsius.0)
    }

    /// What it reads, be it as wild as it may: a thermistor that trips has often left its range.
    pub fn read(&self) -> Option<f32> {
        (!Validity::READS_NOTHING.contains(&self.validity)).then_some(self.celsius.0)
    }
}

/// The three readings of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sample {
    /// Room.
    pub t0: Reading,
    /// Outlet, in the loop.
    pub t1: Reading,
    /// Outlet, downstream.
    pub t2: Reading,
}

impl Sample {
    /// Whether all three readings may be used.
    pub fn is_good(&self) -> bool {
        [self.t0, self.t1, self.t2].iter().all(|r| r.validity == Validity::Good)
    }
}

/// Settings of the three thermistors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct SensorsConfig {
    /// Room.
    pub t0: ThermistorConfig,
    /// Outlet, in the loop.
    pub t1: ThermistorConfig,
    /// Outlet, downstream.
    pub t2: ThermistorConfig,
}

/// The three sensing channels, validated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensing {
    t0: Plausibility,
    t1: Plausibility,
    t2: Plausibility,
}

/// The memory of [`Sensing`].
#[derive(Clone, Copy, Debug, Default)]
pub struct SensingState {
    t0: PlausibilityState,
    t1: PlausibilityState,
    t2: PlausibilityState,
}

impl Sensing {
    /// Builds the three channels.
    ///
    /// # Errors
    /// The first parameter of `sensors` or `plausibility` that is out of bounds.
    pub fn new(
        sensors: &SensorsConfig,
        limits: &PlausibilityConfig,
        sample_time: Seconds,
    ) -> Result<Self, ConfigError> {
        limits.validate()?;
        let air = limits.stuck_time.ticks(sample_time);
        let ambient = limits.ambient_stuck_time.ticks(sample_time);
        Ok(Self {
            t0: Plausibility::new(Thermistor::new(&sensors.t0, 0)?, limits, ambient),
            t1: Plausibility::new(Thermistor::new(&sensors.t1, 1)?, limits, air),
            t2: Plausibility::new(Thermistor::new(&sensors.t2, 2)?, limits, air),
        })
    }

    /// The first thermistor of which a code means another temperature to `new`.
    pub(crate) fn recalibrated(&self, new: &Self) -> Option<&'static str> {
        let channels = [
            (&self.t0, &new.t0, "sensors.t0"),
            (&self.t1, &new.t1, "sensors.t1"),
            (&self.t2, &new.t2, "sensors.t2"),
        ];
        channels.into_iter().find_map(|(now, new, name)| now.is_recalibrated_by(new).then_some(name))
    }

    /// Converts and judges one sample. `excited` says that the heater is being moved, so that a live sensor must move.
    pub fn step(&self, state: &mut SensingState, raw: RawSample, excited: bool) -> Sample {
        Sample {
            t0: self.t0.step(&mut state.t0, raw.t0, excited),
            t1: self.t1.step(&mut state.t1, raw.t1, excited),
            t2: self.t2.step(&mut state.t2, raw.t2, excited),
        }
    }
}
