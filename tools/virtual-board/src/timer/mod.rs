//! TIM1, TIM2 and TIM5: up-counters with compare channels. The counter is not stepped: it follows from the time at which
//! it was last set. TIM1 also drives the pins of heater and contactor, with a break input that no program can overrule.

mod capture;
mod output;

use crate::registers::{Refusal, bit};
use crate::time::{NEVER, Ps};

use capture::Capture;

pub use output::Output;

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const SMCR: u32 = 0x08;
const DIER: u32 = 0x0C;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CCMR1: u32 = 0x18;
const CCMR2: u32 = 0x1C;
const CCER: u32 = 0x20;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2C;
const RCR: u32 = 0x30;
const CCR1: u32 = 0x34;
const CCR4: u32 = 0x40;
const BDTR: u32 = 0x44;
const OR: u32 = 0x50;

const CEN: u32 = 1;
const URS: u32 = 1 << 2;
const ARPE: u32 = 1 << 7;
/// One-pulse, a disabled update, down- and centre-counting are not modelled.
const CR1_BITS: u32 = CEN | URS | ARPE;
const UIF: u32 = 1;
const BIF: u32 = 1 << 7;
/// BG of EGR: a break made by the program.
const BREAK: u32 = 1 << 7;

/// Which interrupt lines a timer raises.
pub struct Lines {
    /// Update, compare and break, one number for all where the timer has one.
    pub update: u16,
    /// Compare.
    pub compare: u16,
    /// Break.
    pub brk: u16,
}

/// A timer.
pub struct Timer {
    /// Its interrupts.
    pub lines: Lines,
    /// What the counter begins with when the program starts it anew: 0 on silicon, else a test of its wrap.
    pub begins_at: u32,
    /// Its break has no effect, whatever asks for it.
    pub break_is_dead: bool,
    advanced: bool,
    width: u32,
    kernel_period: Ps,
    cr1: u32,
    cr2: u32,
    dier: u32,
    sr: u32,
    ccmr: [u32; 2],
    ccer: u32,
    psc: u32,
    arr: u32,
    ccr: [u32; 4],
    /// What is in force of the prescaler, the reload and the compare values; a preload follows at the next update.
    psc_active: u32,
    arr_active: u32,
    ccr_active: [u32; 4],
    bdtr: u32,
    /// The lock is written once, with the first write to its register.
    bdtr_written: bool,
    /// A debugger has halted the core, and this timer with it.
    frozen: bool,
    /// The counter was `base` at `origin`.
    base: u32,
    origin: Ps,
    /// Flags are up to date until here.
    seen: Ps,
    break_level: bool,
    capture: Capture,
}

impl Timer {
    /// A general-purpose timer of 32 bits.
    pub fn general(interrupt: u16) -> Self {
        Self::new(false, Lines { update: interrupt, compare: interrupt, brk: interrupt })
    }

    /// The advanced timer of 16 bits.
    pub fn advanced(lines: Lines) -> Self {
        Self::new(true, lines)
    }

    fn new(advanced: bool, lines: Lines) -> Self {
        let width = if advanced { 0xFFFF } else { u32::MAX };
        Self {
            lines,
            begins_at: 0,
            break_is_dead: false,
            advanced,
            width,
            kernel_period: 62_500,
            cr1: 0,
            cr2: 0,
            dier: 0,
            sr: 0,
            ccmr: [0; 2],
            ccer: 0,
            psc: 0,
            arr: width,
            ccr: [0; 4],
            psc_active: 0,
            arr_active: width,
            ccr_active: [0; 4],
            bdtr: 0,
            bdtr_written: false,
            frozen: false,
            base: 0,
            origin: 0,
            seen: 0,
            break_level: false,
            capture: Capture::NONE,
        }
    }

    /// As after reset; what is wired to it stays.
    pub fn reset(&mut self, now: Ps) {
        let lines = Lines { ..self.lines };
        let fresh = Self::new(self.advanced, lines);
        *self = Self {
            begins_at: self.begins_at,
            break_is_dead: self.break_is_dead,
            kernel_period: self.kernel_period,
            break_level: self.break_level,
            capture: Capture { period: self.capture.period, ..Capture::NONE },
            seen: now,
            origin: now,
            ..fresh
        };
    }

    /// The clock that feeds it has changed.
    pub fn set_clock(&mut self, kernel_period: Ps, now: Ps) {
        self.advance(now);
        self.rebase(now, self.count(now));
        self.kernel_period = kernel_period;
    }

    /// Stops it while a debugger halts the core, or lets it go on.
    pub fn freeze(&mut self, frozen: bool, now: Ps) {
        self.advance(now);
        self.rebase(now, self.count(now));
        self.frozen = frozen;
    }

    fn tick(&self) -> Ps {
        self.kernel_period * Ps::from(self.psc_active + 1)
    }

    fn running(&self) -> bool {
        self.cr1 & CEN != 0 && !self.frozen
    }

    fn span(&self) -> u64 {
        u64::from(self.arr_active) + 1
    }

    fn rebase(&mut self, now: Ps, count: u32) {
        (self.base, self.origin, self.seen) = (count, now, now);
    }

    fn steps(&self, now: Ps) -> u64 {
        if self.running() { (now - self.origin) / self.tick() } else { 0 }
    }

    /// The counter.
    pub fn count(&self, now: Ps) -> u32 {
        ((u64::from(self.base) + self.steps(now)) % self.span()) as u32
    }

    /// Steps until the counter, after `from` steps, next becomes `value`; `None` if it never does.
    fn steps_to(&self, value: u32, from: u64) -> Option<u64> {
        let span = self.span();
        if u64::from(value) >= span {
            return None;
        }
        let at = (u64::from(self.base) + from) % span;
        let ahead = (u64::from(value) + span - at) % span;
        Some(from + if ahead == 0 { span } else { ahead })
    }

    /// Whether the next update changes how fast or how far the counter runs.
    fn reload_waits(&self) -> bool {
        self.psc != self.psc_active || self.arr != self.arr_active
    }

    /// When the counter next becomes 0.
    fn next_update(&self) -> Ps {
        let step = self.steps_to(0, self.steps(self.seen));
        step.map_or(NEVER, |step| self.origin + step * self.tick())
    }

    /// Sets the flags of all that has happened until `now`.
    pub fn advance(&mut self, now: Ps) {
        self.capture_until(now);
        while self.running() && self.reload_waits() && self.next_update() <= now {
            let at = self.next_update();
            self.pass(at);
            self.rebase(at, 0);
        }
        self.pass(now);
    }

    fn pass(&mut self, now: Ps) {
        if now <= self.seen || !self.running() {
            self.seen = self.seen.max(now);
            return;
        }
        let (from, to) = (self.steps(self.seen), self.steps(now));
        if to > from {
            let passed = |value| self.steps_to(value, from).is_some_and(|step| step <= to);
            let updated = passed(0);
            let compared =
                (0..4).filter(|&i| !self.is_input(i) && passed(self.ccr[i])).fold(0, |bits, i| bits | 2 << i);
            self.sr |= compared;
            if updated {
                self.update();
                self.sr |= UIF;
            }
        }
        self.seen = now;
    }

    fn update(&mut self) {
        (self.psc_active, self.arr_active, self.ccr_active) = (self.psc, self.arr, self.ccr);
        self.enable_by_itself();
    }

    /// When it next has something to say that nobody asks for: an interrupt, or a new duty at the pin.
    pub fn next_event(&self) -> Ps {
        if !self.running() {
            return NEVER;
        }
        let from = self.steps(self.seen);
        let at = |value| self.steps_to(value, from).map_or(NEVER, |step| self.origin + step * self.tick());
        let asked = (0..4).filter(|&i| !self.is_input(i) && self.dier & !self.sr & 2 << i != 0);
        let compares = asked.map(|i| at(self.ccr[i])).chain([self.next_capture()]);
        let drives =
            self.advanced && (self.ccr_active != self.ccr || self.reload_waits() || self.may_enable());
        let update = self.dier & !self.sr & UIF != 0 || drives;
        compares.chain(update.then(|| at(0))).min().unwrap_or(NEVER)
    }

    /// Which of its interrupt lines are high: update, compare, break.
    pub fn levels(&self) -> [(u16, bool); 3] {
        let high = self.sr & self.dier;
        [
            (self.lines.update, high & UIF != 0),
            (self.lines.compare, high & 0x1E != 0),
            (self.lines.brk, high & BIF != 0),
        ]
    }

    /// Reads a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&mut self, offset: u32, now: Ps) -> Result<u32, Refusal> {
        self.advance(now);
        Ok(match offset {
            CR1 => self.cr1,
            CR2 => self.cr2,
            DIER => self.dier,
            SR => self.sr,
            CCMR1 | CCMR2 => self.ccmr[(offset - CCMR1) as usize / 4],
            CCER => self.ccer,
            CNT => self.count(now),
            PSC => self.psc,
            ARR => self.arr,
            CCR1..=CCR4 => self.read_ccr((offset - CCR1) as usize / 4),
            OR if !self.advanced => self.capture.or,
            BDTR if self.advanced => self.bdtr,
            SMCR | EGR | RCR => 0,
            _ => return Err("no such register in the model".into()),
        })
    }

    /// Writes a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, offset: u32, value: u32, now: Ps) -> Result<(), Refusal> {
        self.advance(now);
        match offset {
            CR1 => self.write_cr1(value, now)?,
            CR2 => self.cr2 = self.locked(1, 0x7F00, self.cr2, value),
            SMCR | RCR if value == 0 => {}
            DIER => self.write_dier(value)?,
            SR => {
                self.sr &= value;
                self.apply_break(); // its flag stays while the input is active
            }
            EGR => self.generate(value, now)?,
            CCMR1 | CCMR2 => self.write_ccmr((offset - CCMR1) as usize / 4, value)?,
            CCER => {
                let before = self.ccer;
                self.ccer = self.locked(2, 0xAAAA, before, value);
                if self.ccer != before {
                    self.schedule_capture(now);
                }
            }
            OR if !self.advanced => self.write_or(value, now)?,
            CNT => self.rebase(now, value & self.width),
            PSC => self.psc = value & 0xFFFF,
            ARR => {
                self.arr = value & self.width;
                if self.cr1 & ARPE == 0 {
                    self.rebase(now, self.count(now));
                    self.arr_active = self.arr;
                }
            }
            CCR1..=CCR4 => self.write_ccr((offset - CCR1) as usize / 4, value & self.width),
            BDTR if self.advanced => self.write_bdtr(value),
            _ => return Err(format!("writing {value:#x} here is not modelled")),
        }
        Ok(())
    }

    fn write_cr1(&mut self, value: u32, now: Ps) -> Result<(), Refusal> {
        if value & !CR1_BITS != 0 {
            return Err(format!("CR1: bits {:#x} are not modelled", value & !CR1_BITS));
        }
        self.rebase(now, self.count(now));
        self.cr1 = value;
        Ok(())
    }

    fn write_dier(&mut self, value: u32) -> Result<(), Refusal> {
        if value & 0xFF00 != 0 {
            return Err("DIER: DMA requests are not modelled".into());
        }
        self.dier = value;
        Ok(())
    }

    fn generate(&mut self, value: u32, now: Ps) -> Result<(), Refusal> {
        let known = if self.advanced { 0x1F | BREAK } else { 0x1F };
        if value & !known != 0 {
            return Err(format!("EGR: bits {value:#x} are not modelled"));
        }
        if value & BREAK != 0 {
            self.break_now();
        }
        self.sr |= value & 0x1E;
        if value & 1 != 0 {
            self.update();
            self.rebase(now, self.begins_at);
            if self.cr1 & URS == 0 {
                self.sr |= UIF;
            }
        }
        Ok(())
    }

    fn write_ccr(&mut self, channel: usize, value: u32) {
        self.ccr[channel] = value;
        if !bit(self.ccmr[channel / 2], 3 + 8 * (channel as u32 % 2)) {
            self.ccr_active[channel] = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::US;

    fn microseconds() -> Timer {
        let mut timer = Timer::general(50);
        timer.set_clock(10_000, 0);
        timer.write(PSC, 99, 0).unwrap();
        timer.write(CR1, URS, 0).unwrap();
        timer.write(EGR, 1, 0).unwrap();
        timer.write(CR1, URS | CEN, 0).unwrap();
        timer
    }

    #[test]
    fn counts_compares_and_says_when() {
        let mut timer = microseconds();
        timer.write(CCR1, 50, 0).unwrap();
        timer.write(DIER, 2, 0).unwrap();
        assert_eq!(timer.next_event(), 50 * US);
        assert_eq!(timer.read(SR, 50 * US - 1).unwrap() & 2, 0);
        assert_eq!(timer.read(SR, 50 * US).unwrap() & 2, 2);
        assert_eq!(timer.read(CNT, 77 * US).unwrap(), 77);
        timer.write(SR, !2, 77 * US).unwrap();
        assert_eq!(timer.next_event(), (50 + (1 << 32)) * US, "a whole wrap later");
    }

    #[test]
    fn wraps() {
        let mut timer = microseconds();
        timer.rebase(0, u32::MAX - 1);
        timer.write(DIER, 1, 0).unwrap();
        assert_eq!(timer.next_event(), 2 * US);
        assert_eq!(timer.read(CNT, 3 * US).unwrap(), 1);
        assert_eq!(timer.read(SR, 3 * US).unwrap() & UIF, UIF);
    }
}
