//! The numbers of the method, each with its unit, what it is, and where it comes from.
//!
//! What a user sets are the settings ([`LikelihoodConfig`](super::config::LikelihoodConfig)); what was found once for all, and is none of his business,
//! stands here. On a board the numbers are constants of the code. With the feature `tuning`, which needs `std`, a run can have others: that is how a
//! campaign asks what each is worth. `pt326 config --tuning` lists them (docs/evidence/tuning.md).
//!
//! ```
//! use fdi_core::likelihood::tuning::Tuned;
//!
//! assert_eq!(Tuned::default().charts.clip, 6.0);
//! ```

mod alarm;
mod bank;
mod declare;
mod interacting;
mod model;
mod sensors;
mod since_training;
mod tracking;
mod training;

use core::ops::Deref;

use super::hypothesis::{self, Hypothesis};
pub use alarm::{AlarmTuning, ChartTuning, NamingTuning, SlowTuning};
pub use bank::{HypothesisTuning, NuisanceTuning, TaughtTuning};
use declare::tuning;
pub use interacting::InteractingTuning;
pub use model::{ModelTuning, TimeTuning};
pub use sensors::{AmbientTuning, ContradictionTuning, HeatTuning, ImpulseTuning, SensorTuning};
pub use since_training::{CommissionedTuning, SinceTrainingTuning};
pub use tracking::{FanTuning, TrackerTuning};
pub use training::{ColdTuning, FilterTuning, PriorTuning, RangeTuning, WhiteningTuning};

macro_rules! parts {
    ($($(#[doc = $doc:literal])+ $part:ident: $Part:ident;)+) => {
        /// All numbers of the method.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[cfg_attr(feature = "tuning", derive(serde::Deserialize), serde(default, deny_unknown_fields))]
        pub struct Tuning {
            $($(#[doc = $doc])+ pub $part: $Part,)+
        }

        impl Tuning {
            /// The numbers that the method was tuned to.
            pub const DEFAULT: Self = Self { $($part: $Part::DEFAULT,)+ };
            /// What people read of them.
            #[cfg(feature = "tuning")]
            pub const PARTS: &'static [Part] = &[$($Part::PART),+];
        }
    };
}

parts! {
    /// The model of the rig.
    model: ModelTuning;
    /// How long everything takes on the reference rig.
    times: TimeTuning;
    /// What is known of a rig before it is trained.
    prior: PriorTuning;
    /// Within which the parameters stay.
    range: RangeTuning;
    /// The cold rig.
    cold: ColdTuning;
    /// The filter that trains.
    filter: FilterTuning;
    /// The noise model of the residuals.
    whitening: WhiteningTuning;
    /// Charts and what widens them.
    charts: ChartTuning;
    /// An alarm's beginning and end.
    alarm: AlarmTuning;
    /// The end of an alarm of a recording.
    interacting: InteractingTuning;
    /// Surroundings as slow as the rig.
    slow: SlowTuning;
    /// Names.
    naming: NamingTuning;
    /// Hypotheses.
    hypotheses: HypothesisTuning;
    /// Nuisances.
    nuisances: NuisanceTuning;
    /// Faults of a user's own.
    taught: TaughtTuning;
    /// What moves without being a fault.
    tracker: TrackerTuning;
    /// The announced fan.
    fan: FanTuning;
    /// Changes since training.
    since_training: SinceTrainingTuning;
    /// Changes since the commissioning.
    commissioned: CommissionedTuning;
    /// Rises held against the model.
    heat: HeatTuning;
    /// Thermistors that contradict each other.
    contradiction: ContradictionTuning;
    /// Impulse responses.
    impulse: ImpulseTuning;
    /// The ambient temperature.
    ambient: AmbientTuning;
    /// Sensors that give nothing.
    sensors: SensorTuning;
}

/// Where a number comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// It follows from a formula or stands in a source.
    Derived,
    /// It was measured or tuned, and where is known.
    Measured,
    /// It was chosen, and no measurement of it is kept.
    Chosen,
}

/// What people read of a number.
#[cfg(feature = "tuning")]
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its name, as in `tuning.charts.clip`.
    pub name: &'static str,
    /// What it is: the lines of its documentation.
    pub about: &'static str,
    /// Its unit; `1` for plain numbers.
    pub unit: &'static str,
    /// Where it comes from.
    pub origin: Origin,
    /// The formula, the source, the campaign, or what speaks for it.
    pub source: &'static str,
    /// Its value.
    pub value: fn(&Tuning) -> f32,
}

/// What people read of a part of the method.
#[cfg(feature = "tuning")]
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Its name, as in `charts`.
    pub name: &'static str,
    /// What it is about.
    pub about: &'static str,
    /// Its numbers.
    pub entries: &'static [Entry],
}

/// The numbers in force. Without the feature `tuning` it takes no memory, and each number is a constant where it is used.
#[derive(Clone, Copy)]
#[cfg_attr(
    all(feature = "serde", not(feature = "tuning")),
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Tuned {
    #[cfg(feature = "tuning")]
    of: &'static varied::Method,
}

impl Tuned {
    /// The hypotheses with these numbers.
    #[inline(always)]
    pub(super) fn hypotheses(self) -> &'static [Hypothesis; hypothesis::COUNT] {
        #[cfg(feature = "tuning")]
        return &self.of.hypotheses;
        #[cfg(not(feature = "tuning"))]
        &hypothesis::HYPOTHESES
    }
}

impl Deref for Tuned {
    type Target = Tuning;

    #[inline(always)]
    fn deref(&self) -> &Tuning {
        #[cfg(feature = "tuning")]
        return &self.of.tuning;
        #[cfg(not(feature = "tuning"))]
        const {
            &Tuning::DEFAULT
        }
    }
}

impl core::fmt::Debug for Tuned {
    fn fmt(&self, f: &mut core::fmt::Formatter) -> core::fmt::Result {
        (**self).fmt(f)
    }
}

impl PartialEq for Tuned {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

#[cfg(not(feature = "tuning"))]
impl Default for Tuned {
    #[inline(always)]
    fn default() -> Self {
        Self {}
    }
}

#[cfg(feature = "tuning")]
mod varied;

#[cfg(test)]
mod tests;
