//! Errors of configuration. Steps never fail: whatever could make one fail is refused here, by name.

use core::fmt;

/// Why a configuration was refused. Every variant names the parameter as it is written in the TOML file.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ConfigError {
    /// The value is NaN or infinite.
    NonFinite {
        /// Parameter.
        name: &'static str,
    },
    /// The value lies outside its bounds (both allowed).
    OutOfRange {
        /// Parameter.
        name: &'static str,
        /// The value given.
        value: f32,
        /// Smallest value allowed.
        min: f32,
        /// Largest value allowed.
        max: f32,
    },
    /// The value must be greater than that of another parameter.
    NotAbove {
        /// Parameter.
        name: &'static str,
        /// The value given.
        value: f32,
        /// The parameter that it must exceed.
        other: &'static str,
        /// The value of the other parameter.
        limit: f32,
    },
    /// The value is larger than the scale of the plant allows.
    BeyondScale {
        /// Parameter.
        name: &'static str,
        /// The value given.
        value: f32,
        /// Largest value allowed.
        max: f32,
        /// It follows from so many times the scale.
        times: f32,
        /// What the scale is.
        of: &'static str,
        /// How large the scale is.
        scale: f32,
    },
    /// Two rows of a signature table match the same symptoms.
    AmbiguousRows {
        /// Table.
        name: &'static str,
        /// Index of the first row.
        first: usize,
        /// Index of the second row.
        second: usize,
    },
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NonFinite { name } => write!(f, "{name} must be a finite number"),
            Self::OutOfRange { name, value, min, max } => {
                write!(f, "{name} is {value}, expected {min} to {max}")
            }
            Self::NotAbove { name, value, other, limit } => {
                write!(f, "{name} is {value}, expected more than {other} ({limit})")
            }
            Self::BeyondScale { name, value, max, times, of, scale } => {
                write!(f, "{name} is {value}, expected at most {max}: {times} times {of} ({scale})")
            }
            Self::AmbiguousRows { name, first, second } => write!(
                f,
                "{name}: rows {first} and {second} match the same symptoms, expected at most one row to match"
            ),
        }
    }
}

impl core::error::Error for ConfigError {}

/// Checks that `value` is finite and within `min..=max`.
#[inline(never)]
pub(crate) fn in_range(name: &'static str, value: f32, min: f32, max: f32) -> Result<(), ConfigError> {
    if !value.is_finite() {
        Err(ConfigError::NonFinite { name })
    } else if value < min || value > max {
        Err(ConfigError::OutOfRange { name, value, min, max })
    } else {
        Ok(())
    }
}

/// Checks that `value` exceeds `limit`, the value of the parameter `other`.
#[inline(never)]
pub(crate) fn above(
    name: &'static str,
    value: f32,
    other: &'static str,
    limit: f32,
) -> Result<(), ConfigError> {
    if value > limit { Ok(()) } else { Err(ConfigError::NotAbove { name, value, other, limit }) }
}

/// Checks that `value` is at most `base` and `times` the `scale`, which is that of `of`.
#[inline(never)]
pub(crate) fn within_scale(
    name: &'static str,
    value: f32,
    base: f32,
    times: f32,
    of: &'static str,
    scale: f32,
) -> Result<(), ConfigError> {
    let max = base + times * scale;
    if value <= max { Ok(()) } else { Err(ConfigError::BeyondScale { name, value, max, times, of, scale }) }
}
