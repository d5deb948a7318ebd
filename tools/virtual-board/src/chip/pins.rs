//! The pins that heat: what the heater and the contactor in series with it get to see.

use super::Chip;
use crate::gpio::{IDR, Mode, PullInside};
use crate::time::Ps;
use crate::timer::Output;
use crate::wiring::Pull;

/// Pins of port A, and channels of TIM1, counted from 0.
const HEATER: (usize, usize) = (8, 0);
const CONTACTOR: (usize, usize) = (10, 2);

impl Chip {
    /// Share of the time that the heater's pin is high.
    pub fn heater(&self) -> f64 {
        self.high(HEATER, self.wiring.heater)
    }

    /// Share of the time that the contactor's pin is high.
    pub fn contactor(&self) -> f64 {
        self.high(CONTACTOR, self.wiring.contactor)
    }

    /// Whether the program holds both pins at a level, and they are not left to what pulls them.
    pub fn pins_are_driven(&self) -> [bool; 2] {
        [HEATER, CONTACTOR].map(|pin| self.driven(pin).is_some())
    }

    /// Share of the time that the heater is on.
    pub fn power_at_rig(&self) -> f64 {
        let stage = if self.wiring.stage_shorted { 1.0 } else { self.heater() };
        stage * if self.wiring.contactor_fitted { self.contactor() } else { 1.0 }
    }

    /// The port's input register with what is at both pins at a time.
    pub(super) fn with_levels(&self, offset: u32, bits: u32, now: Ps) -> u32 {
        let high = [self.heater(), self.contactor()].map(|high| self.tim1.phase(now) < high);
        let pins = [HEATER, CONTACTOR].into_iter().zip(high);
        let set =
            |bits: u32, ((pin, _), high): ((usize, usize), bool)| bits & !(1 << pin) | u32::from(high) << pin;
        if offset == IDR { pins.fold(bits, set) } else { bits }
    }

    /// What drives a pin; `None` if nothing does.
    fn driven(&self, (pin, channel): (usize, usize)) -> Option<f64> {
        let port = &self.ports[0];
        match (port.mode(pin), self.tim1.output(channel)) {
            (Mode::Output, _) => Some(f64::from(u8::from(port.driven(pin)))),
            (Mode::Alternate(1), Output::Driven(high)) => Some(high),
            _ => None,
        }
    }

    fn high(&self, pin: (usize, usize), outside: Pull) -> f64 {
        let pulled = || match (outside, self.ports[0].pull(pin.0)) {
            // The chip's own pull is weaker than any resistor on the board.
            (Pull::None, PullInside::Down) => 0.0,
            _ => outside.level(),
        };
        match outside {
            Pull::Short => 1.0,
            _ => self.driven(pin).unwrap_or_else(pulled),
        }
    }
}
