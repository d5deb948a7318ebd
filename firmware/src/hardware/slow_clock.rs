//! Measures the watchdog's oscillator (LSI), which the start of the watchdog has started, in microseconds of the timer of the tick: that timer
//! captures each eighth of its edges (RM0383, "Internal/external clock measurement using TIM5/TIM11").
//!
//! Hazard: PWM, tick, tasks and all that watches them count one clock. If it slows down, so does everything, and nothing else notices.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_stm32::pac::timer::vals::CcmrInputCcs;
use firmware_logic::slow_clock;

use super::board::{SLOW_CHANNEL, SLOW_INPUT, TICK_TIMER};

/// 8 edges a capture, by the channel's divider.
const EACH_EIGHTH: u8 = 3;
const _: () = assert!(slow_clock::PERIODS == 8);

/// Polls of a capture at 8 MHz: 20 ms and more, forty times what the slowest oscillator takes.
const MAX_POLLS: u32 = 20_000;

/// A span by the internal oscillator, at the start.
static REFERENCE: AtomicU32 = AtomicU32::new(0);
/// Captures of the measurement under way, the last of them, and how far it lies behind the one before.
static CAPTURES: AtomicU32 = AtomicU32::new(0);
static LAST: AtomicU32 = AtomicU32::new(0);
static SPAN: AtomicU32 = AtomicU32::new(0);
/// The last sample had no whole span.
static UNFINISHED: AtomicBool = AtomicBool::new(false);
/// Two edges make a span.
const WHOLE: u32 = 2;

/// Leads the oscillator to the timer, which has just been reset.
pub(crate) fn connect() {
    TICK_TIMER.or().modify(|w| *w |= SLOW_INPUT);
    TICK_TIMER.ccmr_input(SLOW_CHANNEL / 2).modify(|w| {
        w.set_ccs(SLOW_CHANNEL % 2, CcmrInputCcs::TI4);
        w.set_icpsc(SLOW_CHANNEL % 2, EACH_EIGHTH);
    });
}

fn enable(on: bool) {
    TICK_TIMER.ccer().modify(|w| w.set_cce(SLOW_CHANNEL, on));
}

/// Begins to measure, which takes 16 edges: 0.34 to 0.94 ms.
pub(crate) fn begin() {
    CAPTURES.store(0, Ordering::Relaxed);
    enable(true);
}

/// The timer has captured an edge. Where it has lost one before, this is the first anew.
pub(crate) fn captured(lost_one: bool) {
    let at = TICK_TIMER.ccr(SLOW_CHANNEL).read();
    let span = at.wrapping_sub(LAST.swap(at, Ordering::Relaxed));
    SPAN.store(span, Ordering::Relaxed);
    let captures = if lost_one { 1 } else { CAPTURES.load(Ordering::Relaxed) + 1 };
    CAPTURES.store(captures, Ordering::Relaxed);
    if captures >= WHOLE {
        enable(false);
    }
}

/// What was measured since [`begin`]; 0 if there is nothing.
fn span() -> u32 {
    if CAPTURES.load(Ordering::Relaxed) == WHOLE { SPAN.load(Ordering::Relaxed) } else { 0 }
}

/// For the start, when the timer interrupts nothing yet: measures by the clock that feeds the timer at this moment.
pub(crate) fn measure() -> u32 {
    begin();
    let _ = (0..MAX_POLLS).any(|_| {
        if TICK_TIMER.sr().read().ccif(SLOW_CHANNEL) {
            captured(false);
        }
        span() > 0
    });
    span()
}

/// What everything later is held against: a span by the internal oscillator.
pub(crate) fn set_reference(span: u32) {
    REFERENCE.store(span, Ordering::Relaxed);
}

/// Whether a span agrees with the reference.
pub(crate) fn agrees(span: u32) -> bool {
    slow_clock::agree(REFERENCE.load(Ordering::Relaxed), span)
}

/// Whether the clock runs as it should, by what was measured since [`begin`]. A stall of the core, such as an erasure of the flash, may have lost
/// the edges of one sample; of two in a row only a wrong clock does.
pub(crate) fn is_right() -> bool {
    match span() {
        0 => !UNFINISHED.swap(true, Ordering::Relaxed),
        span => {
            UNFINISHED.store(false, Ordering::Relaxed);
            agrees(span)
        }
    }
}
