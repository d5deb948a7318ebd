//! The cells of a column as numbers.

use std::ops::Range;

use anyhow::{bail, ensure};
use csv::StringRecord;

use super::super::cell::{is_missing, value};
use super::{FEW, Table};

/// A column as numbers.
#[derive(Clone, Debug, Default)]
pub struct Column {
    /// One for each row; `None` where there is none.
    pub values: Vec<Option<f64>>,
    /// What whoever reads the results must know of it.
    pub remarks: Vec<String>,
}

impl Table {
    /// The numbers of `column` in `rows`.
    ///
    /// # Errors
    /// Rows that do not exist, lines that are no rows, and cells that are not finite numbers, with file, line, column and text.
    pub fn values(&self, column: usize, rows: Range<usize>) -> anyhow::Result<Vec<f64>> {
        let (count, file) = (self.rows(), &self.file);
        let Range { start, end } = rows;
        ensure!(
            start < end && end <= count,
            "rows {start}:{end} of {file}: expected N:M with N < M <= {count}, the number of data rows"
        );
        self.whole()?;
        let mut numbers = start..;
        self.map(rows, |cells| self.value(cells, column, numbers.next().unwrap_or(end)))
    }

    /// The numbers of each row, read at once.
    ///
    /// # Errors
    /// Lines that are no rows, and cells that are not finite numbers.
    pub fn numbers(&self) -> anyhow::Result<Vec<Vec<f64>>> {
        self.whole()?;
        let mut numbers = 0..self.rows();
        self.map(0..self.rows(), |cells| {
            let row = numbers.next().unwrap_or_default();
            (0..self.width()).map(|column| self.value(cells, column, row)).collect()
        })
    }

    /// # Errors
    /// Lines that are no rows.
    fn whole(&self) -> anyhow::Result<()> {
        match self.left_out() {
            None => Ok(()),
            Some(left_out) => bail!(
                "{}: {left_out} A regression cannot step over a gap: take them out of the file",
                self.file
            ),
        }
    }

    fn value(&self, cells: &StringRecord, column: usize, row: usize) -> anyhow::Result<f64> {
        let cell = &cells[column];
        let Some(value) = value(cell, self.decimal).filter(|v| v.is_finite()) else {
            let what = if cell.is_empty() { "is empty".to_owned() } else { format!("is `{cell}`") };
            bail!(
                "{}, line {}, column {} ({}) {what}, expected a number. A regression cannot step over a gap: leave \
                 row {row} out with --from and --to, or fill it in",
                self.file,
                self.line(cells),
                column + 1,
                self.name(column),
            );
        };
        Ok(value)
    }

    /// The numbers of `column`, with `None` where a cell is empty or says nan, none, n/a or the like.
    ///
    /// # Errors
    /// More than a few cells that hold anything else: the first of them with file, line, column and text.
    pub fn values_or_gaps(&self, column: usize) -> anyhow::Result<Column> {
        self.read_as(column, "a number", |cell| value(cell, self.decimal))
    }

    /// What `of` makes of each cell of `column`, with `None` where a cell says that there is none, and where a few say something else; `expected` says what
    /// should stand there.
    ///
    /// # Errors
    /// More than a few cells that it makes nothing of: the first of them with file, line, column and text.
    pub fn read_as(
        &self,
        column: usize,
        expected: &str,
        mut of: impl FnMut(&str) -> Option<f64>,
    ) -> anyhow::Result<Column> {
        let (mut nothing, mut odd, mut first) = (0, 0, None);
        let values = self.map(0..self.rows, |cells| {
            let cell = &cells[column];
            if cell.is_empty() {
                return Ok(None);
            }
            let read = if is_missing(cell) { None } else { of(cell) };
            if read.is_none() {
                let count = if is_missing(cell) { &mut nothing } else { &mut odd };
                *count += 1;
                // What is odd is told rather than what says that it is missing.
                if odd + nothing == 1 || odd == 1 && !is_missing(cell) {
                    first = Some((self.line(cells), cell.to_owned()));
                }
            }
            Ok(read.filter(|value| value.is_finite()))
        })?;
        let Some((line, cell)) = first else { return Ok(Column { values, remarks: Vec::new() }) };
        let (file, name) = (&self.file, self.name(column));
        ensure!(
            odd * FEW <= self.rows,
            "{file}, line {line}, column {} ({name}) is `{cell}`, expected {expected}, or nothing where a sample is missing",
            column + 1
        );
        let said = format!(
            "Cells of {name} that hold no number, such as `{cell}` in line {line}: {}, taken as missing.",
            odd + nothing
        );
        Ok(Column { values, remarks: vec![said] })
    }

    /// What stands in these columns of each row.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(in super::super) fn texts<const N: usize>(
        &self,
        columns: [usize; N],
    ) -> anyhow::Result<Vec<[String; N]>> {
        self.map(0..self.rows, |cells| Ok(columns.map(|column| cells[column].to_owned())))
    }

    /// The first cells of `column` that are not missing, at most so many.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn begin_of(&self, column: usize, count: usize) -> anyhow::Result<Vec<String>> {
        let mut cells = Vec::new();
        let mut records = self.records();
        while cells.len() < count
            && let Some(row) = records.next()?
        {
            if !is_missing(&row[column]) {
                cells.push(row[column].to_owned());
            }
        }
        Ok(cells)
    }

    /// The first cell of `column` that is not missing.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn first_of(&self, column: usize) -> anyhow::Result<Option<String>> {
        Ok(self.begin_of(column, 1)?.pop())
    }
}
