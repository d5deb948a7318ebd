//! New rows in both tables of the settings. The same row detects and isolates: fdv and fiv give its number.

use crate::diagnosis::config::DiagnosisConfig;
use crate::diagnosis::signature::{Pattern, Signature};
use crate::name::Name;

/// A table is full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;

/// Takes away the rows of this name; the number that they had, or the first that no row has.
#[inline]
pub fn make_room(config: &mut DiagnosisConfig, name: Name) -> u8 {
    let tables = || [&config.detection, &config.isolation].into_iter().flatten();
    let before = tables().find(|row| row.name == name).map(|row| row.number);
    let free = (1..=u8::MAX).find(|number| tables().all(|row| row.number != *number));
    let rows = [&mut config.detection, &mut config.isolation];
    rows.into_iter().for_each(|rows| rows.retain(|row| row.name != name));
    before.or(free).unwrap_or(u8::MAX)
}

/// Rows of the isolation table with which a pattern cannot stand, since some symptoms match both; with their places, from 1.
#[inline]
pub fn conflicts(config: &DiagnosisConfig, pattern: Pattern) -> impl Iterator<Item = (usize, &Signature)> {
    (1..).zip(&config.isolation).filter(move |(_, row)| row.pattern.overlaps(&pattern))
}

/// Puts a row behind those of both tables; of detection the last that matches is the answer, so that its number stands there, too.
///
/// # Errors
/// A table is full; nothing has changed then.
#[inline]
pub fn add(config: &mut DiagnosisConfig, row: Signature) -> Result<(), Full> {
    if config.detection.is_full() || config.isolation.is_full() {
        return Err(Full);
    }
    let rows = [&mut config.detection, &mut config.isolation];
    rows.into_iter().try_for_each(|rows| rows.push(row).map_err(|_| Full))
}
