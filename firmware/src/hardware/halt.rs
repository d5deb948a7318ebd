//! A debugger that halts the core. The output freezes, the guard does not: the timer of the PWM stands still with its
//! outputs off, the clock of the thread-mode tasks and the watchdog stand still with it, and the timer of the tick runs on. So the deadline watchdog
//! falls during a long halt, the ticks of a halt are missed ticks, and a halt of any length is seen by the clocks, which
//! both count microseconds of one oscillator and differ afterwards.

use core::sync::atomic::{AtomicU16, Ordering};

use embassy_stm32::pac::DBGMCU;

use super::board;

/// Timer of the tick minus timer of the tasks when last looked at. The latter counts 16 bits.
static LAG: AtomicU16 = AtomicU16::new(0);
/// The two are not read at the same moment.
const TOLERANCE_US: u16 = 2;

/// Chooses what stands still while the core is halted. The debug unit keeps this over resets, so a bit that another
/// program has set is cleared, too.
pub(crate) fn freeze_output_not_guard() {
    DBGMCU.apb1fzr().modify(|w| w.0 = w.0 & !board::HALT_TICK | board::HALT_TASKS);
    DBGMCU.apb2fzr().modify(|w| w.0 |= board::HALT_PWM);
}

/// Whether the core was halted since this was last asked. OrderKind by the most urgent interrupt alone, which nothing delays
/// between the two readings.
pub(crate) fn was_halted() -> bool {
    let lag = lag();
    let moved = lag.wrapping_sub(LAG.swap(lag, Ordering::Relaxed));
    moved.wrapping_add(TOLERANCE_US) > 2 * TOLERANCE_US
}

/// Begins to compare; both timers run.
pub(crate) fn start() {
    LAG.store(lag(), Ordering::Relaxed);
}

fn lag() -> u16 {
    (board::TICK_TIMER.cnt().read() as u16).wrapping_sub(board::TASK_TIMER.cnt().read() as u16)
}
