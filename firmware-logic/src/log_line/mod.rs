//! Lines of the log that a program reads: what a replay needs to run the core again. Printed here by the board and parsed
//! here on the host, so that the two cannot differ. All other lines of the log are sentences for people.
//!
//! ```text
//! log format 5
//! setting pid.kp = 2.4 %/degC
//! baseline raw.mean 3f800000 ..
//! commissioned 1 3e99999a ..
//! wider than the default: supervisor.signal_timeout = 2 s
//! order 11 setpoint 42180000 (38 degC)
//! order 12 fan 42a00000 (80 %)
//! denied 12 a check is under way, ..
//! lockout 77 the interlock on the break input opened
//! tick 0 ..
//! dropped 3
//! cycles 77 5210 61022
//! ```
//!
//! Behind what is parsed a line may go on in words, and a logger may put its own in front.

mod baseline;
mod commissioning;
mod image;
mod order;
pub mod tick;

use core::fmt;

use fdi_core::Config;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::likelihood::PARAMETERS;

pub use self::baseline::BaselineLine;
pub use self::image::Image;
use self::tick::{TickLine, TickLineError};
use crate::control_loop::OrderKind;
use crate::settings::commissioning::Commissioning;
use crate::settings::schema::Name;

/// Version of these lines. It changes with their text.
pub const VERSION: u32 = 5;

/// How the line of a limit that is wider than its default begins.
pub const WIDER: &str = "wider than the default: ";

/// One line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LogLine<'a> {
    /// The board has started, and writes lines of this version.
    Start {
        /// See [`VERSION`].
        version: u32,
    },
    /// Which image it is: at the start, and where somebody begins to listen.
    Image(Image<'a>),
    /// A setting that is not at its default: at the start, or just before an order puts it in force.
    Setting {
        /// Its name.
        name: &'a str,
        /// Its value, with its unit.
        value: &'a str,
    },
    /// A limit that is wider than its default, where the instrument is armed.
    Wider {
        /// Its name.
        name: &'a str,
        /// Its value, with its unit.
        value: &'a str,
    },
    /// A part of the baseline that was restored at the start.
    Baseline(BaselineLine),
    /// The commissioning from the next tick on, if there is one: at the start, or a new one.
    Commissioned(Option<Commissioning>),
    /// An order that was carried out before a tick.
    Order {
        /// The tick.
        tick: u32,
        /// The order.
        order: OrderKind,
    },
    /// An order that was not carried out. Why, stands behind.
    Denied {
        /// The tick before which it was due.
        tick: u32,
    },
    /// The heater was stopped before a tick, and is locked out. Why, stands behind.
    Lockout {
        /// The tick.
        tick: u32,
    },
    /// All that a tick gave.
    Tick(TickLine),
    /// What the halves of a tick took, in cycles of the core.
    Cycles {
        /// The tick.
        tick: u32,
        /// The first half.
        control: u32,
        /// The second.
        diagnosis: u32,
    },
    /// So many lines are missing here: the port had no room for them.
    Dropped {
        /// How many.
        count: u32,
    },
}

impl fmt::Display for LogLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start { version } => write!(f, "log format {version}"),
            Self::Image(image) => image.fmt(f),
            Self::Setting { name, value } => write!(f, "setting {name} = {value}"),
            Self::Wider { name, value } => write!(f, "{WIDER}{name} = {value}"),
            Self::Baseline(part) => part.fmt(f),
            Self::Commissioned(commissioning) => commissioning::write(f, commissioning.as_ref()),
            Self::Order { tick, order } => {
                write!(f, "order {tick} ")?;
                order::write(f, order)
            }
            Self::Denied { tick } => write!(f, "denied {tick}"),
            Self::Lockout { tick } => write!(f, "lockout {tick}"),
            Self::Tick(tick) => tick.fmt(f),
            Self::Cycles { tick, control, diagnosis } => write!(f, "cycles {tick} {control} {diagnosis}"),
            Self::Dropped { count } => write!(f, "dropped {count}"),
        }
    }
}

/// Why a line that begins as one of these is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogLineError<'a> {
    /// The record of a tick.
    Tick(TickLineError),
    /// An order that is not known.
    Order(&'a str),
    /// What follows an order.
    Argument {
        /// The order.
        order: &'a str,
        /// What was expected.
        expected: &'static str,
    },
    /// A part of a baseline that is not known.
    Part(&'a str),
    /// A commissioning with another number of words.
    Parameters {
        /// Hexadecimal words in it.
        found: usize,
    },
    /// A row of a baseline with another number of words.
    Words {
        /// The row.
        part: &'a str,
        /// Hexadecimal words in it.
        found: usize,
    },
}

impl fmt::Display for LogLineError<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tick(error) => error.fmt(f),
            Self::Order(word) => write!(
                f,
                "unknown order \"{word}\", expected settings, check, arm, tune, stop, ack, relearn, shelve, setpoint, fan or excite"
            ),
            Self::Argument { order, expected } => write!(f, "order {order}: expected {expected} behind it"),
            Self::Part(word) => write!(f, "unknown part of a baseline: \"{word}\""),
            Self::Parameters { found } => write!(f, "commissioned: {found} words, expected {PARAMETERS}"),
            Self::Words { part, found } => {
                write!(f, "baseline {part}: {found} words, expected {}", baseline::WORDS)
            }
        }
    }
}

impl<'a> LogLine<'a> {
    /// Finds such a line in what a logger printed: its own words, such as time and level, may stand in front, and "(file.rs:12)"
    /// behind. `None` where there is none.
    ///
    /// # Errors
    /// It begins like one of these lines, but is broken.
    pub fn find(text: &'a str) -> Result<Option<Self>, LogLineError<'a>> {
        if let Some(tick) =
            after(text, "tick ").map(tick::find).transpose().map_err(LogLineError::Tick)?.flatten()
        {
            return Ok(Some(Self::Tick(tick)));
        }
        if let Some((tick, rest)) = after(text, "order ").and_then(number) {
            return Ok(Some(Self::Order { tick, order: order::parse(rest)? }));
        }
        if let Some(part) = after(text, "baseline ").map(baseline::parse).transpose()?.flatten() {
            return Ok(Some(Self::Baseline(part)));
        }
        if let Some(kept) = after(text, "commissioned ").map(commissioning::parse).transpose()?.flatten() {
            return Ok(Some(Self::Commissioned(kept)));
        }
        if let Some(image) = after(text, "image ").and_then(image::parse) {
            return Ok(Some(Self::Image(image)));
        }
        if let Some((name, value)) = after(text, "setting ").and_then(|rest| rest.split_once(" = ")) {
            return Ok(Some(Self::Setting { name: name.trim(), value: without_place(value).trim() }));
        }
        if let Some((name, value)) = after(text, WIDER).and_then(|rest| rest.split_once(" = ")) {
            return Ok(Some(Self::Wider { name: name.trim(), value: without_place(value).trim() }));
        }
        if let Some(cycles) = after(text, "cycles ").and_then(cycles) {
            return Ok(Some(cycles));
        }
        let numbered = |keyword| Some(number(after(text, keyword)?)?.0);
        Ok(numbered("denied ")
            .map(|tick| Self::Denied { tick })
            .or_else(|| numbered("lockout ").map(|tick| Self::Lockout { tick }))
            .or_else(|| numbered("log format ").map(|version| Self::Start { version }))
            .or_else(|| numbered("dropped ").map(|count| Self::Dropped { count })))
    }
}

/// What follows a keyword that begins a line or stands behind a logger's own words.
fn after<'a>(text: &'a str, keyword: &str) -> Option<&'a str> {
    let (before, rest) = text.split_once(keyword)?;
    (before.is_empty() || before.ends_with([' ', ']', '\t'])).then_some(rest)
}

/// Cuts off the place in the sources that a logger puts behind a line.
fn without_place(text: &str) -> &str {
    match text.rsplit_once(" (") {
        Some((text, place)) if place.contains(".rs:") => text,
        _ => text,
    }
}

/// A number and what stands behind it.
fn number(text: &str) -> Option<(u32, &str)> {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    Some((word.parse().ok()?, rest))
}

/// Three numbers.
fn cycles(text: &str) -> Option<LogLine<'static>> {
    let (tick, text) = number(text)?;
    let (control, text) = number(text)?;
    let (diagnosis, _) = number(text)?;
    Some(LogLine::Cycles { tick, control, diagnosis })
}

/// A line of text on its way to the log; what does not fit is cut.
type Text = heapless::String<96>;

fn text(from: &impl fmt::Display) -> Text {
    let mut text = Text::new();
    let _ = fmt::write(&mut text, format_args!("{from}"));
    text
}

/// The lines of each setting that is not at its default.
pub fn settings(config: &Config, mut write: impl FnMut(LogLine<'_>)) {
    let usual = Config::default();
    for setting in Name::all(config) {
        if !setting.same(config, &usual) {
            let (name, value) = (text(&setting), text(&setting.value(config)));
            write(LogLine::Setting { name: &name, value: &value });
        }
    }
}

/// The lines of a baseline, with its bits.
pub fn baseline(baseline: &Baseline, write: impl FnMut(LogLine<'_>)) {
    BaselineLine::all(baseline).map(LogLine::Baseline).into_iter().for_each(write);
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use fdi_core::likelihood::Commissioned;
    use fdi_core::schema::WORDS;
    use fdi_core::{Celsius, Command, Percent, Seconds};

    use super::*;

    fn bits() -> impl Strategy<Value = f32> {
        // A NaN is no set-point, and two of them are never equal.
        any::<u32>().prop_map(f32::from_bits).prop_filter("a number", |x| !x.is_nan())
    }

    fn orders() -> impl Strategy<Value = OrderKind> {
        let commands = [Command::Arm, Command::Tune, Command::Stop, Command::Acknowledge, Command::Relearn];
        prop_oneof![
            Just(OrderKind::Settings),
            Just(OrderKind::Check),
            proptest::sample::select(commands.to_vec()).prop_map(OrderKind::Command),
            any::<bool>().prop_map(|on| OrderKind::Command(Command::Excite(on))),
            bits().prop_map(|x| OrderKind::Command(Command::Shelve(Seconds(x)))),
            bits().prop_map(|x| OrderKind::Command(Command::SetPoint(Celsius(x)))),
            bits().prop_map(|x| OrderKind::Command(Command::Fan(Percent(x)))),
            bits().prop_map(|x| OrderKind::Command(Command::Gain(x))),
        ]
    }

    fn baselines() -> impl Strategy<Value = Baseline> {
        let row = || proptest::array::uniform7(bits());
        (any::<u32>(), row(), row(), row(), row()).prop_map(|(samples, a, b, c, d)| {
            let mut baseline = Baseline { samples, ..Baseline::default() };
            (baseline.raw.mean, baseline.raw.sigma) = (a, b);
            (baseline.filtered.mean, baseline.filtered.sigma) = (c, d);
            baseline
        })
    }

    /// As printed, and as a logger shows it.
    fn comes_back(line: LogLine<'_>) -> Result<(), TestCaseError> {
        let printed = line.to_string();
        prop_assert_eq!(LogLine::find(&printed), Ok(Some(line)), "{}", printed);
        let logged = format!("12.345678 [INFO ] {printed} (firmware_logic log.rs:77)");
        prop_assert_eq!(LogLine::find(&logged), Ok(Some(line)), "{}", logged);
        Ok(())
    }

    proptest! {
        #[test]
        fn what_is_printed_parses_to_the_same(
            tick: u32,
            version: u32,
            order in orders(),
            name in "[a-z0-9_.]{1,40}",
            value in "[-0-9.e]{1,12}( [a-zA-Z%/]{1,10})?",
            words: [u32; WORDS],
            learnt in baselines(),
            parameters in proptest::array::uniform16(bits()),
        ) {
            comes_back(LogLine::Start { version })?;
            comes_back(LogLine::Image(Image { release: &value, commit: &name, board: &name, format: version }))?;
            comes_back(LogLine::Order { tick, order })?;
            comes_back(LogLine::Denied { tick })?;
            comes_back(LogLine::Lockout { tick })?;
            comes_back(LogLine::Dropped { count: tick })?;
            comes_back(LogLine::Cycles { tick, control: version, diagnosis: tick })?;
            comes_back(LogLine::Setting { name: &name, value: &value })?;
            comes_back(LogLine::Tick(TickLine(words)))?;
            comes_back(LogLine::Commissioned(None))?;
            let models = Commissioned { parameters };
            comes_back(LogLine::Commissioned(Some(Commissioning { number: tick, models })))?;
            let mut again = Baseline::default();
            for part in BaselineLine::all(&learnt) {
                comes_back(LogLine::Baseline(part))?;
                part.restore(&mut again);
            }
            prop_assert_eq!(again, learnt);
        }

        #[test]
        fn no_text_panics(text in "\\PC{0,120}", rest in "[ -~]{0,80}") {
            let _ = LogLine::find(&text);
            for keyword in ["tick", "order", "baseline", "commissioned", "setting", "denied", "lockout", "log format", "dropped", "cycles"] {
                let _ = LogLine::find(&format!("{keyword} {rest}"));
            }
        }
    }

    #[test]
    fn what_stands_behind_does_not_matter_but_a_broken_line_does() {
        let denied = LogLine::find("1.0 warn  denied 12 the interlock is open");
        assert_eq!(denied, Ok(Some(LogLine::Denied { tick: 12 })));
        let lockout = LogLine::find("lockout 77 the control tick was missing for more than 3 periods");
        assert_eq!(lockout, Ok(Some(LogLine::Lockout { tick: 77 })));
        for sentence in
            ["2 ticks missed before tick 5", "settings read from flash", "the order of T1 and T2", ""]
        {
            assert_eq!(LogLine::find(sentence), Ok(None), "{sentence}");
        }
        let error = |text| LogLine::find(text).expect_err(text).to_string();
        assert!(error("order 5 explode").contains("unknown order \"explode\""));
        assert!(error("order 5 setpoint warm").contains("order setpoint: expected 8 hexadecimal digits"));
        assert!(error("commissioned 1 3e99999a").contains("commissioned: 1 words, expected 16"));
        assert!(error("baseline raw.mean 1 2").contains("baseline raw.mean: 2 words, expected 7"));
        assert!(error(&format!("tick {}", ["1f"; WORDS - 1].join(" "))).contains("31 words, expected 32"));
    }

    #[test]
    fn each_setting_that_is_not_at_its_default_has_a_line() {
        let mut config = Config::default();
        config.pid.kp = 3.5;
        let mut lines = Vec::new();
        settings(&config, |line| lines.push(line.to_string()));
        assert_eq!(lines, ["setting pid.kp = 3.5 %/degC"]);
        lines.clear();
        settings(&Config::default(), |line| lines.push(line.to_string()));
        assert!(lines.is_empty());
    }
}
