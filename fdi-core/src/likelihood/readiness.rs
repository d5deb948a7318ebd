//! Whether the diagnosis can say anything, and what begins before it can.

use super::ambient::AmbientState;
use super::verdict::Readiness;
use super::{LikelihoodState, Work};

impl LikelihoodState {
    /// Whether anything was learnt that faults may be told by, or is being learnt.
    pub(crate) fn learns(&self) -> bool {
        self.current || matches!(self.work, Work::Training(_))
    }

    /// Somebody says that all is well from now on: the ambient temperature is what T0 reads next, and no training that is under way goes on.
    pub(crate) fn forget_before_learning(&mut self) {
        self.ambient = AmbientState::default();
        self.work = Work::Nothing;
    }

    pub(super) fn readiness(&self) -> Readiness {
        match self.otherwise {
            _ if self.current => Readiness::Armed,
            Readiness::Refused(why) => Readiness::Refused(why),
            _ if matches!(self.work, Work::Training(_)) => Readiness::Training,
            otherwise => otherwise,
        }
    }
}
