//! The power controller and what watches the supply: power-on reset, brown-out reset by the option bytes, and the
//! programmable voltage detector. After RM0383 (chapter 5) and the typical thresholds of the data sheet.

mod supply;

use crate::clock::Cause;
use crate::registers::{File, Refusal, Register, bit, field, register};
use crate::time::Ps;

pub use supply::Supply;

const CR: u32 = 0x00;
const CSR: u32 = 0x04;

/// DBP, PLS, PVDE, VOS; the low-power modes are not modelled.
static TABLE: [Register; 2] = [register(CR, "CR", 0x8000, 0xC1F0), register(CSR, "CSR", 0, 0x300)];

const PVDE: u32 = 4;
const PVDO: u32 = 1 << 2;
const VOSRDY: u32 = 1 << 14;

/// A threshold with hysteresis, V.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold {
    /// Crossed upwards.
    pub rising: f64,
    /// Crossed downwards.
    pub falling: f64,
}

/// From mV.
const fn threshold(rising: u16, falling: u16) -> Threshold {
    Threshold { rising: rising as f64 / 1000.0, falling: falling as f64 / 1000.0 }
}

/// Power-on and power-down reset.
const POWER_ON: Threshold = threshold(1720, 1680);
/// Brown-out reset by BOR_LEV of the option bytes; 3 is off, where the power-on reset alone watches.
const BROWN_OUT: [Threshold; 4] =
    [threshold(2920, 2830), threshold(2590, 2500), threshold(2290, 2190), POWER_ON];
/// Voltage detector by PLS.
const DETECTOR: [Threshold; 8] = [
    threshold(2140, 2040),
    threshold(2300, 2190),
    threshold(2450, 2350),
    threshold(2600, 2510),
    threshold(2760, 2660),
    threshold(2930, 2820),
    threshold(3030, 2930),
    threshold(3140, 3030),
];

/// What the supply has just done to the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// It is too low: the chip is held in reset.
    Down,
    /// It is high enough again: the chip starts, with this cause.
    Up(Cause),
}

/// The controller.
pub struct Power {
    file: File,
    /// The voltage.
    pub supply: Supply,
    /// Below this voltage RAM loses what it holds. The data sheet promises nothing below the least supply.
    pub ram_holds_above: f64,
    /// RAM has lost what it held.
    pub ram_lost: bool,
    /// BOR_LEV in force: the option bytes as they were when power came up last.
    brown_out: u32,
    held_by: Option<Cause>,
    detected: bool,
}

impl Default for Power {
    fn default() -> Self {
        Self {
            file: File::new(&TABLE),
            supply: Supply::steady(3.3),
            ram_holds_above: 1.8,
            ram_lost: false,
            brown_out: 3,
            held_by: None,
            detected: false,
        }
    }
}

impl Power {
    /// As after a reset; the supply does not care. `brown_out` is BOR_LEV of the option bytes, which a power-on takes over.
    pub fn reset(&mut self, cause: Cause, brown_out: u32) {
        self.file.reset();
        self.detected = false;
        if cause == Cause::PowerOn {
            self.brown_out = brown_out;
        }
    }

    /// Whether the chip is held in reset.
    pub fn holds(&self) -> bool {
        self.held_by.is_some()
    }

    /// Follows the supply. `brown_out` is BOR_LEV of the option bytes.
    pub fn advance(&mut self, now: Ps, brown_out: u32) -> Option<Event> {
        let volts = self.supply.volts(now);
        self.ram_lost |= volts < self.ram_holds_above;
        self.detect(volts);
        let before = self.held_by;
        if volts < POWER_ON.falling {
            self.held_by = Some(Cause::PowerOn);
            self.brown_out = brown_out;
        } else if volts < BROWN_OUT[self.brown_out as usize & 3].falling {
            self.held_by = before.or(Some(Cause::BrownOut));
        } else if volts > BROWN_OUT[self.brown_out as usize & 3].rising {
            self.held_by = None;
        }
        match (before, self.held_by) {
            (None, Some(_)) => Some(Event::Down),
            (Some(cause), None) => Some(Event::Up(cause)),
            _ => None,
        }
    }

    fn detect(&mut self, volts: f64) {
        let cr = self.file.get(CR);
        let level = DETECTOR[field(cr, 5, 3) as usize];
        self.detected = bit(cr, PVDE) && (volts < level.falling || self.detected && volts < level.rising);
    }

    /// Whether the voltage detector says that the supply is low: line 16 of the external interrupts.
    pub fn is_low(&self) -> bool {
        self.detected
    }

    /// Highest core clock that the voltage scale allows for, Hz.
    pub fn max_hz(&self) -> u64 {
        match field(self.file.get(CR), 14, 2) {
            3 => 100_000_000,
            2 => 84_000_000,
            _ => 64_000_000,
        }
    }

    /// Reads a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&self, offset: u32) -> Result<u32, Refusal> {
        let value = self.file.read(offset)?;
        let low = if self.detected { PVDO } else { 0 };
        Ok(if offset == CSR { value | VOSRDY | low } else { value })
    }

    /// Writes a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, offset: u32, value: u32, now: Ps) -> Result<(), Refusal> {
        self.file.write(offset, value)?;
        self.detect(self.supply.volts(now));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::MS;

    const OFF: u32 = 3;

    /// What the supply does to the chip while it goes to `volts`.
    fn go(power: &mut Power, volts: f64, from: Ps) -> Vec<Event> {
        power.supply.ramp(volts, MS, from);
        (0..=100).filter_map(|i| power.advance(from + i * MS / 100, OFF)).collect()
    }

    #[test]
    fn a_sag_without_brown_out_reset_looks_like_power_on() {
        let mut power = Power::default();
        assert_eq!(go(&mut power, 1.75, 0), []);
        assert_eq!(go(&mut power, 1.5, MS), [Event::Down]);
        assert_eq!(go(&mut power, 3.3, 2 * MS), [Event::Up(Cause::PowerOn)]);
        assert!(power.ram_lost);
    }

    #[test]
    fn brown_out_resets_early_and_says_so() {
        let mut power = Power::default();
        power.reset(Cause::PowerOn, 0);
        assert_eq!(go(&mut power, 2.80, 0), [Event::Down]);
        assert_eq!(go(&mut power, 2.90, MS), [], "hysteresis");
        assert_eq!(go(&mut power, 3.3, 2 * MS), [Event::Up(Cause::BrownOut)]);
        assert!(!power.ram_lost);
    }

    #[test]
    fn the_detector_has_hysteresis_and_must_be_on() {
        let mut power = Power::default();
        go(&mut power, 2.90, 0);
        assert!(!power.is_low(), "it is off");
        power.write(CR, 0x8000 | 6 << 5 | 1 << PVDE, MS).unwrap();
        assert_eq!(power.read(CSR).unwrap() & PVDO, PVDO);
        go(&mut power, 2.99, MS);
        assert!(power.is_low());
        go(&mut power, 3.05, 2 * MS);
        assert!(!power.is_low());
    }
}
