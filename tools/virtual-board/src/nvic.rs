//! Who is pending, who is active, who may interrupt whom: exceptions by their number, interrupt n being 16 + n.

/// Number of an exception.
pub type Exception = u16;

/// Non-maskable interrupt.
pub const NMI: Exception = 2;
/// Hard fault.
pub const HARD_FAULT: Exception = 3;
/// Bus fault.
pub const BUS_FAULT: Exception = 5;
/// Usage fault.
pub const USAGE_FAULT: Exception = 6;
/// System tick.
pub const SYSTICK: Exception = 15;
/// The first interrupt of a peripheral.
pub const FIRST_INTERRUPT: Exception = 16;

/// Priorities as numbers: lower is more urgent. Nothing active:
const IDLE: i16 = 256;
/// The four bits that the chip implements.
const PRIORITY_BITS: u8 = 0xF0;
/// Exceptions that nobody can disable.
const ALWAYS_ENABLED: u128 = 0xFFFF;

/// The nested vectored interrupt controller.
#[derive(Default)]
pub struct Nvic {
    enabled: u128,
    pending: u128,
    lines: u128,
    priorities: Vec<u8>,
    active: Vec<Exception>,
}

impl Nvic {
    /// As after reset.
    pub fn new() -> Self {
        Self { enabled: ALWAYS_ENABLED, priorities: vec![0; 128], ..Self::default() }
    }

    fn mask(exception: Exception) -> u128 {
        1 << exception
    }

    /// Makes an exception pending.
    pub fn pend(&mut self, exception: Exception) {
        self.pending |= Self::mask(exception);
    }

    /// The level of an interrupt's line. It is latched while high, so that a short pulse is not lost.
    pub fn line(&mut self, interrupt: u16, level: bool) {
        let exception = FIRST_INTERRUPT + interrupt;
        let mask = Self::mask(exception);
        if !level {
            self.lines &= !mask;
        } else {
            self.lines |= mask;
            if !self.active.contains(&exception) {
                self.pending |= mask;
            }
        }
    }

    /// Whether anything enabled is pending.
    pub fn any(&self) -> bool {
        self.pending & self.enabled != 0
    }

    /// Priority of an exception.
    pub fn priority(&self, exception: Exception) -> i16 {
        match exception {
            NMI => -2,
            HARD_FAULT => -1,
            _ => i16::from(self.priorities[usize::from(exception) & 127]),
        }
    }

    /// Priority at which the processor executes, masks aside.
    pub fn active_priority(&self) -> i16 {
        self.active.iter().map(|&e| self.priority(e)).min().unwrap_or(IDLE)
    }

    /// The exception that is to be taken now, given the processor's masks.
    pub fn takeable(&self, primask: bool, basepri: u8) -> Option<Exception> {
        let waiting = self.pending & self.enabled;
        if waiting == 0 {
            return None;
        }
        let best =
            (0..128).filter(|&e| waiting & Self::mask(e) != 0).min_by_key(|&e| (self.priority(e), e))?;
        let mask = if basepri == 0 { IDLE } else { i16::from(basepri) };
        let mask = if primask { mask.min(0) } else { mask };
        (self.priority(best) < self.active_priority().min(mask)).then_some(best)
    }

    /// The exception begins.
    pub fn enter(&mut self, exception: Exception) {
        self.pending &= !Self::mask(exception);
        self.active.push(exception);
    }

    /// The exception ends; a line that is still high makes it pending again.
    pub fn leave(&mut self, exception: Exception) {
        self.active.retain(|&e| e != exception);
        self.pending |= self.lines & Self::mask(exception);
    }

    /// The exception that runs, 0 for none.
    pub fn running(&self) -> Exception {
        self.active.last().copied().unwrap_or(0)
    }

    /// Whether the interrupt is enabled.
    pub fn is_enabled(&self, interrupt: u16) -> bool {
        self.enabled & Self::mask(FIRST_INTERRUPT + interrupt) != 0
    }

    /// Enables or disables an interrupt.
    pub fn enable(&mut self, interrupt: u16, on: bool) {
        let mask = Self::mask(FIRST_INTERRUPT + interrupt);
        self.enabled = if on { self.enabled | mask } else { self.enabled & !mask };
    }

    /// The highest pending exception, enabled or masked by priority or not; 0 for none.
    pub fn vect_pending(&self) -> Exception {
        let waiting = self.pending & self.enabled;
        (0..128).filter(|&e| waiting & Self::mask(e) != 0).min_by_key(|&e| (self.priority(e), e)).unwrap_or(0)
    }

    /// Whether the exception is pending.
    pub fn is_pending(&self, exception: Exception) -> bool {
        self.pending & Self::mask(exception) != 0
    }

    /// Takes back a pending exception; a line that is high brings it back.
    pub fn unpend(&mut self, exception: Exception) {
        self.pending &= !Self::mask(exception);
        self.pending |= self.lines & Self::mask(exception);
    }

    /// Reads 32 interrupts from the bank at `word`: enables or pending bits.
    pub fn bank(&self, pending: bool, word: u32) -> u32 {
        let bits = if pending { self.pending } else { self.enabled };
        (bits >> (16 + 32 * (word & 3)).min(127)) as u32
    }

    /// Sets or clears bits of a bank.
    pub fn write_bank(&mut self, pending: bool, set: bool, word: u32, value: u32) {
        let word = (word & 3) as u16;
        for interrupt in (0..32).filter(|i| value >> i & 1 == 1).map(|i| 32 * word + i) {
            match (pending, set) {
                (false, on) => self.enable(interrupt, on),
                (true, true) => self.pend(FIRST_INTERRUPT + interrupt),
                (true, false) => self.unpend(FIRST_INTERRUPT + interrupt),
            }
        }
    }

    /// The priority byte of an exception.
    pub fn priority_byte(&self, exception: u32) -> u8 {
        self.priorities.get(exception as usize).copied().unwrap_or(0)
    }

    /// Sets the priority byte of an exception.
    pub fn set_priority_byte(&mut self, exception: u32, value: u8) {
        if let Some(priority) = self.priorities.get_mut(exception as usize) {
            *priority = value & PRIORITY_BITS;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(priorities: &[(u16, u8)]) -> Nvic {
        let mut nvic = Nvic::new();
        for &(interrupt, priority) in priorities {
            nvic.enable(interrupt, true);
            nvic.set_priority_byte(u32::from(FIRST_INTERRUPT + interrupt), priority);
        }
        nvic
    }

    #[test]
    fn the_more_urgent_nests_and_the_less_urgent_waits() {
        let mut nvic = with(&[(5, 0x20), (6, 0x10), (7, 0x20)]);
        nvic.pend(FIRST_INTERRUPT + 5);
        assert_eq!(nvic.takeable(false, 0), Some(21));
        nvic.enter(21);
        nvic.pend(FIRST_INTERRUPT + 7);
        assert_eq!(nvic.takeable(false, 0), None, "equal priority does not nest");
        nvic.pend(FIRST_INTERRUPT + 6);
        assert_eq!(nvic.takeable(false, 0), Some(22));
        nvic.enter(22);
        nvic.leave(22);
        nvic.leave(21);
        assert_eq!(nvic.takeable(false, 0), Some(23));
    }

    #[test]
    fn masks_hold_back_all_but_faults() {
        let mut nvic = with(&[(5, 0x20)]);
        nvic.pend(FIRST_INTERRUPT + 5);
        assert_eq!(nvic.takeable(true, 0), None);
        assert_eq!(nvic.takeable(false, 0x20), None);
        assert_eq!(nvic.takeable(false, 0x30), Some(21));
        nvic.pend(HARD_FAULT);
        assert_eq!(nvic.takeable(true, 0), Some(HARD_FAULT));
    }

    #[test]
    fn a_line_that_stays_high_comes_again() {
        let mut nvic = with(&[(5, 0)]);
        nvic.line(5, true);
        nvic.enter(21);
        nvic.line(5, true);
        assert!(!nvic.any());
        nvic.leave(21);
        assert_eq!(nvic.takeable(false, 0), Some(21));
        nvic.line(5, false);
        nvic.enter(21);
        nvic.leave(21);
        assert!(!nvic.any());
    }
}
