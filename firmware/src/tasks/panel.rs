//! The button stops what heats when it is pressed, and acknowledges when it is held for two seconds; the LED says how
//! things are.

use core::sync::atomic::Ordering;

use embassy_time::Timer;
use fdi_core::Command;
use firmware_logic::control_loop::Order;
use firmware_logic::hold_button::{HoldButton, Press};
use firmware_logic::status::Status;
use firmware_logic::task_watchdog::Task;

use crate::hardware::heater;
use crate::hardware::panel::Panel;
use crate::link::{self, check_in};
use crate::shared::{Shared, stop};

const PERIOD_MS: u32 = 50;

/// Button and LED.
#[embassy_executor::task]
pub(crate) async fn panel(mut panel: Panel, shared: &'static Shared) {
    let mut button = HoldButton::new(2000 / PERIOD_MS);
    let mut look = 0u32;
    loop {
        look = look.wrapping_add(1);
        check_in(Task::Panel);
        // The output itself, since the last tick may not know yet.
        let heating = heater::is_enabled() || shared.read(Status::may_heat);
        match button.step(panel.pressed(), heating) {
            Some(Press::Stop) => {
                stop();
                link::PRESSED.store(true, Ordering::Relaxed);
                defmt::info!("button pressed: stop");
            }
            Some(Press::Acknowledge) => {
                defmt::info!("button held: acknowledge");
                if !shared.post(Order::Command(Command::Acknowledge)) {
                    defmt::warn!("busy, hold the button again");
                }
            }
            None => {}
        }
        panel.light(shared.read(Status::sign).is_lit(look));
        Timer::after_millis(PERIOD_MS.into()).await;
    }
}
