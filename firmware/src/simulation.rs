//! Codes from the port in place of those of the converter, on a board that was told to start so; its outputs are locked off
//! until the next reset.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use fdi_core::{AdcCode, RawSample};
use firmware_logic::control_loop::NO_SAMPLE;
use firmware_logic::stream::codes::Codes;

static ON: AtomicBool = AtomicBool::new(false);
/// The tick that the codes are for. Control interrupts the writer and never the other way round: it is written last, and is
/// none while they are written.
static TICK: AtomicU32 = AtomicU32::new(NONE);
static CODES: [AtomicU32; 4] = [const { AtomicU32::new(0) }; 4];
const NONE: u32 = u32::MAX;

/// For the start, which has locked the outputs.
pub(crate) fn begin() {
    ON.store(true, Ordering::Relaxed);
}

/// Whether it is under way.
pub(crate) fn is_on() -> bool {
    ON.load(Ordering::Relaxed)
}

/// Codes have come.
pub(crate) fn receive(codes: &Codes) {
    let RawSample { t0, t1, t2, supply } = codes.raw;
    TICK.store(NONE, Ordering::Release);
    for (place, code) in CODES.iter().zip([t0, t1, t2, supply]) {
        place.store(code.0.to_bits(), Ordering::Release);
    }
    TICK.store(codes.tick, Ordering::Release);
}

/// What the tick sees: what was sampled, or, where it is simulated, the codes that came for it; without those no sample.
pub(crate) fn seen(tick: u32, sampled: RawSample) -> RawSample {
    if !is_on() {
        return sampled;
    }
    if TICK.load(Ordering::Acquire) != tick {
        return NO_SAMPLE;
    }
    let code = |i: usize| AdcCode(f32::from_bits(CODES[i].load(Ordering::Acquire)));
    RawSample { t0: code(0), t1: code(1), t2: code(2), supply: code(3) }
}
