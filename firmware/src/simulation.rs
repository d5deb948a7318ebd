//! Codes from the port in place of those of the converter, on a board that was told to start so; its outputs are locked off
//! until the next reset.

use core::sync::atomic::{AtomicBool, Ordering};

use fdi_core::RawSample;
use firmware_logic::control_loop::NO_SAMPLE;
use firmware_logic::stream::codes::Codes;
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

static ON: AtomicBool = AtomicBool::new(false);
static CODES: ConstStaticCell<Queue<Codes, 4>> = ConstStaticCell::new(Queue::new());

/// For the start, which has locked the outputs.
pub(crate) fn begin() {
    ON.store(true, Ordering::Relaxed);
}

/// Whether it is under way.
pub(crate) fn is_on() -> bool {
    ON.load(Ordering::Relaxed)
}

/// Both ends of the codes, console to control.
pub(crate) fn codes() -> (Producer<'static, Codes>, Consumer<'static, Codes>) {
    CODES.take().split()
}

/// What the tick sees: what was sampled, or, where it is simulated, the codes that came for it; without those no sample.
pub(crate) fn seen(tick: u32, sampled: RawSample, codes: &mut Consumer<'static, Codes>) -> RawSample {
    // All that came are taken, so that none is in the way of the next.
    let came = core::iter::from_fn(|| codes.dequeue()).filter(|came| came.tick == tick).last();
    match came {
        _ if !is_on() => sampled,
        Some(codes) => codes.raw,
        None => NO_SAMPLE,
    }
}
