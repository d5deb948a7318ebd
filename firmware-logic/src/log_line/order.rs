//! An order that was carried out, as text and back.

use core::fmt;

use fdi_core::{Celsius, Command, Percent, Seconds};

use super::{LogLineError, tick};
use crate::control_loop::OrderKind;
use crate::decimal::Short;

/// `VERB [ARGUMENT]`, with the argument in words for people behind its bits.
pub(super) fn write(f: &mut fmt::Formatter<'_>, order: &OrderKind) -> fmt::Result {
    f.write_str(match order {
        OrderKind::Settings => "settings",
        OrderKind::Check => "check",
        OrderKind::Command(Command::Arm) => "arm",
        OrderKind::Command(Command::Tune) => "tune",
        OrderKind::Command(Command::Stop) => "stop",
        OrderKind::Command(Command::Acknowledge) => "ack",
        OrderKind::Command(Command::Relearn) => "relearn",
        OrderKind::Command(Command::Excite(true)) => "excite true",
        OrderKind::Command(Command::Excite(false)) => "excite false",
        // Bits, since not every number has a short decimal form; the number for people behind it.
        OrderKind::Command(Command::SetPoint(Celsius(wanted))) => {
            return write!(f, "setpoint {:x} ({} degC)", wanted.to_bits(), Short(*wanted));
        }
        OrderKind::Command(Command::Gain(gain)) => {
            return write!(f, "gain {:x} ({} degC per %)", gain.to_bits(), Short(*gain));
        }
        OrderKind::Command(Command::Fan(Percent(level))) => {
            return write!(f, "fan {:x} ({} %)", level.to_bits(), Short(*level));
        }
        OrderKind::Command(Command::Shelve(Seconds(time))) => {
            return write!(f, "shelve {:x} ({} s)", time.to_bits(), Short(*time));
        }
    })
}

/// The same back.
pub(super) fn parse(text: &str) -> Result<OrderKind, LogLineError<'_>> {
    let mut words = text.split_ascii_whitespace();
    let verb = words.next().unwrap_or_default();
    let argument = words.next().unwrap_or_default();
    let expected = |expected| LogLineError::Argument { order: verb, expected };
    let given = || tick::word(argument).map(f32::from_bits).ok_or_else(|| expected("8 hexadecimal digits"));
    Ok(OrderKind::Command(match verb {
        "settings" => return Ok(OrderKind::Settings),
        "check" => return Ok(OrderKind::Check),
        "arm" => Command::Arm,
        "tune" => Command::Tune,
        "stop" => Command::Stop,
        "ack" => Command::Acknowledge,
        "relearn" => Command::Relearn,
        "setpoint" => Command::SetPoint(Celsius(given()?)),
        "gain" => Command::Gain(given()?),
        "fan" => Command::Fan(Percent(given()?)),
        "shelve" => Command::Shelve(Seconds(given()?)),
        "excite" => Command::Excite(argument.parse().map_err(|_| expected("true or false"))?),
        _ => return Err(LogLineError::Order(verb)),
    }))
}
