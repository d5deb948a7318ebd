//! A panic: interrupts off, heater off, crash record kept over the reset, reset. In this order.

use core::fmt::Write;
use core::panic::PanicInfo;

use firmware_logic::reset_cause::Death;
use firmware_logic::retained::CrashMessage;

use crate::hardware::{fault, heater};

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    cortex_m::interrupt::disable();
    heater::cut();
    let mut words = CrashMessage::EMPTY;
    if let Some(place) = info.location() {
        let _ = write!(words, "{}:{}: ", place.file(), place.line());
    }
    let _ = write!(words, "{}", info.message());
    fault::die(Death::Panic, words)
}
