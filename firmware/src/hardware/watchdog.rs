//! The independent watchdog. It runs on its own oscillator, 32 kHz nominal but 17 to 47 kHz by the data sheet, and once
//! started nothing but a reset stops it.

use embassy_stm32::pac::IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};

/// How long it waits to be fed.
#[derive(Clone, Copy)]
pub(crate) enum Deadline {
    /// 400 ms nominal, 272 to 753 ms: while anything may heat.
    Running,
    /// 8 s nominal, at least 5.4 s: while clocks start, or a flash sector is erased, which stalls the core for up to
    /// 4 s. The heater is off then.
    Stalled,
}

/// Divider and reload of 32 kHz for each.
const RUNNING: (Pr, u16) = (Pr::DIVIDE_BY16, 800 - 1);
const STALLED: (Pr, u16) = (Pr::DIVIDE_BY256, 1000 - 1);

/// Polls of the busy flags; they clear within some 6 periods of the slow oscillator.
const MAX_POLLS: u32 = 1_000_000;

/// Starts it.
pub(crate) fn start() {
    IWDG.kr().write(|w| w.set_key(Key::START));
    set(Deadline::Stalled);
}

/// Runs what stalls the processor, with the long deadline, and returns to the deadline before.
pub(crate) fn with_long_deadline<T>(stall: impl FnOnce() -> T) -> T {
    let divider_before = IWDG.pr().read().pr();
    set(Deadline::Stalled);
    let result = stall();
    if divider_before == RUNNING.0 {
        set(Deadline::Running);
    }
    result
}

/// Sets its deadline, and feeds it. The reload first: a divider acts on the count at hand, and a longer one on what the reset left there would be half a
/// minute if the program hung just then.
pub(crate) fn set(deadline: Deadline) {
    let (divider, reload) = match deadline {
        Deadline::Running => RUNNING,
        Deadline::Stalled => STALLED,
    };
    take_over(|| IWDG.rlr().write(|w| w.set_rl(reload)));
    take_over(|| IWDG.pr().write(|w| w.set_pr(divider)));
}

/// Unlocks it for one write, waits until that is in force, and feeds it, which locks it again.
fn take_over(write: impl FnOnce()) {
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    // A write while an earlier one is still on its way to the slow clock would be lost.
    wait_until_taken();
    write();
    wait_until_taken();
    feed();
}

/// Feeds it.
pub(crate) fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}

fn wait_until_taken() {
    let _ = (0..MAX_POLLS).any(|_| {
        let status = IWDG.sr().read();
        !status.pvu() && !status.rvu()
    });
}
