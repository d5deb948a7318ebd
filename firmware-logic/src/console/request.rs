//! From a line to what is wanted.

use core::fmt;

use super::teach;
use super::tune::{self, Wanted};

/// What is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request<'a> {
    /// An empty line.
    Nothing,
    /// The list of commands.
    Help,
    /// How the instrument is.
    Status,
    /// One setting, all that begin with a name, or all.
    Get {
        /// The beginning of the name.
        name: &'a str,
    },
    /// A new value for a setting.
    Set {
        /// The whole name.
        name: &'a str,
        /// The rest of the line.
        value: &'a str,
    },
    /// Write settings and baseline to flash.
    Save,
    /// Set the brown-out level.
    BrownOut,
    /// All settings as they were made.
    Defaults,
    /// The self-test.
    Check,
    /// Begin to regulate.
    Arm,
    /// Heater off.
    Stop,
    /// Leave a trip or a lockout, or know of an alarm.
    Acknowledge,
    /// Make what is named now advice for a while.
    Shelve {
        /// In minutes.
        minutes: &'a str,
    },
    /// Take what is told now for normal.
    Accept,
    /// Announce the level of the fan.
    Fan {
        /// In %.
        level: &'a str,
    },
    /// Show what was learnt as normal.
    Baseline,
    /// Learn it anew.
    Relearn,
    /// Take the rig as it is now for the one that is commissioned.
    Commission,
    /// Forget how it was commissioned.
    Decommission,
    /// What went wrong since the start.
    Faults,
    /// The log over the port, beside the answers.
    Stream {
        /// Begin, or end.
        on: bool,
    },
    /// Calibrate a thermistor, or put what came of it in force.
    Calibrate {
        /// `t0` .. `t2`, `all`, `apply`, `undo`, `back` or `clear`.
        what: &'a str,
        /// The true temperature, where there is one.
        celsius: &'a str,
    },
    /// A fault that somebody makes.
    Teach(teach::Wanted),
    /// The experiment for the PID, or what came of it.
    Tune(Wanted),
    /// Start anew, with the log over the port from the first tick on.
    Restart,
    /// The same, with codes from the port and the outputs locked off.
    Simulate,
}

/// All commands: name, what follows it, what it does.
pub const COMMANDS: [(&str, &str, &str); 23] = [
    ("help", "", "this list"),
    ("status", "", "mode, temperatures, diagnosis, health"),
    ("get", "[NAME]", "settings, all or those that begin with NAME"),
    ("set", "NAME VALUE", "change a setting at once, until the next start unless saved"),
    ("save", "", "write settings and baseline to flash (heater off only)"),
    ("defaults", "", "all settings as they were made; `save` keeps them"),
    ("check", "", "self-test of a minute on a fast rig, which heats a little; `arm` wants it passed"),
    ("arm", "", "begin to regulate"),
    ("stop", "", "heater off, in every state; so do the keys Ctrl-C, ESC and !"),
    ("ack", "", "acknowledge a trip, a lockout or an alarm (which is advice then, until it ends)"),
    ("shelve", "MINUTES", "what is named now is advice for so long, however often it comes; 0 ends that"),
    ("accept", "", "what is named now is normal from now on: learn anew, the commissioning stays"),
    ("fan", "LEVEL", "announce the fan's level in %, 100 being the level at which it is learnt"),
    ("baseline", "[learn]", "what was learnt as normal; `learn` learns it anew"),
    (
        "commission",
        "[clear]",
        "store this rig as the reference for later comparison; `clear`: take the next one learnt",
    ),
    ("brownout", "set", "reset below 2.7 V, from the next power-up (heater off only)"),
    ("faults", "", "what went wrong since the start"),
    (
        "calibrate",
        "t0|t1|t2|all DEGC",
        "the thermistor is at DEGC now; then `calibrate apply`, `undo`, `back` (forget the last) or `clear` (heater off only)",
    ),
    (
        "teach",
        "NAME|end|show|save|drop",
        "NAME and `end`: around each repetition of a fault that you cause; `show` its signature, `save` or `drop` it",
    ),
    (
        "tune",
        "[start]",
        "PID settings from an experiment that heats; then `tune`, `tune apply relay|model|quick`, `tune undo`",
    ),
    ("stream", "on|off", "the log over this port: each tick a line with a checksum, beside the answers"),
    ("restart", "", "start anew, with the stream on from the first tick (heater off, nothing latched)"),
    ("simulate", "on", "the same with codes from this port, both outputs locked off; a reset ends it"),
];

/// Why a line is no request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequestError<'a> {
    /// No command of this name.
    Unknown(&'a str),
    /// More words than the command takes.
    Extra {
        /// The command.
        command: &'a str,
        /// The first word too many.
        word: &'a str,
    },
    /// A word is missing.
    Missing {
        /// The command.
        command: &'a str,
        /// What should follow.
        expected: &'static str,
    },
}

impl fmt::Display for RequestError<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(word) => {
                write!(f, "unknown command \"{word}\", expected one of")?;
                COMMANDS.iter().try_for_each(|(name, ..)| write!(f, " {name}"))
            }
            Self::Extra { command, word } => write!(f, "{command}: unexpected argument \"{word}\""),
            Self::Missing { command, expected } => write!(f, "{command}: expected {expected}"),
        }
    }
}

impl<'a> Request<'a> {
    /// Reads a line.
    ///
    /// # Errors
    /// The word that is wrong, and what was expected.
    pub fn parse(line: &'a str) -> Result<Self, RequestError<'a>> {
        let (command, rest) = split_word(line);
        let alone = |request| match rest {
            "" => Ok(request),
            _ => Err(RequestError::Extra { command, word: split_word(rest).0 }),
        };
        match command {
            "" => Ok(Self::Nothing),
            "help" | "?" => alone(Self::Help),
            "status" => alone(Self::Status),
            "save" => alone(Self::Save),
            "defaults" => alone(Self::Defaults),
            "check" => alone(Self::Check),
            "arm" => alone(Self::Arm),
            // Nobody in a hurry should be refused for what stands behind it.
            "stop" => Ok(Self::Stop),
            "ack" => alone(Self::Acknowledge),
            "accept" => alone(Self::Accept),
            "faults" => alone(Self::Faults),
            "get" => match split_word(rest) {
                (name, "") => Ok(Self::Get { name }),
                (_, more) => Err(RequestError::Extra { command, word: split_word(more).0 }),
            },
            "set" => match split_word(rest) {
                ("", _) | (_, "") => Err(RequestError::Missing { command, expected: "NAME VALUE" }),
                (name, value) => Ok(Self::Set { name, value }),
            },
            "fan" | "shelve" => match split_word(rest) {
                ("", _) if command == "fan" => Err(RequestError::Missing { command, expected: "LEVEL" }),
                ("", _) => Err(RequestError::Missing { command, expected: "MINUTES" }),
                (level, "") if command == "fan" => Ok(Self::Fan { level }),
                (minutes, "") => Ok(Self::Shelve { minutes }),
                (_, more) => Err(RequestError::Extra { command, word: split_word(more).0 }),
            },
            "baseline" => match split_word(rest) {
                ("", _) => Ok(Self::Baseline),
                ("learn", "") => Ok(Self::Relearn),
                ("learn", more) => Err(RequestError::Extra { command, word: split_word(more).0 }),
                (word, _) => Err(RequestError::Extra { command, word }),
            },
            "commission" => match split_word(rest) {
                ("", _) => Ok(Self::Commission),
                ("clear", "") => Ok(Self::Decommission),
                ("clear", word) | (word, _) => Err(RequestError::Extra { command, word: split_word(word).0 }),
            },
            "brownout" => match split_word(rest) {
                ("set", "") => Ok(Self::BrownOut),
                ("", _) => Err(RequestError::Missing { command, expected: "set" }),
                ("set", word) | (word, _) => Err(RequestError::Extra { command, word }),
            },
            "stream" => match split_word(rest) {
                ("on", "") => Ok(Self::Stream { on: true }),
                ("off", "") => Ok(Self::Stream { on: false }),
                ("on" | "off", word) => Err(RequestError::Extra { command, word: split_word(word).0 }),
                _ => Err(RequestError::Missing { command, expected: "on or off" }),
            },
            "calibrate" => match split_word(rest) {
                ("apply" | "undo" | "back" | "clear", "") => Ok(Self::Calibrate { what: rest, celsius: "" }),
                ("t0" | "t1" | "t2" | "all", celsius) if !celsius.is_empty() => {
                    Ok(Self::Calibrate { what: split_word(rest).0, celsius })
                }
                _ => Err(RequestError::Missing {
                    command,
                    expected: "t0, t1, t2 or all and a temperature in degC, or apply, undo, back, clear",
                }),
            },
            "teach" => match teach::Wanted::parse(rest) {
                Some(wanted) => Ok(Self::Teach(wanted)),
                None => Err(RequestError::Missing { command, expected: teach::EXPECTED }),
            },
            "tune" => match Wanted::parse(rest) {
                Some(wanted) => Ok(Self::Tune(wanted)),
                None => Err(RequestError::Missing { command, expected: tune::EXPECTED }),
            },
            "restart" => alone(Self::Restart),
            "simulate" => match split_word(rest) {
                ("on", "") => Ok(Self::Simulate),
                ("", _) => Err(RequestError::Missing { command, expected: "on" }),
                ("on", word) | (word, _) => Err(RequestError::Extra { command, word }),
            },
            unknown => Err(RequestError::Unknown(unknown)),
        }
    }
}

/// The first word, and the rest without blanks around it.
fn split_word(text: &str) -> (&str, &str) {
    let text = text.trim_matches(' ');
    match text.split_once(' ') {
        Some((word, rest)) => (word, rest.trim_matches(' ')),
        None => (text, ""),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn every_command_of_the_list_is_understood() {
        for (name, arguments, _) in COMMANDS {
            let line = match arguments {
                "NAME VALUE" => format!("{name} pid.kp 2.4"),
                "set" => format!("{name} set"),
                "on|off" | "on" => format!("{name} on"),
                "LEVEL" | "MINUTES" => format!("{name} 80"),
                "NAME|end|show|save|drop" => format!("{name} hand"),
                "t0|t1|t2|all DEGC" => format!("{name} t1 25.0"),
                _ => name.to_owned(),
            };
            assert!(Request::parse(&line).is_ok(), "{line}");
        }
    }

    #[test]
    fn words_blanks_and_the_rest_of_the_line() {
        assert_eq!(
            Request::parse("  set   pid.kp   2.4  "),
            Ok(Request::Set { name: "pid.kp", value: "2.4" })
        );
        assert_eq!(
            Request::parse("set diagnosis.isolation.1 1 0 -1 0 +1 0"),
            Ok(Request::Set { name: "diagnosis.isolation.1", value: "1 0 -1 0 +1 0" })
        );
        assert_eq!(Request::parse("get"), Ok(Request::Get { name: "" }));
        assert_eq!(Request::parse("baseline learn"), Ok(Request::Relearn));
        assert_eq!(Request::parse("   "), Ok(Request::Nothing));
    }

    #[test]
    fn errors_name_what_was_wrong() {
        let text = |line: &str| Request::parse(line).expect_err(line).to_string();
        assert!(text("sopt").starts_with("unknown command \"sopt\", expected one of help status get set"));
        assert_eq!(text("arm now"), "arm: unexpected argument \"now\"");
        assert_eq!(text("set pid.kp"), "set: expected NAME VALUE");
        assert_eq!(text("baseline forget"), "baseline: unexpected argument \"forget\"");
        assert_eq!(text("brownout"), "brownout: expected set");
        assert_eq!(text("stream of"), "stream: expected on or off");
        assert_eq!(text("tune apply pid"), format!("tune: expected {}", tune::EXPECTED));
        assert!(text("ARM").starts_with("unknown command \"ARM\""), "no guessing what heats");
    }

    #[test]
    fn stop_is_never_refused() {
        assert_eq!(Request::parse("stop it now"), Ok(Request::Stop));
    }

    proptest! {
        #[test]
        fn no_line_panics_and_only_the_exact_word_heats(line in "[ -~]{0,120}") {
            match Request::parse(&line) {
                Ok(Request::Arm) => prop_assert_eq!(line.trim(), "arm"),
                Ok(Request::Check) => prop_assert_eq!(line.trim(), "check"),
                Ok(Request::Tune(Wanted::Start)) => {
                    prop_assert_eq!(line.split_ascii_whitespace().collect::<Vec<_>>(), ["tune", "start"]);
                }
                _ => {}
            }
        }

        #[test]
        fn one_wrong_letter_is_another_command(at in 0usize..3, letter in "[b-z]") {
            let mut line = "arm".to_owned();
            line.replace_range(at..=at, &letter);
            prop_assume!(line != "arm");
            prop_assert!(Request::parse(&line).is_err());
        }
    }
}
