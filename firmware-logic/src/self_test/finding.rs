//! What the self-test can find, as data and as a line for people: what is the case, and what to do about it.

use core::fmt;

use fdi_core::likelihood::Channel;
use fdi_core::{TripReason, Validity};

use crate::decimal::Fixed;

/// Something found. Most of them fail the check; see [`CheckFinding::is_note`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CheckFinding {
    /// The interlock's contact is open.
    InterlockOpen,
    /// The interlock's contact is open, but the output can be enabled.
    OpenButEnabled,
    /// A break did not disable the output.
    DoesNotCut,
    /// Nobody has seen the contact itself cut since the start.
    CutNotSeen,
    /// A thermistor gives no temperature that can be true.
    Broken(Channel, Validity),
    /// A thermistor's reading moves by so many degC although nothing is heated.
    Noisy(Channel, f32),
    /// A thermistor still changed by so many degC in a cycle when waiting ended.
    NotAtRest(Channel, f32),
    /// A thermistor reads so many degC more than the middle one: too many to be an offset.
    FarOff(Channel, f32),
    /// The same, but few enough.
    Offset(Channel, f32),
    /// It heats with the contactor closed and no power.
    MosfetShorted,
    /// It heats with power and the contactor open.
    NoContactor,
    /// No thermistor answers the heater.
    Unheated,
    /// A thermistor's code has not moved at all.
    Stuck(Channel),
    /// A thermistor does not answer the heater.
    Silent(Channel),
    /// Two thermistors are at each other's place.
    Swapped(Channel, Channel),
    /// All three are at a wrong place.
    Rotated,
    /// T1 and T2 answer at the same time.
    SameTime,
    /// Only T0 answers.
    OnlyT0,
    /// All three answer.
    AllAnswer,
    /// A thermistor rose by more than is allowed, and by how much.
    TooHot(Channel, f32),
    /// The supervisor would trip.
    Hazard(TripReason),
}

impl CheckFinding {
    /// Worth knowing, but no failure.
    pub fn is_note(&self) -> bool {
        matches!(self, Self::CutNotSeen | Self::Offset(..) | Self::NoContactor | Self::SameTime)
    }
}

impl fmt::Display for CheckFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_note() {
            f.write_str("note: ")?;
        }
        match *self {
            Self::Broken(channel, validity) => broken(f, channel, validity),
            Self::Noisy(c, by) => write!(
                f,
                "{} moves by {} degC without heat, expected at most 3: look for a loose contact, shield its wires",
                c.name(),
                Fixed(by, 1)
            ),
            Self::NotAtRest(c, by) => write!(
                f,
                "{} still changes by {} degC in 4 s after 2 minutes: let the rig cool with its fan on, `check` again",
                c.name(),
                Fixed(by, 1)
            ),
            Self::FarOff(c, by) => write!(
                f,
                "{} reads {} degC from the middle one, expected at most 3: is the rig still warm, or is its r25, beta \
                 or pull-up wrong?",
                c.name(),
                Fixed(by, 1)
            ),
            Self::Offset(c, by) => write!(
                f,
                "{} reads {} degC from the middle one, expected at most 0.3",
                c.name(),
                Fixed(by, 2)
            ),
            Self::Stuck(c) => write!(f, "{} stands still at one code: look at its wires and plug", c.name()),
            Self::Silent(c) => write!(
                f,
                "{} does not answer the heater, another one does: it is out of the tube (detached), or stands still",
                c.name()
            ),
            Self::Swapped(Channel::T1, Channel::T2) => f.write_str(
                "T1 and T2 are swapped, T2 answers first: exchange their plugs, or the air is blown backwards",
            ),
            Self::Swapped(a, b) => write!(
                f,
                "{} and {} are swapped, T0 answers the heater: exchange their plugs",
                a.name(),
                b.name()
            ),
            Self::TooHot(c, by) => write!(
                f,
                "{} rose by {} degC, expected at most 4.5: too strong a heater, or too little air",
                c.name(),
                Fixed(by, 1)
            ),
            Self::Hazard(reason) => write!(f, "it would trip: {}", reason.words()),
            _ => f.write_str(self.fixed_text()),
        }
    }
}

impl CheckFinding {
    /// Lines without a number or a name in them.
    fn fixed_text(&self) -> &'static str {
        match self {
            Self::InterlockOpen => "the interlock is open and holds the output off: close it, `check` again",
            Self::OpenButEnabled => {
                "the interlock is open, but does not keep the output from being enabled: do not heat, see docs/safety.md"
            }
            Self::DoesNotCut => {
                "a break does not disable the output: do not heat, the timer or its set-up is broken"
            }
            Self::CutNotSeen => {
                "the contact of the interlock has not been seen to cut: open it, `check`, close it, `check`"
            }
            Self::MosfetShorted => {
                "it heats with no power asked for: the MOSFET is shorted or stuck on, replace it"
            }
            Self::NoContactor => {
                "it heats with the contactor open: none is fitted, or it is welded; a shorted MOSFET could not be cut"
            }
            Self::Unheated => {
                "no thermistor answers 20 % of power: look at heater, fuse, contactor, supply, and whether T1 and T2 are \
                 in the tube"
            }
            Self::Rotated => {
                "T0, T1 and T2 are each at another's place: put each plug where docs/wiring.md has it"
            }
            Self::SameTime => "T1 and T2 answer at the same time: which one is first cannot be told",
            Self::OnlyT0 => {
                "only T0 answers the heater: the air is blown backwards, or T0 is swapped with T1 and T2 is out of the \
                 tube"
            }
            Self::AllAnswer => {
                "T0 answers the heater, too: it hangs in the warm air, put it where the room is"
            }
            _ => "",
        }
    }
}

fn broken(f: &mut fmt::Formatter<'_>, channel: Channel, validity: Validity) -> fmt::Result {
    let what = match validity {
        Validity::Open => "reads as an open wire: look for a broken wire or a plug that is out",
        Validity::Short => "reads as a short: look for wires that touch",
        Validity::OutOfRange => {
            "reads what the rig cannot have: is it the right thermistor, are r25 and beta right?"
        }
        Validity::Missing => "gives no code: the converter does not answer",
        _ => "jumps: look for a loose contact",
    };
    write!(f, "{} {what}", channel.name())
}

/// How a check ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Ending {
    /// Nothing but notes.
    Passed,
    /// So many findings that are no notes.
    Failed(u8),
    /// Somebody ordered a stop.
    Stopped,
    /// Hardware cut the output.
    Cut,
    /// The control tick was missing.
    MissedTick,
    /// The settings changed.
    Settings,
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Passed => f.write_str("check passed"),
            Self::Failed(1) => f.write_str("check failed: 1 finding"),
            Self::Failed(n) => write!(f, "check failed: {n} findings"),
            Self::Stopped => f.write_str("check ended early: stopped"),
            Self::Cut => f.write_str("check ended early: the output was cut, see `status`"),
            Self::MissedTick => f.write_str("check ended early: a control tick was missed"),
            Self::Settings => f.write_str("check ended early: the settings were changed"),
        }
    }
}
