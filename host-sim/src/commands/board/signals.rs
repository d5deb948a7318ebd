//! Signals that would end the program (Ctrl-C, SIGTERM, a terminal that is closed): who heats, or records, does something about them
//! first.

use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use anyhow::anyhow;

use super::keys;

type Heeding = (u64, Box<dyn Fn() + Send>);

/// Whoever heeds them now.
static HEEDING: Mutex<(u64, Vec<Heeding>)> = Mutex::new((0, Vec::new()));

fn heeding() -> MutexGuard<'static, (u64, Vec<Heeding>)> {
    HEEDING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Heeds them until it is dropped.
pub(crate) struct Heed(u64);

impl Heed {
    /// Has this done at each signal, in a thread of its own.
    ///
    /// # Errors
    /// The system does not give them.
    pub(crate) fn new(act: impl Fn() + Send + 'static) -> anyhow::Result<Self> {
        static HANDLER: OnceLock<Result<(), String>> = OnceLock::new();
        let set = HANDLER.get_or_init(|| ctrlc::set_handler(handle).map_err(|error| error.to_string()));
        set.as_ref().map_err(|error| anyhow!("signals cannot be heeded: {error}"))?;
        let mut heeding = heeding();
        heeding.0 += 1;
        let number = heeding.0;
        heeding.1.push((number, Box::new(act)));
        Ok(Self(number))
    }
}

impl Drop for Heed {
    fn drop(&mut self) {
        heeding().1.retain(|(number, _)| *number != self.0);
    }
}

fn handle() {
    let heeding = heeding();
    heeding.1.iter().for_each(|(_, act)| act());
    if heeding.1.is_empty() {
        keys::restore();
        std::process::exit(2);
    }
}
