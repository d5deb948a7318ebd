//! Why a setting was not taken over.

use core::fmt::{self, Write};

use fdi_core::diagnosis::signature::PatternError;
use fdi_core::settings::Form;

/// Why a setting was not taken over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetError<'a> {
    /// No setting of this name.
    Unknown(&'a str),
    /// The text is no value of this kind.
    Value {
        /// The setting.
        name: &'a str,
        /// What was given.
        given: &'a str,
        /// What would have been accepted.
        expected: Expected,
    },
    /// The text is no pattern.
    Pattern {
        /// The setting.
        name: &'a str,
        /// Why.
        error: PatternError,
    },
    /// A row or a response can be added only behind the last.
    Gap {
        /// The setting.
        name: &'a str,
        /// How many there are.
        rows: usize,
    },
}

/// What would have been accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expected {
    /// In words.
    Words(&'static str),
    /// A whole number within these bounds.
    Whole {
        /// Smallest, allowed.
        min: u16,
        /// Largest, allowed.
        max: u16,
    },
    /// One of these, with its numbers.
    Forms(&'static [Form]),
}

impl fmt::Display for SetError<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(name) => write!(f, "no setting \"{name}\", see `get`"),
            Self::Value { name, given, expected } => {
                write!(f, "{name}: \"{given}\" given, expected {expected}")
            }
            Self::Pattern { name, error } => write!(f, "{name}: {error}, or `none`"),
            Self::Gap { name, rows } => {
                write!(f, "{name}: there are {rows}, expected one from 1 to {}", rows + 1)
            }
        }
    }
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Words(words) => f.write_str(words),
            Self::Whole { min, max } => {
                write!(f, "a whole number from {} to {}", u32::from(*min), u32::from(*max))
            }
            Self::Forms(forms) => forms.iter().enumerate().try_for_each(|(i, form)| {
                f.write_str(if i > 0 { " or " } else { "" })?;
                f.write_str(form.word)?;
                form.numbers.iter().try_for_each(|number| {
                    f.write_str(" ")?;
                    number.key.chars().try_for_each(|c| f.write_char(c.to_ascii_uppercase()))
                })
            }),
        }
    }
}
