//! The tasks. Control runs on an interrupt above all others; the rest share thread mode.

pub(crate) mod console;
pub(crate) mod control;
pub(crate) mod diagnosis;
pub(crate) mod panel;
pub(crate) mod status;
pub(crate) mod watchdog;
