//! What both diagnoses see of a rig on a tick, whatever controls it.

use crate::known::KnownInputs;
use crate::sense::Sample;
use crate::units::Percent;

/// What is done with the rig, as far as the diagnoses go by it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Phase {
    /// Nothing heats.
    #[default]
    Off,
    /// It is heated, and not yet or not now in normal operation.
    Heated,
    /// What is normal is learnt.
    Learning,
    /// Faults are looked for.
    Watched,
    /// A trip has switched the heater off, and is not acknowledged yet.
    Tripped,
}

impl Phase {
    /// Whether the heater may be driven.
    pub fn is_heated(self) -> bool {
        matches!(self, Self::Heated | Self::Learning | Self::Watched)
    }
}

/// For how long the user wants to hear no more than advice of what is told (ANSI/ISA-18.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Shelving {
    /// Until it ends, or is called another name: it is acknowledged.
    UntilItEnds,
    /// For so many ticks, however often it ends and comes back; 0 puts an end to that.
    For(u32),
}

/// One tick. An instrument makes it of its own [`Tick`](crate::Tick), a [`Monitor`](crate::Monitor) of what somebody else has measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Observation {
    /// Number of the tick.
    pub index: u32,
    /// Temperatures with their validities.
    pub sample: Sample,
    /// What drives the heater from this tick to the next, 0 to 100 %.
    pub power: Percent,
    /// What is known of the rig's other inputs.
    pub known: KnownInputs,
    /// What is done with the rig.
    pub phase: Phase,
    /// The power is excited, so that models may be trained though nothing is being learnt.
    pub excited: bool,
    /// This sample belongs to normal operation: it may be learnt from.
    pub learn: bool,
    /// What was learnt before is to be forgotten.
    pub forget: bool,
    /// What is told now is to be advice.
    pub shelve: Option<Shelving>,
}

impl Observation {
    /// Rises of T1 and T2 over T0 where both readings are valid, degC.
    pub fn rises(&self) -> [Option<f32>; 2] {
        let t0 = self.sample.t0.good();
        [self.sample.t1, self.sample.t2].map(|reading| Some(reading.good()? - t0?))
    }
}
