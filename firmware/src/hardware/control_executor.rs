//! The executor of the control task, on an interrupt that no peripheral here uses (SPI4).

use embassy_executor::{InterruptExecutor, SendSpawner};
use embassy_stm32::interrupt;

static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// Starts it; its priority is set with all others.
pub(crate) fn start() -> SendSpawner {
    EXECUTOR.start(interrupt::SPI4)
}

#[interrupt]
fn SPI4() {
    // SAFETY: this is the interrupt that the executor was started with.
    unsafe { EXECUTOR.on_interrupt() }
}
