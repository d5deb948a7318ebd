//! Which lines of a table are rows.

use std::ops::Range;

use anyhow::{Context, bail, ensure};
use csv::StringRecord;

use super::{FEW, Table};

/// The rows of a table, one after the other.
pub(super) struct Records<'a> {
    table: &'a Table,
    reader: csv::Reader<&'a [u8]>,
    row: StringRecord,
    /// Heads that are still to come.
    heads: usize,
}

impl Records<'_> {
    /// The next that is a row.
    pub(super) fn next(&mut self) -> anyhow::Result<Option<&StringRecord>> {
        while self.reader.read_record(&mut self.row).with_context(|| self.table.cannot_read())? {
            if !self.table.is_row(&self.row) {
                continue;
            }
            if self.heads > 0 {
                self.heads -= 1;
            } else if !self.table.is_header(&self.row) {
                return Ok(Some(&self.row));
            }
        }
        Ok(None)
    }
}

impl Table {
    /// Whether a line has as many cells as the first. What a power failure leaves of a line is zeros.
    fn is_row(&self, row: &StringRecord) -> bool {
        row.len() >= self.width
            && row.iter().skip(self.width).all(str::is_empty)
            && !row.as_slice().contains('\0')
    }

    /// Whether it is the header.
    fn is_header(&self, row: &StringRecord) -> bool {
        let same = |header: &StringRecord| header.iter().zip(row).all(|(a, b)| a == b);
        self.header.as_ref().is_some_and(same)
    }

    /// Counts rows, and lines that are none. The last one may have been cut off while it was written.
    pub(super) fn count(&mut self) -> anyhow::Result<()> {
        let (mut row, mut rows, mut bad, mut first_bad, mut headers) = (StringRecord::new(), 0, 0, None, 0);
        let (mut reader, mut heads) = (self.reader(), self.heads);
        while reader.read_record(&mut row).with_context(|| self.cannot_read())? {
            if self.is_row(&row) {
                match () {
                    () if heads > 0 => heads -= 1,
                    () if self.is_header(&row) => headers += 1,
                    () => rows += 1,
                }
                continue;
            }
            let at_end = reader.position().byte() as usize >= self.text.len();
            if row.len() < self.width && at_end && !self.text.ends_with('\n') {
                break;
            }
            let line = self.line(&row);
            ensure!(
                !row.as_slice().contains('\n'),
                "{}, line {line}: a quotation mark is opened and not closed",
                self.file
            );
            bad += 1;
            first_bad.get_or_insert((line, row.len()));
        }
        if let Some((line, cells)) = first_bad.filter(|_| bad * FEW > rows + bad) {
            let advice = match self.separator {
                b',' if cells > self.width => {
                    ". If decimals have a comma, put a semicolon between the cells, or a point before the decimals"
                }
                _ => "",
            };
            bail!(
                "{}, line {line}: {cells} cells, expected {} as on the first line{advice}",
                self.file,
                self.width
            );
        }
        (self.rows, self.bad, self.first_bad, self.headers) = (rows, bad, first_bad, headers);
        Ok(())
    }

    /// What is no row, in words; none where all are.
    pub fn left_out(&self) -> Option<String> {
        let again = self.headers;
        let mut said = Vec::new();
        if let Some((line, _)) = self.first_bad {
            let count = self.bad;
            said.push(format!(
                "Lines that are no rows of {} cells: {count}, the first is line {line}; taken as missing.",
                self.width
            ));
        }
        if again > 0 {
            said.push(format!("The header stands there again: {again} more, passed over."));
        }
        (!said.is_empty()).then(|| said.join(" "))
    }

    pub(super) fn records(&self) -> Records<'_> {
        Records { table: self, reader: self.reader(), row: StringRecord::new(), heads: self.heads }
    }

    /// What `of` makes of some rows, one after the other.
    pub(super) fn map<T>(
        &self,
        rows: Range<usize>,
        mut of: impl FnMut(&StringRecord) -> anyhow::Result<T>,
    ) -> anyhow::Result<Vec<T>> {
        let mut records = self.records();
        for _ in 0..rows.start {
            records.next()?;
        }
        let mut all = Vec::with_capacity(rows.len());
        while all.len() < rows.len()
            && let Some(row) = records.next()?
        {
            all.push(of(row)?);
        }
        Ok(all)
    }
}
