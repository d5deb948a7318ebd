//! What the likelihood diagnosis reports: which fault, how surely, how much, since when.

use super::class::FaultClass;
use super::tuning::NamingTuning;
use crate::name::Name;

/// An estimate with its interval: 95 % of the time the truth lies within `value` plus and minus `half_width`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Magnitude {
    /// Departure from normal in [`FaultClass::unit`]: +1.5 degC, -15 % of gain.
    pub value: f32,
    /// Half of the 95 % interval, in the same unit.
    pub half_width: f32,
}

/// A fault, named.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Finding {
    /// What.
    pub class: FaultClass,
    /// Probability of the class among all that were considered, 0..=1; of what has changed since training, "nothing" is considered, too.
    pub confidence: f32,
    /// How much, where the class has a magnitude.
    pub magnitude: Option<Magnitude>,
    /// The tick on which it is thought to have begun.
    pub onset: u32,
}

impl Finding {
    /// Whether it is sure enough to be acted on. A name that only lasts (docs/diagnosis.md, section 8) is told, and decides nothing.
    pub(crate) fn is_sure(&self) -> bool {
        self.confidence >= NamingTuning::DEFAULT.sure
    }

    /// Whether it may be shelved: its class may ([`FaultClass::may_be_shelved`]), it is sure, and it has a size.
    pub fn may_be_shelved(&self) -> bool {
        self.magnitude.is_some() && self.is_sure() && self.class.may_be_shelved()
    }

    /// Whether it may be taken for normal: its class may ([`FaultClass::may_be_accepted`]), it is sure, and it has a size.
    pub fn may_be_accepted(&self) -> bool {
        self.magnitude.is_some() && self.is_sure() && self.class.may_be_accepted()
    }
}

/// A fault of the user's own ([`taught`](super::taught)), told.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TaughtFinding {
    /// What the user calls it.
    pub name: Name,
    /// Its place among the responses, from 0.
    pub place: u8,
    /// Probability among all that were considered, 0..=1.
    pub confidence: f32,
    /// How large it is, % of what was taught.
    pub magnitude: Magnitude,
}

/// Whether the likelihood diagnosis can say anything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Readiness {
    /// Its models have not been trained yet.
    #[default]
    Untrained,
    /// Being trained.
    Training,
    /// Training ended in models that cannot be trusted; it begins again.
    Refused(RejectReason),
    /// Watching.
    Armed,
    /// A number of its memory was not finite: all that it had learnt is forgotten, and it begins anew.
    Restarted,
}

/// Why trained models were not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RejectReason {
    /// A model is unstable.
    Unstable,
    /// The static gain of a model is not positive.
    Gain,
    /// The models leave too much of the temperatures unexplained.
    PoorFit,
    /// The dead time is longer than the model remembers: the sample time is too short for this plant.
    DeadTime,
}

/// All that the likelihood diagnosis says on a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LikelihoodReport {
    /// Whether it watches.
    pub readiness: Readiness,
    /// Something is wrong.
    pub alarm: bool,
    /// It is no urgent one: it came little by little since training, has stood for an hour, or the user has acknowledged or shelved it.
    pub advice: bool,
    /// What it is, once that can be told.
    pub finding: Option<Finding>,
    /// T1 is out of the tube, stands still or is mistaken for T0: by how the thermistors answer to the power, without models.
    pub t1_contradicted: bool,
    /// The fault of the user's own that it is, beside that.
    pub taught: Option<TaughtFinding>,
    /// What T0, T1 and T2 should read, degC: the ambient that is believed, and by the models what is above it.
    pub expected: [Option<f32>; 3],
    /// The virtual T1: its rise over T0 on the next tick by T2 and the models, degC; None where that is not known.
    pub virtual_rise: Option<f32>,
    /// Air flow by the static gain of both rises over some seconds, % of normal, if the heater gives what it is asked for; None where it
    /// can't be told.
    pub air_flow: Option<f32>,
    /// The rig has been much hotter than the models say for some seconds in which no heat was asked for.
    pub heater_stuck_on: bool,
    /// How often it has begun anew because a number of its memory was not finite: see [`Readiness::Restarted`].
    pub restarts: u32,
}
