//! The executor of the control task, on an interrupt that no peripheral here uses.

use embassy_executor::{InterruptExecutor, SendSpawner};
use embassy_stm32::interrupt;

use super::board;

static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// Starts it; its priority is set with all others.
pub(crate) fn start() -> SendSpawner {
    EXECUTOR.start(board::CONTROL_INTERRUPT)
}

board::on_control_interrupt!(interrupted);

fn interrupted() {
    // SAFETY: this is the interrupt that the executor was started with.
    unsafe { EXECUTOR.on_interrupt() }
}
