//! Where a check stands, what it begins with, what it asks of the output.

use fdi_core::Percent;

/// Where a check stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Stage {
    /// Looking at the thermistors; no heat.
    Rest,
    /// The same, until a warm rig has cooled.
    Cooling,
    /// Contactor closed for a moment, no power.
    MosfetOff,
    /// Pulses of low power.
    Pulses,
    /// The same pulse again and again: which thermistor answers first?
    Order,
    /// No heat, until the last pulse has passed.
    Settle,
    /// Power with the contactor open.
    ContactorOpen,
    /// Nothing any more.
    Over,
}

impl Stage {
    /// What is done, for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rest => "thermistors at rest",
            Self::Cooling => "waiting for the rig to cool",
            Self::MosfetOff => "contactor closed without power",
            Self::Pulses => "pulses of low power",
            Self::Order => "which thermistor answers first",
            Self::Settle => "heat off",
            Self::ContactorOpen => "power with the contactor open",
            Self::Over => "over",
        }
    }
}

/// What the output is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Output {
    /// Disabled.
    Off,
    /// Enabled.
    On {
        /// Power of the MOSFET.
        power: Percent,
        /// Whether the contactor is closed.
        contactor: bool,
    },
}

/// What the interlock's proof gave, before anything else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proof {
    /// The contact is open and the output cannot be enabled.
    OpenHolds,
    /// The contact is open and the output can be enabled.
    OpenButEnabled,
    /// The contact is closed, and a break disables the output; `seen`: so does the contact itself.
    Cuts {
        /// The contact has been seen to cut since the start.
        seen: bool,
    },
    /// A break does not disable the output.
    DoesNotCut,
}
