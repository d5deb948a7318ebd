//! The two signature tables as settings: a row is `NUMBER PATTERN`, such as `1 0 -1 0 +1 0`, with a name behind it if
//! it is a fault of the user's own, `4 0 +1 0 -1 0 hand`; or `none`.

use fdi_core::Config;
use fdi_core::diagnosis::signature::{Pattern, Rows, Signature, WIDTH};
use fdi_core::name::Name;
use heapless::Vec;

use super::error::{Expected, SetError};
use crate::decimal;

/// A table of signatures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// fdv.
    Detection,
    /// fiv.
    Isolation,
}

impl Table {
    /// Both, with the beginning of the names of their rows.
    pub(super) const ALL: [(Self, &'static str); 2] =
        [(Self::Detection, "diagnosis.detection."), (Self::Isolation, "diagnosis.isolation.")];

    /// Its rows.
    pub fn rows(self, config: &Config) -> &Rows {
        match self {
            Self::Detection => &config.diagnosis.detection,
            Self::Isolation => &config.diagnosis.isolation,
        }
    }

    /// Its rows, to be changed.
    pub fn rows_mut(self, config: &mut Config) -> &mut Rows {
        match self {
            Self::Detection => &mut config.diagnosis.detection,
            Self::Isolation => &mut config.diagnosis.isolation,
        }
    }
}

/// Writes, adds or (with `none`) takes away a row.
pub(super) fn set_row<'a>(
    rows: &mut Rows,
    row: usize,
    name: &'a str,
    text: &'a str,
) -> Result<(), SetError<'a>> {
    if text == "none" && row < rows.len() {
        rows.remove(row);
        return Ok(());
    }
    let expected = Expected::Words("NUMBER, five of -1 0 +1 x, and perhaps a name; or none");
    let wrong = SetError::Value { name, given: text, expected };
    let (number, rest) = text.split_once(' ').ok_or(wrong)?;
    let number: u8 = decimal::whole(number).ok_or(wrong)?;
    let (pattern, called) = named(rest).unwrap_or((rest, Name::NONE));
    let pattern: Pattern = pattern.parse().map_err(|error| SetError::Pattern { name, error })?;
    put(rows, row, name, Signature { number, pattern, name: called })
}

/// Writes what stands at a place, or adds behind the last.
pub(super) fn put<'a, T, const N: usize>(
    list: &mut Vec<T, N>,
    place: usize,
    name: &'a str,
    item: T,
) -> Result<(), SetError<'a>> {
    let count = list.len();
    match list.get_mut(place) {
        Some(known) => *known = item,
        None if place == count => {
            // There is room: a place beyond the last possible one has no name.
            let _ = list.push(item);
        }
        None => return Err(SetError::Gap { name, rows: count }),
    }
    Ok(())
}

/// The pattern and the name behind it; `None` where the last of more words than a pattern has is no name.
fn named(text: &str) -> Option<(&str, Name)> {
    let (pattern, name) = text.rsplit_once(' ')?;
    if pattern.split_ascii_whitespace().count() < WIDTH {
        return None;
    }
    Some((pattern, name.parse().ok()?))
}
