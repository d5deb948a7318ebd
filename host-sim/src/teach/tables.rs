//! New rows in both tables of the settings. The same row detects and isolates: fdv and fiv give its number.

use anyhow::Context;
use fdi_core::Config;
use fdi_core::diagnosis::name::Name;
use fdi_core::diagnosis::signature::{MAX_ROWS, Rows, Signature};

/// A row of the isolation table that some symptoms match together with the new one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conflict {
    /// Where it stands, from 1.
    pub place: usize,
    /// The row.
    pub row: Signature,
    /// It asks for nothing else at all.
    pub same: bool,
}

/// Takes away the rows of this name; the number that they had, or the first that no row has.
pub(super) fn make_room(config: &mut Config, name: Name) -> u8 {
    let tables = || [&config.diagnosis.detection, &config.diagnosis.isolation].into_iter().flatten();
    let before = tables().find(|row| row.name == name).map(|row| row.number);
    let highest = tables().map(|row| row.number).max().unwrap_or(0);
    let rows = [&mut config.diagnosis.detection, &mut config.diagnosis.isolation];
    rows.into_iter().for_each(|rows| rows.retain(|row| row.name != name));
    before.unwrap_or(highest.saturating_add(1))
}

/// Rows of the isolation table with which the new one cannot stand.
pub(super) fn conflicts(config: &Config, new: &Signature) -> Vec<Conflict> {
    let rows = config.diagnosis.isolation.iter().zip(1..);
    rows.filter(|(row, _)| row.pattern.overlaps(&new.pattern))
        .map(|(row, at)| Conflict { place: at, row: *row, same: row.pattern == new.pattern })
        .collect()
}

/// Puts the row behind those of both tables; of detection the last that matches is the answer, so that its number stands there, too.
///
/// # Errors
/// A table is full.
pub(super) fn add(config: &mut Config, new: Signature) -> anyhow::Result<()> {
    let full =
        |_| anyhow::anyhow!("a table holds {MAX_ROWS} rows: take one away before {} is taught", new.name);
    let push = |rows: &mut Rows| rows.push(new).map_err(full);
    push(&mut config.diagnosis.detection)?;
    push(&mut config.diagnosis.isolation).context("diagnosis.isolation")
}
