//! The supply: whether it is low, and the level below which the chip holds itself in reset (brown-out, an option byte that the
//! factory leaves off).

use embassy_stm32::pac::{FLASH, PWR};

use super::watchdog;

/// Whether the supply is below the threshold of the voltage detector, which has to run: see `undervoltage`.
pub(crate) fn is_low() -> bool {
    PWR.csr1().read().pvdo()
}

/// Brown-out level 3, 2.7 V, as it stands in the option bytes; 3 is off.
const LEVEL_3: u8 = 0;
/// What the console and the log call the levels, by their code.
const LEVELS: [&str; 4] = ["3 (2.7 V)", "2 (2.4 V)", "1 (2.1 V)", "off"];

/// The brown-out level, where it is lower than it should be.
pub(crate) fn low_brown_out_level() -> Option<&'static str> {
    let level = FLASH.optcr().read().bor_lev();
    if level == LEVEL_3 { None } else { LEVELS.get(usize::from(level)).copied() }
}

/// Sets the brown-out level to 3, which is in force from the next power-up; `false` if the chip refuses.
/// Hazard: the core stalls while the option bytes are erased and written, so the heater must be off.
pub(crate) fn set_brown_out_level() -> bool {
    let optcr = FLASH.optcr();
    FLASH.optkeyr().write_value(0x0819_2A3B);
    FLASH.optkeyr().write_value(0x4C5D_6E7F);
    optcr.modify(|w| w.set_bor_lev(LEVEL_3));
    watchdog::with_long_deadline(|| {
        optcr.modify(|w| w.set_optstrt(true));
        while FLASH.sr().read().bsy() {} // for ever, if it must be: the watchdog bites
    });
    optcr.modify(|w| w.set_optlock(true));
    let refused = FLASH.sr().read().wrperr();
    !refused && low_brown_out_level().is_none()
}
