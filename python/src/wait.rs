//! Work that Python waits for: on a thread of its own, without the lock of the interpreter, so that Ctrl-C is heard and a bar can move.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::Duration;

use indicatif::ProgressBar;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How often it is asked whether Ctrl-C was pressed.
const PATIENCE: Duration = Duration::from_millis(50);

/// What the work and those who wait for it both know.
#[derive(Clone)]
pub(crate) struct Shared {
    /// The work is to end: what it gives is not wanted any more.
    pub(crate) stop: Arc<AtomicBool>,
    /// How far it has come. It is shown by Python alone.
    pub(crate) bar: ProgressBar,
}

/// Does some work. `progress`, a callable, is told how much of how much is done; what it raises, and Ctrl-C, set `stop` and are raised once the
/// work has seen that, or at once where it does not look.
///
/// # Errors
/// Those of the work; `KeyboardInterrupt`.
pub(crate) fn wait<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Shared) -> anyhow::Result<T> + Send + 'static,
) -> PyResult<T> {
    let shared = Shared { stop: Arc::default(), bar: ProgressBar::hidden() };
    let (theirs, (sender, mut receiver)) = (shared.clone(), sync_channel(1));
    std::thread::Builder::new().name("pt326".into()).spawn(move || sender.send(work(&theirs)))?;
    let mut said = None;
    loop {
        let heard;
        (heard, receiver) = py.detach(move || (receiver.recv_timeout(PATIENCE), receiver));
        let now = (shared.bar.position(), shared.bar.length());
        if let Some(progress) = progress.filter(|_| said != Some(now)) {
            said = Some(now);
            progress.call1(now).inspect_err(|_| shared.stop.store(true, Ordering::Relaxed))?;
        }
        match heard {
            Ok(done) => return crate::convert::python(done),
            Err(RecvTimeoutError::Timeout) => {
                py.check_signals().inspect_err(|_| shared.stop.store(true, Ordering::Relaxed))?;
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the work has panicked"));
            }
        }
    }
}
