//! What a tick of the control half gives to the other.

use fdi_core::{Percent, RawSample, Tick};

use super::Outcome;
use crate::cadence::Arrival;
use crate::interlock::Lockout;
use crate::self_test::News;

/// The record of a tick: all that this half gives to the other.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TickRecord {
    /// Codes as they came.
    pub raw: RawSample,
    /// What the controller decided.
    pub tick: Tick,
    /// What the heater really gets until the next tick.
    pub applied: Percent,
    /// When the tick began; no sample was taken on a tick that was missed.
    pub arrival: Arrival,
    /// It stands for a tick that was missed.
    pub missed: bool,
    /// What holds the heater off.
    pub lockout: Option<Lockout>,
    /// The order carried out or denied before this tick.
    pub outcome: Option<Outcome>,
    /// What the self-test has to say.
    pub news: Option<News>,
    /// Cycles of the core that this half took, where the board counts them.
    pub cycles: u32,
    /// A self-test has passed since the start, and no other has begun.
    pub checked: bool,
}

impl TickRecord {
    /// The record of a tick on which nothing but control took place.
    pub fn new(raw: RawSample, tick: Tick, applied: Percent) -> Self {
        Self {
            raw,
            tick,
            applied,
            arrival: Arrival::default(),
            missed: false,
            lockout: None,
            outcome: None,
            news: None,
            cycles: 0,
            checked: false,
        }
    }
}
