//! The user button and the LED on the board.

use embassy_stm32::Peri;
use embassy_stm32::gpio::{Input, Level, Output, Pull, Speed};

use super::board::{ButtonPin, LedPin};

/// Button B1 and LED LD2.
pub(crate) struct Panel {
    led: Output<'static>,
    button: Input<'static>,
}

impl Panel {
    /// LED off.
    pub(crate) fn new(led: Peri<'static, LedPin>, button: Peri<'static, ButtonPin>) -> Self {
        Self { led: Output::new(led, Level::Low, Speed::Low), button: Input::new(button, Pull::Up) }
    }

    /// Whether the button is held down.
    pub(crate) fn pressed(&self) -> bool {
        self.button.is_low()
    }

    /// Lights the LED.
    pub(crate) fn light(&mut self, on: bool) {
        self.led.set_level(on.into());
    }
}
