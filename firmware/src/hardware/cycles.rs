//! The core's own counter of cycles, which wraps every 43 s.

use cortex_m::peripheral::{DCB, DWT};

/// Begins to count. The counter belongs to the core's debug unit, and runs without a debugger, too.
pub(crate) fn start(dcb: &mut DCB, dwt: &mut DWT) {
    dcb.enable_trace();
    dwt.enable_cycle_counter();
}

/// Cycles; 0 for ever on a core without the counter.
pub(crate) fn now() -> u32 {
    DWT::cycle_count()
}
