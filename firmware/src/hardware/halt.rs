//! A debugger that halts the core. The output freezes, the guard does not: TIM1 stands still with its outputs off, the
//! clock of the thread-mode tasks (TIM2) and the watchdog stand still with it, and TIM5 runs on. So the deadline watchdog
//! falls during a long halt, the ticks of a halt are missed ticks, and a halt of any length is seen by the clocks, which
//! both count microseconds of one oscillator and differ afterwards.

use core::sync::atomic::{AtomicU16, Ordering};

use embassy_stm32::pac::{DBGMCU, TIM2};

use super::tick_timer;

/// TIM5 minus TIM2 when last looked at. TIM2 counts 16 bits.
static LAG: AtomicU16 = AtomicU16::new(0);
/// The two are not read at the same moment.
const TOLERANCE_US: u16 = 2;

/// Chooses what stands still while the core is halted. The debug unit keeps this over resets, so a bit that another
/// program has set is cleared, too.
pub(crate) fn freeze_output_not_guard() {
    const TIM2_IWDG: u32 = 1 << 0 | 1 << 12;
    const TIM5: u32 = 1 << 3;
    const TIM1: u32 = 1 << 0;
    DBGMCU.apb1fzr().modify(|w| w.0 = w.0 & !TIM5 | TIM2_IWDG);
    DBGMCU.apb2fzr().modify(|w| w.0 |= TIM1);
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
    (tick_timer::now() as u16).wrapping_sub(TIM2.cnt().read() as u16)
}
