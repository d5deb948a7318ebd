//! The output side of the advanced timer: the heater's pin, the break input, and the lock that keeps both as they are.

use super::{BIF, Timer};
use crate::registers::{bit, field};

const BKE: u32 = 1 << 12;
const BKP: u32 = 1 << 13;
const MOE: u32 = 1 << 15;
const OSSI: u32 = 1 << 10;

/// What the timer does to the pin of channel 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Output {
    /// Nothing drives the pin.
    Released,
    /// The pin is driven high for this share of the time.
    Driven(f64),
}

impl Timer {
    /// LOCK of the advanced timer: from `level` on, the bits of `mask` keep what they hold.
    pub(super) fn locked(&self, level: u32, mask: u32, old: u32, new: u32) -> u32 {
        let mask = if self.advanced && field(self.bdtr, 8, 2) >= level { mask } else { 0 };
        new & !mask | old & mask
    }

    pub(super) fn write_bdtr(&mut self, value: u32) {
        let old = self.bdtr;
        let mut new = self.locked(1, 0x70FF, old, value); // BKE, BKP, AOE, dead time
        new = self.locked(2, 0x0C00, old, new); // OSSI, OSSR
        let lock = if field(old, 8, 2) == 0 { new & 0x300 } else { old & 0x300 }; // written once
        self.bdtr = new & !0x300 | lock;
        self.apply_break();
    }

    /// The level at the break input.
    pub fn set_break_level(&mut self, level: bool) {
        self.break_level = level;
        self.apply_break();
    }

    /// Something inside the chip breaks: the clock's guard.
    pub fn break_now(&mut self) {
        if self.bdtr & BKE != 0 {
            self.bdtr &= !MOE;
            self.sr |= BIF;
        }
    }

    fn apply_break(&mut self) {
        let active = self.break_level == (self.bdtr & BKP != 0);
        if active {
            self.break_now();
        }
    }

    /// Channel 1 as the pin sees it.
    pub fn output(&self) -> Output {
        let enabled = bit(self.ccer, 0);
        if self.bdtr & MOE == 0 {
            // The idle level, where OSSI asks for it; else the timer lets go of the pin.
            let idle = f64::from(u8::from(bit(self.cr2, 8)));
            return if self.bdtr & OSSI != 0 && enabled { Output::Driven(idle) } else { Output::Released };
        }
        if !enabled {
            return Output::Released;
        }
        let share = (f64::from(self.ccr1_active) / self.span() as f64).min(1.0);
        let high = match field(self.ccmr[0], 4, 3) {
            6 if self.running() => share,
            7 if self.running() => 1.0 - share,
            5 => 1.0,
            _ => 0.0,
        };
        Output::Driven(if bit(self.ccer, 1) { 1.0 - high } else { high })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{ARR, BDTR, CCER, CCMR1, CCR1, CEN, CR1, CR2, Lines};
    use super::*;
    use crate::time::US;

    fn heater() -> Timer {
        let mut timer = Timer::advanced(Lines { update: 25, compare: 27, brk: 24 });
        timer.set_clock(10_000, 0);
        timer.write(ARR, 4999, 0).unwrap();
        timer.write(CCMR1, 0x68, 0).unwrap();
        timer.write(CCER, 1, 0).unwrap();
        timer.write(BDTR, BKE | BKP | OSSI | 0x300, 0).unwrap();
        timer.write(CR1, CEN, 0).unwrap();
        timer
    }

    #[test]
    fn a_new_duty_shows_at_the_next_update_and_a_break_at_once() {
        let mut timer = heater();
        timer.write(BDTR, BKE | BKP | OSSI | 0x300 | MOE, 0).unwrap();
        timer.write(CCR1, 2500, US).unwrap();
        assert_eq!(timer.output(), Output::Driven(0.0));
        assert_eq!(timer.next_event(), 50 * US);
        timer.advance(50 * US);
        assert_eq!(timer.output(), Output::Driven(0.5));
        timer.set_break_level(true);
        assert_eq!(timer.output(), Output::Driven(0.0));
        timer.write(BDTR, BKE | BKP | OSSI | MOE, 60 * US).unwrap();
        assert_eq!(timer.output(), Output::Driven(0.0), "not while the input is open");
        timer.set_break_level(false);
        assert_eq!(timer.output(), Output::Driven(0.0), "not by itself");
    }

    #[test]
    fn the_lock_keeps_polarity_mode_and_idle_level() {
        let mut timer = heater();
        timer.write(CCER, 3, 0).unwrap();
        timer.write(CCMR1, 0x50, 0).unwrap();
        timer.write(CR2, 0x100, 0).unwrap();
        timer.write(BDTR, 0, 0).unwrap();
        assert_eq!((timer.ccer, timer.ccmr[0], timer.cr2), (1, 0x68, 0));
        assert_eq!(timer.bdtr & (BKE | BKP | OSSI), BKE | BKP | OSSI);
    }
}
