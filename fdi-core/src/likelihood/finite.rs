//! Is all a number that the next tick goes on from? What comes in is bounded, and leaves one; a flipped bit of the memory may leave none, and
//! whoever compares with it hears "no" for ever: armed, and blind.
//!
//! What is no number spreads, and one is enough to make a sum none. So each part sums up what it would not get rid of by itself. The parts take turns,
//! so that no tick pays for all of them.

use super::ambient::AmbientState;
use super::contradiction::Contradiction;
use super::verdict::{LikelihoodReport, Readiness};
use super::{LikelihoodState, Sensors, Work};

/// Ticks in which every part is asked once: within a second at the default sample time, for an eighth of the cost.
pub(super) const EVERY: u32 = 8;

impl LikelihoodState {
    /// Whether the part whose turn it is on this tick is finite.
    pub(super) fn is_finite(&self, tick: u32) -> bool {
        let sum = match (tick % EVERY, &self.work, &self.trained) {
            (0, Work::Training(training), _) => training.sum(),
            (0, Work::Watching(onset), _) => onset.sum(),
            (1, _, Some(trained)) => trained.sum(),
            (2, ..) => self.ambient.sum() + self.contradiction.sum(),
            _ => 0.0,
        };
        sum.is_finite()
    }

    /// All that was learnt is forgotten, but for what the rig was like at its commissioning.
    #[cold]
    #[inline(never)]
    pub(super) fn begin_anew(&mut self) -> LikelihoodReport {
        (self.work, self.trained) = (Work::Nothing, None);
        (self.current, self.given) = (false, false);
        (self.ambient, self.contradiction) = (AmbientState::default(), Contradiction::default());
        (self.sensors, self.cold) = (Sensors::default(), Default::default());
        self.said = Default::default();
        self.otherwise = Readiness::Restarted;
        self.restarts = self.restarts.saturating_add(1);
        LikelihoodReport { readiness: self.otherwise, restarts: self.restarts, ..LikelihoodReport::default() }
    }
}

#[cfg(test)]
impl LikelihoodState {
    /// See `WatchState::spoil`.
    pub(crate) fn spoil(&mut self, which: usize) -> usize {
        self.trained.as_mut().map_or(0, |trained| trained.spoil(which))
    }
}
