//! The independent watchdog, on its own slow oscillator.

use crate::registers::Refusal;
use crate::time::{NEVER, Ps, SECOND};

const KR: u32 = 0x00;
const PR: u32 = 0x04;
const RLR: u32 = 0x08;
const SR: u32 = 0x0C;

/// Periods of the slow oscillator until a new divider or reload is taken over.
const UPDATE_PERIODS: u64 = 5;

/// A register of the slow clock domain: what is in force, and what is on its way.
struct Slow {
    value: u32,
    next: u32,
    at: Ps,
}

impl Slow {
    fn settle(&mut self, now: Ps) {
        if self.at <= now {
            (self.value, self.at) = (self.next, NEVER);
        }
    }

    fn is_busy(&self) -> bool {
        self.at != NEVER
    }
}

/// The watchdog.
pub struct Watchdog {
    /// Frequency of the slow oscillator: 32 kHz nominal, 17 to 47 by the data sheet.
    pub oscillator: u64,
    divider: Slow,
    reload: Slow,
    unlocked: bool,
    started: bool,
    bites_at: Ps,
}

impl Watchdog {
    /// Not started; `oscillator` in Hz.
    pub fn new(oscillator: u64) -> Self {
        let slow = |value| Slow { value, next: value, at: NEVER };
        Self {
            oscillator,
            divider: slow(0),
            reload: slow(0xFFF),
            unlocked: false,
            started: false,
            bites_at: NEVER,
        }
    }

    /// When it resets the chip.
    pub fn next_event(&self) -> Ps {
        self.bites_at
    }

    fn settle(&mut self, now: Ps) {
        self.divider.settle(now);
        self.reload.settle(now);
    }

    fn feed(&mut self, now: Ps) {
        if self.started {
            let periods = u64::from(self.reload.value + 1) * (4 << self.divider.value.min(6));
            self.bites_at = now + periods * SECOND / self.oscillator;
        }
    }

    /// Reads a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&mut self, offset: u32, now: Ps) -> Result<u32, Refusal> {
        self.settle(now);
        match offset {
            KR => Ok(0),
            PR => Ok(self.divider.value),
            RLR => Ok(self.reload.value),
            SR => Ok(u32::from(self.divider.is_busy()) | u32::from(self.reload.is_busy()) << 1),
            _ => Err("no such register in the model".into()),
        }
    }

    /// Writes a register. A write to one that is locked, or still busy with the write before, is lost.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, offset: u32, value: u32, now: Ps) -> Result<(), Refusal> {
        self.settle(now);
        let taken_over = now + UPDATE_PERIODS * SECOND / self.oscillator;
        let at = if self.started { taken_over } else { NEVER - 1 };
        match (offset, value) {
            (KR, 0x5555) => self.unlocked = true,
            (KR, 0xAAAA) => {
                self.unlocked = false;
                self.feed(now);
            }
            (KR, 0xCCCC) => {
                (self.unlocked, self.started) = (false, true);
                self.feed(now);
            }
            (PR | RLR, _) => {
                let slow = if offset == PR { &mut self.divider } else { &mut self.reload };
                if self.unlocked && !slow.is_busy() {
                    (slow.next, slow.at) = (value & if offset == PR { 7 } else { 0xFFF }, at);
                }
            }
            _ => return Err(format!("writing {value:#x} here is not modelled")),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::MS;

    #[test]
    fn bites_after_its_patience_unless_fed() {
        let mut dog = Watchdog::new(32_000);
        assert_eq!(dog.next_event(), NEVER);
        dog.write(KR, 0xCCCC, 0).unwrap();
        dog.write(KR, 0x5555, 0).unwrap();
        dog.write(PR, 2, 0).unwrap();
        dog.write(RLR, 799, 0).unwrap();
        dog.write(RLR, 1, 0).unwrap();
        assert_eq!(dog.read(SR, 0).unwrap(), 3);
        assert_eq!(dog.read(SR, MS).unwrap(), 0);
        assert_eq!(dog.read(RLR, MS).unwrap(), 799, "the write while busy is lost");
        dog.write(KR, 0xAAAA, MS).unwrap();
        assert_eq!(dog.next_event(), 401 * MS);
    }
}
