//! The supply: the voltage detector (PVD), which cuts the heater while there is still time to say so, and the level below
//! which the chip holds itself in reset (brown-out, an option byte that the factory leaves off).

use embassy_stm32::interrupt;
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::pac::{EXTI, FLASH, PWR};
use firmware_logic::interlock::Lockout;

use super::{heater, retained, watchdog};

/// The detector's highest threshold: 2.9 V by the reference manual; the data sheet's typical value is 3.0 V, falling.
const THRESHOLD: u8 = 7;
/// Line of the external interrupts on which the detector lies; its edge rises when the supply falls.
const LINE: usize = 16;

/// Begins to watch; the heater's output is set up. A supply that is low already gives no edge: see [`is_low`].
pub(crate) fn watch() {
    PWR.cr1().modify(|w| {
        w.set_pls(THRESHOLD);
        w.set_pvde(true);
    });
    EXTI.rtsr(0).modify(|w| w.set_line(LINE, true));
    EXTI.imr(0).modify(|w| w.set_line(LINE, true));
    // SAFETY: the handler is below and touches only the heater's enable and words that no task reads.
    unsafe { interrupt::PVD.enable() };
}

/// Whether the supply is below the detector's threshold.
pub(crate) fn is_low() -> bool {
    PWR.csr1().read().pvdo()
}

#[interrupt]
fn PVD() {
    EXTI.pr(0).write(|w| w.set_line(LINE, true));
    if heater::cut_because(Lockout::Undervoltage) {
        retained::note_undervoltage();
    }
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
