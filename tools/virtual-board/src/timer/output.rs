//! The output side of the advanced timer: what it does to its pins, the break input, and the lock that keeps both as they
//! are. After RM0383: the table of the output control bits, and the descriptions of BDTR, CCER and CCMRx.

use super::{BIF, CEN, Timer};
use crate::registers::{Refusal, bit, field};

const BKE: u32 = 1 << 12;
const BKP: u32 = 1 << 13;
const MOE: u32 = 1 << 15;
const AOE: u32 = 1 << 14;
const OSSR: u32 = 1 << 11;
const OSSI: u32 = 1 << 10;

/// What the timer does to the pin of a channel.
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
        let lock = if self.bdtr_written { old & 0x300 } else { new & 0x300 };
        self.bdtr_written = true;
        self.bdtr = new & !0x300 | lock;
        self.apply_break();
    }

    pub(super) fn write_ccmr(&mut self, half: usize, value: u32) -> Result<(), Refusal> {
        let old = self.ccmr[half];
        let mut new = self.locked(3, 0x7878, old, value); // OCxM, OCxPE
        for channel in 0..2 {
            // The direction of a channel that is on cannot be changed.
            let direction = 3 << (8 * channel);
            if bit(self.ccer, 4 * (2 * half as u32 + channel)) {
                new = new & !direction | old & direction;
            }
        }
        self.check_input(half, new)?;
        self.ccmr[half] = new;
        Ok(())
    }

    /// The level at the break input.
    pub fn set_break_level(&mut self, level: bool) {
        self.break_level = level;
        self.apply_break();
    }

    /// Something inside the chip breaks: the clock's guard.
    pub fn break_now(&mut self) {
        if self.bdtr & BKE != 0 && !self.break_is_dead {
            self.bdtr &= !MOE;
            self.sr |= BIF;
        }
    }

    fn break_is_active(&self) -> bool {
        self.bdtr & BKE != 0 && self.break_level == (self.bdtr & BKP != 0)
    }

    pub(super) fn apply_break(&mut self) {
        if self.break_is_active() {
            self.break_now();
        }
    }

    /// Whether the next update enables the outputs without the program: AOE.
    pub(super) fn may_enable(&self) -> bool {
        self.bdtr & AOE != 0 && self.bdtr & MOE == 0 && !self.break_is_active()
    }

    pub(super) fn enable_by_itself(&mut self) {
        if self.may_enable() {
            self.bdtr |= MOE;
        }
    }

    /// A channel, counted from 0, as its pin sees it. A timer that a debugger has frozen has its outputs off, as if MOE
    /// were clear.
    pub fn output(&self, channel: usize) -> Output {
        let at = |bit: u32| bit + 4 * channel as u32;
        let (enabled, complement) = (bit(self.ccer, at(0)), channel < 3 && bit(self.ccer, at(2)));
        let inactive = f64::from(u8::from(bit(self.ccer, at(1))));
        if self.bdtr & MOE == 0 || self.frozen {
            // The idle level, where OSSI asks for it; else the timer lets go of the pin.
            let idle = f64::from(u8::from(bit(self.cr2, 8 + 2 * channel as u32)));
            let driven = self.bdtr & OSSI != 0 && (enabled || complement);
            return if driven { Output::Driven(idle) } else { Output::Released };
        }
        if !enabled {
            // OSSR holds a channel that is off only where its complement is on.
            let driven = self.bdtr & OSSR != 0 && complement;
            return if driven { Output::Driven(inactive) } else { Output::Released };
        }
        let high = self.reference(channel);
        Output::Driven(if bit(self.ccer, at(1)) { 1.0 - high } else { high })
    }

    /// Share of the time that the reference of a channel is high. A counter that stands keeps its level.
    fn reference(&self, channel: usize) -> f64 {
        let compare = self.ccr_active[channel];
        let below = if self.cr1 & CEN != 0 {
            (f64::from(compare) / self.span() as f64).min(1.0)
        } else {
            f64::from(u8::from(self.base < compare))
        };
        match field(self.ccmr[channel / 2], 4 + 8 * (channel as u32 % 2), 3) {
            6 => below,
            7 => 1.0 - below,
            5 => 1.0,
            _ => 0.0,
        }
    }

    /// Where in its period the counter is, as a share of it.
    pub fn phase(&self, now: u64) -> f64 {
        f64::from(self.count(now)) / self.span() as f64
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
        assert_eq!(timer.output(0), Output::Driven(0.0));
        assert_eq!(timer.next_event(), 50 * US);
        timer.advance(50 * US);
        assert_eq!(timer.output(0), Output::Driven(0.5));
        timer.set_break_level(true);
        assert_eq!(timer.output(0), Output::Driven(0.0));
        timer.write(BDTR, BKE | BKP | OSSI | MOE, 60 * US).unwrap();
        assert_eq!(timer.output(0), Output::Driven(0.0), "not while the input is open");
        timer.set_break_level(false);
        assert_eq!(timer.output(0), Output::Driven(0.0), "not by itself");
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

    #[test]
    fn the_lock_is_written_once() {
        let mut timer = Timer::advanced(Lines { update: 25, compare: 27, brk: 24 });
        timer.write(BDTR, 0, 0).unwrap();
        timer.write(BDTR, 0x300, 0).unwrap();
        assert_eq!(timer.bdtr, 0, "the first write has left it open for ever");
    }

    #[test]
    fn who_drives_the_pin() {
        // (MOE, OSSI, OSSR, CC1E, CC1NE) and what the pin of channel 1 sees, with half power and the idle level high.
        let table = [
            (0, OSSI, 0, 1, Output::Driven(1.0)),
            (0, 0, OSSR, 1, Output::Released),
            (0, OSSI, 0, 0, Output::Released),
            (0, OSSI, 0, 4, Output::Driven(1.0)),
            (MOE, 0, 0, 1, Output::Driven(0.5)),
            (MOE, OSSI, OSSR, 0, Output::Released),
            (MOE, OSSI, 0, 4, Output::Released),
            (MOE, 0, OSSR, 4, Output::Driven(0.0)),
        ];
        for (moe, ossi, ossr, ccer, expected) in table {
            let mut timer = Timer::advanced(Lines { update: 25, compare: 27, brk: 24 });
            for (register, value) in [(ARR, 4999), (CCMR1, 0x60), (CCR1, 2500), (CR2, 0x100), (CCER, ccer)] {
                timer.write(register, value, 0).unwrap();
            }
            timer.write(BDTR, moe | ossi | ossr, 0).unwrap();
            timer.write(CR1, CEN, 0).unwrap();
            assert_eq!(timer.output(0), expected, "MOE {moe:#x} OSSI {ossi:#x} OSSR {ossr:#x} CCER {ccer}");
        }
    }

    #[test]
    fn frozen_by_a_debugger_it_stands_and_its_outputs_are_off() {
        let mut timer = heater();
        timer.write(BDTR, BKE | BKP | OSSI | 0x300 | MOE, 0).unwrap();
        timer.write(CCR1, 2500, 0).unwrap();
        timer.advance(70 * US);
        timer.freeze(true, 70 * US);
        assert_eq!((timer.output(0), timer.count(90 * US)), (Output::Driven(0.0), 2000));
        timer.freeze(false, 100 * US);
        assert_eq!((timer.output(0), timer.count(100 * US)), (Output::Driven(0.5), 2000), "on again");
    }

    #[test]
    fn automatic_enable_waits_for_the_next_update_and_a_closed_break_input() {
        let mut timer = heater();
        timer.bdtr |= AOE;
        timer.set_break_level(true);
        timer.advance(60 * US);
        assert_eq!(timer.bdtr & MOE, 0);
        timer.set_break_level(false);
        timer.advance(110 * US);
        assert_eq!(timer.bdtr & MOE, MOE);
    }
}
