//! What keeps a stop the last word: nothing is typed behind it.

use std::sync::{Arc, Mutex, PoisonError};

use anyhow::ensure;

/// What stops a board by another hand closes it, so that nothing is typed behind that stop.
#[derive(Clone, Debug, Default)]
pub struct Gate(Arc<Mutex<bool>>);

impl Gate {
    /// Closes it for good, then stops; a line that is just being sent goes before.
    pub fn close<R>(&self, stop: impl FnOnce() -> R) -> R {
        let mut closed = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *closed = true;
        stop()
    }

    /// Whether somebody has stopped the board.
    pub fn is_closed(&self) -> bool {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether it is open.
    ///
    /// # Errors
    /// Somebody has stopped the board.
    pub fn check(&self) -> anyhow::Result<()> {
        self.pass(|| Ok(()))
    }

    /// Sends something while it is open: a stop goes before or behind it, never in between.
    pub(super) fn pass<R>(&self, send: impl FnOnce() -> anyhow::Result<R>) -> anyhow::Result<R> {
        let closed = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        ensure!(!*closed, "it was stopped by hand");
        send()
    }
}
