//! What an alarm shows to those who ask: what each hypothesis explains of it, and what it has changed.

use super::class::FaultClass;
use super::hypothesis::COUNT;
use super::taught::Changed;
use super::{LikelihoodState, Work};

impl LikelihoodState {
    /// What each hypothesis explains of an alarm, for those who show it: the class, and the share, 0 to 1, of what is unusual in the residuals
    /// since the onset that it would take away all by itself. Several hypotheses belong to some classes. None without an alarm of the models.
    pub fn explained(&self) -> Option<[(FaultClass, f32); COUNT]> {
        match (&self.work, &self.trained) {
            (Work::Watching(onset), Some(trained)) => onset.explained(trained.tuning),
            _ => None,
        }
    }

    /// What the alarm under way has changed, for those who teach it; None without an alarm of the models, or while it is young.
    pub fn changed(&self) -> Option<Changed> {
        match (&self.work, &self.trained) {
            (Work::Watching(onset), Some(trained)) => onset.changed(&trained.usual()),
            _ => None,
        }
    }
}
