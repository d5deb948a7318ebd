//! What the diagnosis does with a tick.

use super::alarm::Held;
use super::training::Training;
use super::watch::SinceOnsetState;

/// What is under way: a model is trained, or watched by; never both.
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::large_enum_variant, reason = "there is one, and nowhere to box it")]
pub(super) enum Work {
    #[default]
    Nothing,
    Training(Training),
    Watching(SinceOnsetState),
}

impl Work {
    /// Out of line, for the stack: the new memory lies on it once, on its way to where it stays.
    #[cold]
    #[inline(never)]
    pub(super) fn begin_watching(&mut self) {
        *self = Self::Watching(SinceOnsetState::default());
    }

    /// What the alarm since an onset is held for; none without one.
    pub(super) fn held(&self) -> Option<Held> {
        match self {
            Self::Watching(onset) => onset.held(),
            _ => None,
        }
    }
}
