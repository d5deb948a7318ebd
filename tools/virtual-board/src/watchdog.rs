//! The independent watchdog, on its own slow oscillator. A new divider acts on the count at hand, a new reload only on the
//! next feeding (RM0383, registers IWDG_PR and IWDG_RLR).

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
    /// Time for one count with the divider 1, as at the last feeding.
    period: Ps,
    /// A debugger has halted the core, and this with it, since then.
    frozen_since: Option<Ps>,
}

impl Watchdog {
    /// Whether it runs.
    pub fn is_started(&self) -> bool {
        self.started
    }

    /// Period of the slow oscillator, which the start of the watchdog starts.
    pub fn slow_period(&self) -> Option<Ps> {
        self.started.then(|| SECOND / self.oscillator)
    }

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
            period: SECOND / oscillator,
            frozen_since: None,
        }
    }

    /// When it resets the chip, or its count goes on at another speed.
    pub fn next_event(&self) -> Ps {
        let changes = if self.started { self.divider.at } else { NEVER };
        if self.frozen_since.is_some() { NEVER } else { self.bites_at.min(changes) }
    }

    /// Lets happen what happens until `now`; whether it resets the chip.
    pub fn advance(&mut self, now: Ps) -> bool {
        self.settle(now);
        self.frozen_since.is_none() && self.bites_at <= now
    }

    /// Stops it while a debugger halts the core, or lets it go on.
    pub fn freeze(&mut self, frozen: bool, now: Ps) {
        self.settle(now);
        match (frozen, self.frozen_since) {
            (true, None) => self.frozen_since = Some(now),
            (false, Some(since)) => {
                self.frozen_since = None;
                self.bites_at = self.bites_at.saturating_add(now - since);
            }
            _ => {}
        }
    }

    /// Time for one count.
    fn count_time(&self) -> Ps {
        self.period * (4 << self.divider.value.min(6))
    }

    fn settle(&mut self, now: Ps) {
        let (before, at) = (self.count_time(), self.divider.at);
        self.divider.settle(now);
        self.reload.settle(now);
        let after = self.count_time();
        if after != before && self.bites_at != NEVER {
            let left = self.bites_at.saturating_sub(at).div_ceil(before);
            self.bites_at = at + left * after;
        }
    }

    fn feed(&mut self, now: Ps) {
        if self.started {
            self.period = SECOND / self.oscillator;
            self.bites_at = now + Ps::from(self.reload.value + 1) * self.count_time();
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
    fn bites_after_its_deadline_unless_fed() {
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

    #[test]
    fn a_new_divider_acts_on_the_count_at_hand() {
        let mut dog = Watchdog::new(32_000);
        dog.write(RLR, 0, 0).unwrap();
        dog.write(KR, 0xCCCC, 0).unwrap(); // 4096 counts of 125 us
        assert_eq!(dog.next_event(), 512 * MS);
        dog.write(KR, 0x5555, 256 * MS).unwrap();
        dog.write(PR, 6, 256 * MS).unwrap(); // from now on 8 ms a count
        let taken_over = dog.next_event();
        assert_eq!(taken_over, 256 * MS + 5 * SECOND / 32_000);
        assert!(!dog.advance(taken_over));
        assert_eq!(dog.next_event(), taken_over + 2047 * 8 * MS);
    }

    #[test]
    fn frozen_it_waits() {
        let mut dog = Watchdog::new(32_000);
        dog.write(KR, 0xCCCC, 0).unwrap();
        dog.freeze(true, 100 * MS);
        assert!(!dog.advance(SECOND));
        dog.freeze(false, 1100 * MS);
        assert_eq!(dog.next_event(), 1512 * MS);
    }
}
