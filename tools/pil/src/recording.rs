//! A recorded run: what the instrument was fed on each tick, and what came of it, as input for parts of it alone.

use fdi_core::diagnosis::baseline::Normal;
use fdi_core::diagnosis::residual::RESIDUALS;

use crate::codes::Codes;

/// Numbers in a row.
pub const ROW: usize = 6 + 2 * RESIDUALS;

/// One tick. What is not defined on it is NaN.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// ADC codes of T0, T1, T2.
    pub codes: Codes,
    /// y1 and y2, degC.
    pub rise: [f32; 2],
    /// Applied power, %.
    pub power: f32,
    /// Features.
    pub features: [f32; RESIDUALS],
    /// Features, low-passed.
    pub filtered: [f32; RESIDUALS],
}

impl Row {
    /// As a list of numbers.
    pub fn numbers(&self) -> [f32; ROW] {
        let mut all = [0.0; ROW];
        all[..3].copy_from_slice(&self.codes);
        all[3..5].copy_from_slice(&self.rise);
        all[5] = self.power;
        all[6..6 + RESIDUALS].copy_from_slice(&self.features);
        all[6 + RESIDUALS..].copy_from_slice(&self.filtered);
        all
    }
}

impl From<[f32; ROW]> for Row {
    fn from(all: [f32; ROW]) -> Self {
        Self {
            codes: core::array::from_fn(|i| all[i]),
            rise: [all[3], all[4]],
            power: all[5],
            features: core::array::from_fn(|i| all[6 + i]),
            filtered: core::array::from_fn(|i| all[6 + RESIDUALS + i]),
        }
    }
}

/// A run: rows as numbers, and what the low-passed features normally are.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'a> {
    rows: &'a [[f32; ROW]],
    /// Baseline of the low-passed features.
    pub normal: Normal,
}

impl<'a> Recording<'a> {
    /// Takes what the host has written: the baseline as two lists in the first row, then the ticks.
    pub fn new(rows: &'a [[f32; ROW]]) -> Option<Self> {
        let (first, rows) = rows.split_first()?;
        let normal = Normal {
            mean: core::array::from_fn(|i| first[i]),
            sigma: core::array::from_fn(|i| first[RESIDUALS + i]),
        };
        Some(Self { rows, normal })
    }

    /// The first row, which holds the baseline.
    pub fn first_row(normal: &Normal) -> [f32; ROW] {
        let mut row = [0.0; ROW];
        row[..RESIDUALS].copy_from_slice(&normal.mean);
        row[RESIDUALS..2 * RESIDUALS].copy_from_slice(&normal.sigma);
        row
    }

    /// Ticks.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// One tick.
    pub fn row(&self, tick: usize) -> Row {
        self.rows[tick].into()
    }

    /// All ticks.
    pub fn rows(&self) -> impl Iterator<Item = Row> {
        self.rows.iter().map(|&row| row.into())
    }
}
