//! What holds the heater off beyond the supervisor of the core: fault resets and whatever cut the output from outside.
//! It latches until somebody acknowledges it.

use core::fmt;

use crate::doubled::Doubled;
use crate::reset_cause::{Death, ResetCause};

/// Why the heater is locked out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Lockout {
    /// The board has restarted for a reason that is a fault.
    Reset(ResetCause),
    /// The break input was open while the heater was driven.
    BreakInput,
    /// The control tick was missing for more than three periods.
    MissedDeadline,
    /// The supply fell below the voltage detector's threshold while the heater was driven.
    Undervoltage,
    /// The power went while the heater was driven, or was locked out after it had been.
    PowerFailure,
    /// A debugger halted the core while the heater was driven.
    Halted,
    /// Limits or settings in memory are no longer those that were checked.
    Settings,
    /// The clock and the watchdog's oscillator run at another ratio than at the start.
    WrongClock,
    /// Flash or RAM does not hold what was written to it: in the tests of both, in the permission to heat, or in this latch.
    Memory,
    /// A pin of heater or contactor is high although the output is off.
    Output,
}

impl fmt::Display for Lockout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Reset(cause) => write!(f, "restarted after: {}", cause.name()),
            Self::BreakInput => f.write_str("the interlock on the break input opened"),
            Self::MissedDeadline => f.write_str("the control tick was missing for more than 3 periods"),
            Self::Undervoltage => f.write_str("the supply fell below 2.9 V, expected 3.3 V"),
            Self::PowerFailure => {
                f.write_str("the power went before the heater was stopped and acknowledged")
            }
            Self::Halted => f.write_str("a debugger halted the core"),
            Self::Settings => {
                f.write_str("settings in memory have changed by themselves, which only a reset mends")
            }
            Self::WrongClock => {
                f.write_str("the clock runs at a wrong speed, by the oscillator of the watchdog")
            }
            Self::Memory => {
                f.write_str("flash or RAM has changed by itself, or the image is not from `cargo fw`")
            }
            Self::Output => f.write_str("the pin of heater or contactor is high while it is off"),
        }
    }
}

/// All lockouts; the position is the number that [`Lockout::number`] gives.
const ALL: [Lockout; 17] = [
    Lockout::BreakInput,
    Lockout::MissedDeadline,
    Lockout::Reset(ResetCause::BrownOut),
    Lockout::Reset(ResetCause::Watchdog),
    Lockout::Reset(ResetCause::Software),
    Lockout::Reset(ResetCause::Unexpected),
    Lockout::Reset(ResetCause::Died(Death::Panic)),
    Lockout::Reset(ResetCause::Died(Death::HardFault)),
    Lockout::Reset(ResetCause::Died(Death::ClockFailure)),
    Lockout::Reset(ResetCause::Died(Death::StrayInterrupt)),
    Lockout::Undervoltage,
    Lockout::PowerFailure,
    Lockout::Halted,
    Lockout::Settings,
    Lockout::WrongClock,
    Lockout::Memory,
    Lockout::Output,
];

impl Lockout {
    /// A number from 1 on, for memory that outlives a reset.
    pub fn number(self) -> u8 {
        ALL.iter().position(|lockout| *lockout == self).map_or(0, |i| i as u8 + 1)
    }

    /// The lockout with this number.
    pub fn from_number(number: u32) -> Option<Self> {
        ALL.get((number as usize).checked_sub(1)?).copied()
    }
}

/// The latch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interlock {
    /// Number of the lockout, 0 without one.
    number: Doubled,
}

impl Default for Interlock {
    fn default() -> Self {
        Self::of(None)
    }
}

impl Interlock {
    /// At start: a fault reset latches, and so does what was latched before the reset and never acknowledged. That holds
    /// for power-on, too, for without a brown-out level a sag of the supply looks like it; memory that really was without
    /// power holds nothing that is believed.
    pub fn at_boot(cause: ResetCause, left_behind: Option<Lockout>) -> Self {
        Self::of(if cause.is_fault() { Some(Lockout::Reset(cause)) } else { left_behind })
    }

    fn of(lockout: Option<Lockout>) -> Self {
        Self { number: Doubled::new(lockout.map_or(0, |lockout| lockout.number().into())) }
    }

    /// Latches where the flash has the mark that stands there from arming on until the heater is off and acknowledged. After a
    /// reset that was none of the supply's the cause of the reset says all that there is to say.
    pub fn marked(&mut self, cause: ResetCause, marked: bool) {
        if marked && cause == ResetCause::PowerOn {
            self.latch(Lockout::PowerFailure);
        }
    }

    /// What holds the heater off: also where it can no longer be told what did.
    pub fn lockout(&self) -> Option<Lockout> {
        match self.number.get() {
            Some(0) => None,
            number => Some(number.and_then(Lockout::from_number).unwrap_or(Lockout::Memory)),
        }
    }

    /// Latches; the first reason stays until it is acknowledged.
    pub fn latch(&mut self, lockout: Lockout) {
        *self = Self::of(self.lockout().or(Some(lockout)));
    }

    /// Releases the latch. `false` if nothing was latched.
    pub fn acknowledge(&mut self) -> bool {
        core::mem::take(self).lockout().is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_reset_holds_and_has_a_number() {
        let causes = [
            ResetCause::BrownOut,
            ResetCause::Watchdog,
            ResetCause::Software,
            ResetCause::Unexpected,
            ResetCause::Died(Death::Panic),
            ResetCause::Died(Death::HardFault),
            ResetCause::Died(Death::ClockFailure),
            ResetCause::Died(Death::StrayInterrupt),
        ];
        for cause in causes {
            let lockout = Interlock::at_boot(cause, None).lockout();
            assert_eq!(lockout, Some(Lockout::Reset(cause)));
            let number = lockout.map_or(0, Lockout::number);
            assert!(number > 0 && Lockout::from_number(number.into()) == lockout, "{cause:?}: {number}");
        }
        for lockout in ALL {
            assert_eq!(Lockout::from_number(lockout.number().into()), Some(lockout));
        }
        assert_eq!(Lockout::from_number(0), None);
        assert_eq!(Lockout::from_number(ALL.len() as u32 + 1), None);
    }

    #[test]
    fn the_reset_button_is_no_acknowledgement() {
        let held = Interlock::at_boot(ResetCause::Pin, Some(Lockout::BreakInput));
        assert_eq!(held.lockout(), Some(Lockout::BreakInput));
        assert_eq!(Interlock::at_boot(ResetCause::Pin, None).lockout(), None);
    }

    #[test]
    fn a_sag_that_looks_like_power_on_is_no_acknowledgement() {
        let held = Interlock::at_boot(ResetCause::PowerOn, Some(Lockout::Undervoltage));
        assert_eq!(held.lockout(), Some(Lockout::Undervoltage));
        assert_eq!(Interlock::at_boot(ResetCause::PowerOn, None).lockout(), None);
    }

    #[test]
    fn a_mark_in_flash_holds_after_power_on_and_the_first_reason_stays() {
        let mut interlock = Interlock::at_boot(ResetCause::PowerOn, None);
        interlock.marked(ResetCause::PowerOn, false);
        assert_eq!(interlock.lockout(), None);
        interlock.marked(ResetCause::PowerOn, true);
        assert_eq!(interlock.lockout(), Some(Lockout::PowerFailure));
        let mut pressed = Interlock::at_boot(ResetCause::Pin, None);
        pressed.marked(ResetCause::Pin, true);
        assert_eq!(pressed.lockout(), None, "somebody stands there");
        let mut sagged = Interlock::at_boot(ResetCause::PowerOn, Some(Lockout::Undervoltage));
        sagged.marked(ResetCause::PowerOn, true);
        assert_eq!(sagged.lockout(), Some(Lockout::Undervoltage));
    }

    #[test]
    fn the_first_reason_stays_until_acknowledged() {
        let mut interlock = Interlock::default();
        assert!(!interlock.acknowledge());
        interlock.latch(Lockout::MissedDeadline);
        interlock.latch(Lockout::BreakInput);
        assert_eq!(interlock.lockout(), Some(Lockout::MissedDeadline));
        assert!(interlock.acknowledge());
        assert_eq!(interlock.lockout(), None);
    }

    #[test]
    fn a_number_that_no_lockout_has_holds_too() {
        let stray = Interlock { number: Doubled::new(ALL.len() as u32 + 1) };
        assert_eq!(stray.lockout(), Some(Lockout::Memory));
    }
}
