//! The instances that there are, by their numbers; and what is said of a call.

use std::collections::BTreeMap;
use std::ffi::{CString, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::LogMessage;
use crate::instance::Instance;

/// `fmi3Instance`: a number, from 1.
pub type Handle = *mut c_void;

/// `fmi3Status`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// Done, but something is to be told.
    Warning,
    /// Never given.
    Discard,
    /// Not done, and nothing has changed, unless several variables were to be set.
    Error,
    /// The instance cannot be used any more.
    Fatal,
}

/// Where messages go.
#[derive(Clone, Copy)]
pub(super) struct Logger {
    /// A pointer of the importer's, only handed back to it.
    environment: usize,
    log_message: LogMessage,
    /// Warnings are wanted, too.
    warnings: bool,
}

impl Logger {
    pub(super) fn new(environment: *mut c_void, log_message: LogMessage, warnings: bool) -> Self {
        Self { environment: environment.expose_provenance(), log_message, warnings }
    }

    fn tell(self, status: Status, message: &str) {
        let Some(log_message) = self.log_message else { return };
        let category = match status {
            Status::Warning if !self.warnings => return,
            Status::Warning => c"logStatusWarning",
            Status::Fatal => c"logStatusFatal",
            _ => c"logStatusError",
        };
        let message = CString::new(message.replace('\0', "")).unwrap_or_default();
        let environment = std::ptr::with_exposed_provenance_mut(self.environment);
        // SAFETY: the importer has given this function to be called so; the texts end with a zero and live until it returns.
        unsafe { log_message(environment, status, category.as_ptr(), message.as_ptr()) }
    }
}

/// An instance that somebody has.
struct Held {
    instance: Instance,
    logger: Logger,
    /// A call has panicked: nobody knows what it has left.
    broken: bool,
}

#[derive(Default)]
struct Registry {
    last: usize,
    held: BTreeMap<usize, Arc<Mutex<Held>>>,
}

static REGISTRY: Mutex<Registry> = Mutex::new(Registry { last: 0, held: BTreeMap::new() });

/// A lock that somebody panicked with is still a lock: `broken` says what there is to know.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn find(handle: Handle) -> Option<Arc<Mutex<Held>>> {
    lock(&REGISTRY).held.get(&handle.addr()).cloned()
}

/// Runs something that may fail or panic.
fn guarded<T>(work: impl FnOnce() -> anyhow::Result<T>) -> Result<T, (Status, String)> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(done)) => Ok(done),
        Ok(Err(why)) => Err((Status::Error, format!("{why:#}"))),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("of an unknown kind");
            Err((Status::Fatal, format!("a fault of this library: panic {text}")))
        }
    }
}

/// Makes an instance; null if that fails.
pub(super) fn enter(logger: Logger, make: impl FnOnce() -> anyhow::Result<Instance>) -> Handle {
    match guarded(make) {
        Ok(instance) => {
            let mut registry = lock(&REGISTRY);
            registry.last += 1;
            let number = registry.last;
            let held = Held { instance, logger, broken: false };
            registry.held.insert(number, Arc::new(Mutex::new(held)));
            std::ptr::without_provenance_mut(number)
        }
        Err((status, why)) => {
            logger.tell(status, &why);
            std::ptr::null_mut()
        }
    }
}

/// Ends an instance, if there is one.
pub(super) fn leave(handle: Handle) {
    lock(&REGISTRY).held.remove(&handle.addr());
}

/// Says whether warnings are wanted.
pub(super) fn set_logging(handle: Handle, on: bool) -> Status {
    let Some(held) = find(handle) else { return Status::Error };
    lock(&held).logger.warnings = on;
    Status::Ok
}

/// Does something to an instance, which gives what is to be told as a warning. The logger is called when the instance is free again.
pub(super) fn call(
    handle: Handle,
    work: impl FnOnce(&mut Instance) -> anyhow::Result<Vec<String>>,
) -> Status {
    let Some(held) = find(handle) else { return Status::Error };
    let (logger, done) = {
        let mut held = lock(&held);
        if held.broken {
            return Status::Fatal;
        }
        let done = guarded(|| work(&mut held.instance));
        held.broken = matches!(done, Err((Status::Fatal, _)));
        (held.logger, done)
    };
    match done {
        Ok(warnings) if warnings.is_empty() => Status::Ok,
        Ok(warnings) => {
            warnings.iter().for_each(|warning| logger.tell(Status::Warning, warning));
            Status::Warning
        }
        Err((status, why)) => {
            logger.tell(status, &why);
            status
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig;

    /// Nobody may unwind into C, and nobody uses what a panic has left.
    #[test]
    fn a_panic_ends_at_the_boundary_and_the_instance_with_it() {
        let silent = || Logger::new(std::ptr::null_mut(), None, false);
        let handle = enter(silent(), || Ok(Instance::new(&rig::MODEL)));
        assert_eq!(call(handle, |_| panic!("of the test")), Status::Fatal);
        assert_eq!(call(handle, |_| Ok(Vec::new())), Status::Fatal);
        let other = enter(silent(), || Ok(Instance::new(&rig::MODEL)));
        assert_eq!(call(other, |_| Ok(Vec::new())), Status::Ok);
        leave(handle);
        leave(other);
        assert_eq!(call(other, |_| Ok(Vec::new())), Status::Error);
        assert!(enter(silent(), || panic!("of the test")).is_null());
    }
}
