//! What the control half can be asked for, and what became of it.

use core::fmt;

use fdi_core::control::Controller;
use fdi_core::{Command, Refusal};
use heapless::spsc::Consumer;

use crate::explain::Explained;
use crate::interlock::Lockout;

/// An order to the control half.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "copied once a second at most, into a queue of two")]
pub enum Order {
    /// A command of the user. `Acknowledge` releases the interlock, too.
    Command(Command),
    /// New settings.
    Retune(Controller),
    /// Begin the self-test.
    Check,
}

/// An order without what it brings along.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum OrderKind {
    /// [`Order::Command`].
    Command(Command),
    /// [`Order::Retune`].
    Settings,
    /// [`Order::Check`].
    Check,
}

impl Order {
    /// Whether it switches the heater on.
    pub fn heats(&self) -> bool {
        match self {
            Self::Check => true,
            Self::Command(command) => command.heats(),
            Self::Retune(_) => false,
        }
    }

    /// What it is, without what it brings along.
    pub fn kind(&self) -> OrderKind {
        match self {
            Self::Command(command) => OrderKind::Command(*command),
            Self::Retune(_) => OrderKind::Settings,
            Self::Check => OrderKind::Check,
        }
    }
}

/// The order for a tick, from those that wait. A stop comes first, and what heats and was ordered before it must not come
/// after it.
pub fn next_order(stop: bool, waiting: &mut Consumer<'_, Order>) -> Option<Order> {
    if !stop {
        return waiting.dequeue();
    }
    while waiting.peek().is_some_and(Order::heats) {
        waiting.dequeue();
    }
    Some(Order::Command(Command::Stop))
}

/// Why an order was not carried out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Denial {
    /// The supervisor refused.
    Refused(Refusal),
    /// Something holds the heater off until it is acknowledged.
    LockedOut(Lockout),
    /// The interlock on the break input is open.
    BreakOpen,
    /// No self-test has passed since the start.
    Unchecked,
    /// The self-test is under way.
    Checking,
    /// The flash did not take the mark that tells of a power failure.
    NoMark,
    /// The control half has not said what became of the order.
    NoAnswer,
}

impl fmt::Display for Denial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(refusal) => Explained(refusal).fmt(f),
            Self::LockedOut(lockout) => write!(f, "locked out: {lockout}; expected `ack` first"),
            Self::BreakOpen => {
                f.write_str("the interlock on the break input is open, expected it closed to ground")
            }
            Self::Unchecked => f.write_str(
                "no `check` has passed since the start, expected one; `set supervisor.check_before_arming false` waives it",
            ),
            Self::Checking => f.write_str("a check is under way, expected its end; `stop` ends it"),
            Self::NoMark => f.write_str(
                "the flash did not take the mark of a power failure, expected `save` first to mend it",
            ),
            Self::NoAnswer => {
                f.write_str("not carried out, or not told so on the next tick as expected; see `status`")
            }
        }
    }
}

/// What became of an order on a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Outcome {
    /// The order.
    pub order: OrderKind,
    /// Whether it was carried out.
    pub result: Result<(), Denial>,
}
