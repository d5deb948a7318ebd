//! The voltage detector (PVD), which cuts the heater while there is still time to say so.

use embassy_stm32::interrupt;
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::pac::{EXTI, PWR};
use firmware_logic::interlock::Lockout;

use super::{heater, retained};

/// The detector's highest threshold: 2.9 V by the reference manual; the data sheet's typical value is 3.0 V, falling.
const THRESHOLD: u8 = 7;
/// Line of the external interrupts on which the detector lies; its edge rises when the supply falls.
const LINE: usize = 16;

/// Begins to watch; the heater's output is set up. A supply that is low already gives no edge: see `supply::is_low`.
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

#[interrupt]
fn PVD() {
    EXTI.pr(0).write(|w| w.set_line(LINE, true));
    if heater::cut_because(Lockout::Undervoltage) {
        retained::note_undervoltage();
    }
}
