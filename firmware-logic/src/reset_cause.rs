//! Why the board has started: the flags that the chip keeps, read together with what a dying program left behind.

/// Flags of the reset and clock control (RCC_CSR); several can be set at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ResetFlags {
    /// Power came up.
    pub power_on: bool,
    /// Supply fell below the brown-out level; also set whenever power comes up.
    pub brown_out: bool,
    /// The reset pin was low; also set by every internal reset, which pulls the pin.
    pub pin: bool,
    /// The program asked for it.
    pub software: bool,
    /// The independent watchdog starved.
    pub watchdog: bool,
    /// The window watchdog, which is not used.
    pub window_watchdog: bool,
    /// A low-power mode that is not used was entered.
    pub low_power: bool,
}

/// What a dying program left behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Death {
    /// A panic.
    Panic,
    /// A HardFault, stack overflow included.
    HardFault,
    /// The external clock stopped while running.
    ClockFailure,
    /// An interrupt that nothing handles.
    StrayInterrupt,
}

/// How the board was told to start anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Restart {
    /// With the stream on from the first tick.
    Streaming,
    /// The same, with codes from the port in place of the converter's, and both outputs locked off.
    Simulating,
}

/// Why the board has started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ResetCause {
    /// Power came up.
    PowerOn,
    /// Somebody pressed reset, or a debugger did.
    Pin,
    /// The supply sagged.
    BrownOut,
    /// A task was silent for too long.
    Watchdog,
    /// The program died and said how.
    Died(Death),
    /// Somebody asked for it, with the heater off.
    Restarted(Restart),
    /// A software reset that nobody signed.
    Software,
    /// Flags that should never be seen.
    Unexpected,
}

impl ResetCause {
    /// Judges flags and legacy. A watchdog flag outranks the rest, since a program may well die and then hang; a crash record
    /// outrank power-on, since a sag of the supply looks like it and leaves the memory as it was.
    pub fn new(flags: ResetFlags, death: Option<Death>, restart: Option<Restart>) -> Self {
        match (flags, death) {
            (ResetFlags { power_on: true, .. }, None) => Self::PowerOn,
            (ResetFlags { power_on: true, .. }, Some(death)) => Self::Died(death),
            (ResetFlags { brown_out: true, .. }, _) => Self::BrownOut,
            (ResetFlags { watchdog: true, .. }, None) => Self::Watchdog,
            (ResetFlags { watchdog: true, .. } | ResetFlags { software: true, .. }, Some(death)) => {
                Self::Died(death)
            }
            (ResetFlags { software: true, .. }, None) => restart.map_or(Self::Software, Self::Restarted),
            (ResetFlags { window_watchdog: true, .. } | ResetFlags { low_power: true, .. }, _) => {
                Self::Unexpected
            }
            (ResetFlags { pin: true, .. }, Some(death)) => Self::Died(death),
            (ResetFlags { pin: true, .. }, None) => Self::Pin,
            _ => Self::Unexpected,
        }
    }

    /// Whether the heater must stay off until somebody has acknowledged it.
    pub fn is_fault(self) -> bool {
        !matches!(self, Self::PowerOn | Self::Pin | Self::Restarted(_))
    }

    /// Name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::PowerOn => "power-on",
            Self::Pin => "reset pin",
            Self::BrownOut => "brown-out",
            Self::Watchdog => "watchdog",
            Self::Died(Death::Panic) => "panic",
            Self::Died(Death::HardFault) => "HardFault",
            Self::Died(Death::ClockFailure) => "clock failure",
            Self::Died(Death::StrayInterrupt) => "stray interrupt",
            Self::Restarted(Restart::Streaming) => "restart",
            Self::Restarted(Restart::Simulating) => "restart, simulated",
            Self::Software => "software reset",
            Self::Unexpected => "unexpected reset",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIN: ResetFlags = ResetFlags {
        pin: true,
        power_on: false,
        brown_out: false,
        software: false,
        watchdog: false,
        window_watchdog: false,
        low_power: false,
    };

    #[test]
    fn flags_as_the_chip_sets_them() {
        let cases = [
            (ResetFlags { power_on: true, brown_out: true, ..PIN }, None, ResetCause::PowerOn),
            (ResetFlags { brown_out: true, ..PIN }, None, ResetCause::BrownOut),
            (PIN, None, ResetCause::Pin),
            (ResetFlags { watchdog: true, ..PIN }, None, ResetCause::Watchdog),
            (ResetFlags { software: true, ..PIN }, None, ResetCause::Software),
            (ResetFlags { software: true, ..PIN }, Some(Death::Panic), ResetCause::Died(Death::Panic)),
            (
                ResetFlags { watchdog: true, ..PIN },
                Some(Death::HardFault),
                ResetCause::Died(Death::HardFault),
            ),
            (PIN, Some(Death::Panic), ResetCause::Died(Death::Panic)),
            (ResetFlags { low_power: true, ..PIN }, None, ResetCause::Unexpected),
            (ResetFlags::default(), None, ResetCause::Unexpected),
        ];
        for (flags, death, cause) in cases {
            assert_eq!(ResetCause::new(flags, death, None), cause, "{flags:?}");
        }
        let ordered = |flags, death| ResetCause::new(flags, death, Some(Restart::Streaming));
        let software = ResetFlags { software: true, ..PIN };
        assert_eq!(ordered(software, None), ResetCause::Restarted(Restart::Streaming));
        assert_eq!(ordered(ResetFlags { watchdog: true, ..software }, None), ResetCause::Watchdog);
        assert_eq!(ordered(software, Some(Death::Panic)), ResetCause::Died(Death::Panic));
        assert_eq!(ordered(PIN, None), ResetCause::Pin, "the button was quicker");
    }

    #[test]
    fn last_words_that_a_sag_has_left_are_believed() {
        let flags = ResetFlags { power_on: true, brown_out: true, ..PIN };
        assert_eq!(ResetCause::new(flags, Some(Death::Panic), None), ResetCause::Died(Death::Panic));
    }

    #[test]
    fn only_power_the_reset_button_and_an_order_are_no_faults() {
        let all = [
            ResetCause::PowerOn,
            ResetCause::Pin,
            ResetCause::BrownOut,
            ResetCause::Watchdog,
            ResetCause::Died(Death::Panic),
            ResetCause::Software,
            ResetCause::Restarted(Restart::Streaming),
            ResetCause::Unexpected,
        ];
        let harmless: Vec<_> = all.into_iter().filter(|cause| !cause.is_fault()).collect();
        assert_eq!(
            harmless,
            [ResetCause::PowerOn, ResetCause::Pin, ResetCause::Restarted(Restart::Streaming)]
        );
    }
}
