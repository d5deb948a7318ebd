//! Why the chip was reset, and how to reset it.

use embassy_stm32::pac::RCC;
use firmware_logic::reset_cause::ResetFlags;

/// Reads the flags and clears them, so that the next start sees its own.
pub(crate) fn take_flags() -> ResetFlags {
    let csr = RCC.csr().read();
    RCC.csr().modify(|w| w.set_rmvf(true));
    ResetFlags {
        power_on: csr.porrstf(),
        brown_out: csr.borrstf(),
        pin: csr.padrstf(),
        software: csr.sftrstf(),
        watchdog: csr.wdgrstf(),
        window_watchdog: csr.wwdgrstf(),
        low_power: csr.lpwrrstf(),
    }
}

/// Starts all over.
pub(crate) fn reset() -> ! {
    cortex_m::peripheral::SCB::sys_reset()
}
