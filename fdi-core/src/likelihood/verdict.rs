//! The words of the likelihood diagnosis: what can be faulty, how surely, how much, since when.

/// What is faulty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FaultClass {
    /// T1 reads too high or too low by a constant.
    T1Offset,
    /// T2 reads too high or too low by a constant.
    T2Offset,
    /// T1 sees only a part of the rise, or sees it late, or both.
    T1Clogged,
    /// The air flow is not what it was.
    AirFlow,
    /// The heater gives another power than the one asked for.
    HeaterPower,
    /// The ambient thermistor reads wrong.
    T0Fault,
    /// A thermistor's error grows slowly.
    Drift,
    /// A thermistor repeats itself although it should move.
    Stuck(Channel),
    /// A thermistor's wire is broken.
    Open(Channel),
    /// A thermistor's wires touch.
    Short(Channel),
    /// A thermistor gives nothing that can be true: no code, impossible temperatures or jumps.
    Lost(Channel),
    /// T1 is out of the tube, or half out: it sees little of the rise or none.
    T1Detached,
    /// T2 is out of the tube.
    T2Detached,
    /// Two thermistors stand for each other, as when their wires are swapped.
    Swapped(Pair),
    /// None of these explains what is seen, or several at once would be needed.
    Unknown,
}

/// A thermistor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Channel {
    /// Room.
    T0,
    /// Outlet, in the loop.
    T1,
    /// Outlet, downstream.
    T2,
}

/// Two thermistors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Pair {
    /// Outlet and outlet downstream.
    T1T2,
    /// Room and outlet.
    T0T1,
    /// Room and outlet downstream.
    T0T2,
}

impl FaultClass {
    /// Name in traces and logs.
    pub const fn name(self) -> &'static str {
        use Channel::{T0, T1, T2};
        match self {
            Self::T1Offset => "t1_offset",
            Self::T2Offset => "t2_offset",
            Self::T1Clogged => "t1_clogged",
            Self::AirFlow => "air_flow",
            Self::HeaterPower => "heater_power",
            Self::T0Fault => "t0_fault",
            Self::Drift => "drift",
            Self::Stuck(T0) => "t0_stuck",
            Self::Stuck(T1) => "t1_stuck",
            Self::Stuck(T2) => "t2_stuck",
            Self::Open(T0) => "t0_open",
            Self::Open(T1) => "t1_open",
            Self::Open(T2) => "t2_open",
            Self::Short(T0) => "t0_short",
            Self::Short(T1) => "t1_short",
            Self::Short(T2) => "t2_short",
            Self::Lost(T0) => "t0_lost",
            Self::Lost(T1) => "t1_lost",
            Self::Lost(T2) => "t2_lost",
            Self::T1Detached => "t1_detached",
            Self::T2Detached => "t2_detached",
            Self::Swapped(Pair::T1T2) => "t1_t2_swapped",
            Self::Swapped(Pair::T0T1) => "t0_t1_swapped",
            Self::Swapped(Pair::T0T2) => "t0_t2_swapped",
            Self::Unknown => "unknown",
        }
    }

    /// Whether it is T1 that reads wrong, by name.
    pub const fn is_of_t1(self) -> bool {
        matches!(
            self,
            Self::T1Offset
                | Self::T1Clogged
                | Self::T1Detached
                | Self::Stuck(Channel::T1)
                | Self::Open(Channel::T1)
                | Self::Short(Channel::T1)
                | Self::Lost(Channel::T1)
        )
    }

    /// Unit of the estimated magnitude; empty where there is none.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::T1Offset | Self::T2Offset | Self::T0Fault => "degC",
            Self::T1Clogged | Self::T1Detached | Self::T2Detached => "% of gain",
            Self::AirFlow => "% of air flow",
            Self::HeaterPower => "% of power",
            Self::Drift => "degC/min",
            Self::Stuck(_) | Self::Open(_) | Self::Short(_) | Self::Lost(_) => "",
            Self::Swapped(_) | Self::Unknown => "",
        }
    }
}

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
    /// Probability of the class among all that were considered, 0..=1.
    pub confidence: f32,
    /// How much, where the class has a magnitude.
    pub magnitude: Option<Magnitude>,
    /// The tick on which it is thought to have begun.
    pub onset: u32,
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
}

/// All that the likelihood diagnosis says on a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LikelihoodReport {
    /// Whether it watches.
    pub readiness: Readiness,
    /// Something is wrong.
    pub alarm: bool,
    /// What it is, once that can be told.
    pub finding: Option<Finding>,
    /// What T0, T1 and T2 should read, degC: the room that is believed, and by the models what is above it.
    pub expected: [Option<f32>; 3],
    /// What T1 will be above the room on the next tick by T2 and the models, degC; None where that is not known.
    pub stand_in: Option<f32>,
    /// Air flow by the static gain of both rises over some seconds, % of normal; None where it can't be told, or where the
    /// heater is to blame.
    pub air_flow: Option<f32>,
    /// The rig has been much hotter than the models say for some seconds in which no heat was asked for.
    pub heater_stuck_on: bool,
}
