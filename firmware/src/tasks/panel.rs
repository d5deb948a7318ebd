//! The button, held for two seconds, acknowledges; the LED says how things are: dark off, lit heating, blinking held.

use embassy_time::Timer;
use fdi_core::Command;
use firmware_logic::checkin::Task;
use firmware_logic::control_loop::Order;
use firmware_logic::hold_button::HoldButton;

use crate::hardware::panel::Panel;
use crate::instrument::Instrument;
use crate::link::check_in;

const PERIOD_MS: u32 = 50;
/// Half a period of blinking, in rounds of the loop.
const BLINK: u32 = 5;

/// Button and LED.
#[embassy_executor::task]
pub(crate) async fn panel(mut panel: Panel, instrument: &'static Instrument) {
    let mut button = HoldButton::new(2000 / PERIOD_MS);
    let mut round = 0u32;
    loop {
        round = round.wrapping_add(1);
        check_in(Task::Panel);
        if button.step(panel.pressed()) {
            defmt::info!("button held: acknowledge");
            if !instrument.post(Order::Command(Command::Acknowledge)) {
                defmt::warn!("busy, hold the button again");
            }
        }
        let blink = (round / BLINK).is_multiple_of(2);
        panel.light(instrument.is_heating() || (instrument.is_held() && blink));
        Timer::after_millis(PERIOD_MS.into()).await;
    }
}
