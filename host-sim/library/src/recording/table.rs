//! A recording: rows of numbers in a text file, read column by column.

mod columns;

use std::ops::Range;
use std::path::Path;

use anyhow::{Context, bail, ensure};
use csv::{ReaderBuilder, StringRecord, Trim};

use super::cell::{is_missing, number, value};
use super::stamp;
use super::text::{separator, single_blanks, text_of};

/// A text file that is cut into cells. A cell becomes a number only when its column and row are asked for, so what nobody asks
/// for may hold dates, text or nothing; of millions of rows nothing but the text is kept.
#[derive(Clone, Debug)]
pub struct Table {
    /// The file as the user named it, for messages.
    file: String,
    text: String,
    separator: u8,
    /// The first line, if no cell of it is a number.
    header: Option<StringRecord>,
    /// Lines before the first row: the header, and a second one with the units.
    heads: usize,
    rows: usize,
    width: usize,
}

impl Table {
    /// Reads a file; `-` is standard input.
    ///
    /// # Errors
    /// The file cannot be read, a line has another number of cells than the first one, or there is no data.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let (file, text) = text_of(path)?;
        Self::parse(file, &text)
    }

    /// Cuts `text` into cells. The separator is the first of semicolon, tab, comma that the first line contains, else
    /// blanks. What a logger tells of itself above the header is passed over.
    ///
    /// # Errors
    /// A line has another number of cells than the first one, or there is no data.
    pub fn parse(file: String, text: &str) -> anyhow::Result<Self> {
        let text = text.trim_start_matches('\u{feff}');
        let text = match text.contains('\r') {
            true => text.replace("\r\n", "\n").replace('\r', "\n"),
            false => text.to_owned(),
        };
        let below = preamble(&text);
        Self::cut(file.clone(), text).or_else(|error| Self::cut(file, below.ok_or(error)?))
    }

    fn cut(file: String, text: String) -> anyhow::Result<Self> {
        let separator = separator(&text);
        let text = if separator.is_some() { text } else { single_blanks(&text) };
        let separator = separator.unwrap_or(' ') as u8;
        let mut table = Self { file, text, separator, header: None, heads: 0, rows: 0, width: 0 };
        let first = table.first()?;
        table.width = first.len();
        let rows = table.check_widths()?;
        let is_header = first.iter().all(|cell| number(cell).is_none());
        table.heads = usize::from(is_header && rows > 0);
        table.rows = rows - table.heads;
        table.header = is_header.then_some(first);
        while is_header && table.rows > 1 && table.skips_words()? {}
        ensure!(table.rows > 0, "{} contains no data rows", table.file);
        Ok(table)
    }

    /// The first line that is one.
    fn first(&self) -> anyhow::Result<StringRecord> {
        let mut first = StringRecord::new();
        self.reader().read_record(&mut first).with_context(|| self.cannot_read())?;
        Ok(first)
    }

    /// All lines must have as many cells as the first; gives how many there are. The last one may have been cut off while it was written.
    fn check_widths(&self) -> anyhow::Result<usize> {
        let (mut reader, mut row, mut rows) = (self.reader(), StringRecord::new(), 0);
        while reader.read_record(&mut row).with_context(|| self.cannot_read())? {
            let at_end = reader.position().byte() as usize >= self.text.len();
            if row.len() < self.width && at_end && !self.text.ends_with('\n') {
                break;
            }
            let is_whole = row.len() >= self.width && row.iter().skip(self.width).all(str::is_empty);
            ensure!(
                is_whole,
                "{}, line {}: {} cells, expected {} as on the first line",
                self.file,
                self.line(&row),
                row.len(),
                self.width
            );
            rows += 1;
        }
        Ok(rows)
    }

    /// Passes over the first row if it is but words: units, or the header below what a logger tells of itself, where it has more of them.
    fn skips_words(&mut self) -> anyhow::Result<bool> {
        let filled = |cells: &StringRecord| cells.iter().filter(|cell| !is_missing(cell)).count();
        let says = |cell: &str| value(cell).is_some() || stamp::is_time(cell);
        let first = self.map(0..1, |cells| Ok(cells.clone()))?.pop();
        let Some(words) = first.filter(|cells| filled(cells) > 0 && !cells.iter().any(says)) else {
            return Ok(false);
        };
        (self.heads, self.rows) = (self.heads + 1, self.rows - 1);
        if self.header.as_ref().is_some_and(|header| filled(&words) > filled(header)) {
            self.header = Some(words);
        }
        Ok(true)
    }

    fn cannot_read(&self) -> String {
        format!("cannot read {}", self.file)
    }

    fn reader(&self) -> csv::Reader<&[u8]> {
        let mut reader = ReaderBuilder::new();
        reader
            .delimiter(self.separator)
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .trim(Trim::All);
        reader.from_reader(self.text.as_bytes())
    }

    /// What `of` makes of some rows, one after the other.
    fn map<T>(
        &self,
        rows: Range<usize>,
        mut of: impl FnMut(&StringRecord) -> anyhow::Result<T>,
    ) -> anyhow::Result<Vec<T>> {
        let (mut reader, mut row) = (self.reader(), StringRecord::new());
        for _ in 0..rows.start + self.heads {
            reader.read_record(&mut row)?;
        }
        let mut all = Vec::with_capacity(rows.len());
        while all.len() < rows.len() && reader.read_record(&mut row)? {
            all.push(of(&row)?);
        }
        Ok(all)
    }

    /// What to call the file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// How many data rows there are; comments, empty lines and the header do not count.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The numbers of `column` in `rows`.
    ///
    /// # Errors
    /// Rows that do not exist, and cells that are not finite numbers, with file, line, column and text.
    pub fn values(&self, column: usize, rows: Range<usize>) -> anyhow::Result<Vec<f64>> {
        let (count, file) = (self.rows(), &self.file);
        let Range { start, end } = rows;
        ensure!(
            start < end && end <= count,
            "rows {start}:{end} of {file}: expected N:M with N < M <= {count}, the number of data rows"
        );
        let mut numbers = start..;
        self.map(rows, |cells| self.value(cells, column, numbers.next().unwrap_or(end)))
    }

    fn value(&self, cells: &StringRecord, column: usize, row: usize) -> anyhow::Result<f64> {
        let cell = &cells[column];
        let Some(value) = value(cell).filter(|v| v.is_finite()) else {
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
    /// Cells that hold anything else, with file, line, column and text.
    pub fn values_or_gaps(&self, column: usize) -> anyhow::Result<Vec<Option<f64>>> {
        self.read_as(column, value)
    }

    /// What `of` makes of each cell of `column`, with `None` where a cell says that there is none.
    ///
    /// # Errors
    /// Cells that it makes nothing of, with file, line, column and text.
    pub fn read_as(
        &self,
        column: usize,
        mut of: impl FnMut(&str) -> Option<f64>,
    ) -> anyhow::Result<Vec<Option<f64>>> {
        let value = |cells: &StringRecord| {
            let cell = &cells[column];
            if is_missing(cell) {
                return Ok(None);
            }
            let place = || {
                let (file, line) = (&self.file, self.line(cells));
                format!(
                    "{file}, line {line}, column {} ({}) is `{cell}`, expected a number, or nothing where a sample is missing",
                    column + 1,
                    self.name(column)
                )
            };
            Ok(Some(of(cell).with_context(place)?).filter(|value| value.is_finite()))
        };
        self.map(0..self.rows, value)
    }

    /// What stands in these columns of each row.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(super) fn texts<const N: usize>(&self, columns: [usize; N]) -> anyhow::Result<Vec<[String; N]>> {
        self.map(0..self.rows, |cells| Ok(columns.map(|column| cells[column].to_owned())))
    }

    /// The first cell of `column` that is not missing.
    pub fn first_of(&self, column: usize) -> anyhow::Result<Option<String>> {
        let (mut reader, mut row) = (self.reader(), StringRecord::new());
        for _ in 0..self.heads {
            reader.read_record(&mut row)?;
        }
        while reader.read_record(&mut row)? && row.len() == self.width {
            if !is_missing(&row[column]) {
                return Ok(Some(row[column].to_owned()));
            }
        }
        Ok(None)
    }

    /// The line of the file that a row came from, from 1.
    pub fn line_of(&self, row: usize) -> u64 {
        let found = self.map(row..row + 1, |cells| Ok(self.line(cells)));
        found.ok().and_then(|lines| lines.first().copied()).unwrap_or(0)
    }

    /// The line of a row, from 1. The reader says where it began to look for it: comments and empty lines may stand before.
    fn line(&self, row: &StringRecord) -> u64 {
        let begun = row.position().map_or(0, |position| position.byte() as usize).min(self.text.len());
        let (before, mut rest) = self.text.split_at(begun);
        let mut line = 1 + before.matches('\n').count() as u64;
        while let Some((passed, after)) = rest.split_once('\n') {
            if !passed.trim().is_empty() && !passed.starts_with('#') {
                break;
            }
            (line, rest) = (line + 1, after);
        }
        line
    }
}

/// The text with empty lines in place of those above a header, where without them its first lines are a table.
fn preamble(text: &str) -> Option<String> {
    const LONGEST: usize = 40;
    const LOOKED_AT: usize = 60;
    let lines: Vec<&str> = text.lines().take(LOOKED_AT).collect();
    let is_table = |skip: &usize| {
        let table = Table::cut(String::new(), lines[*skip..].join("\n") + "\n");
        table
            .is_ok_and(|table| table.width > 1 && table.has_header() && 2 * table.rows() > lines.len() - skip)
    };
    let skip = (1..lines.len().min(LONGEST)).find(is_table)?;
    let above: usize = lines[..skip].iter().map(|line| line.len() + 1).sum();
    Some("\n".repeat(skip) + &text[above..])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Table {
        Table::parse("f".into(), text).unwrap()
    }

    fn error(text: &str) -> String {
        Table::parse("f".into(), text).unwrap_err().to_string()
    }

    fn column(text: &str, name: &str) -> Vec<f64> {
        let t = table(text);
        t.values(t.column(name).unwrap(), 0..t.rows()).unwrap()
    }

    #[test]
    fn every_common_layout_gives_the_same_numbers() {
        for text in [
            "t,u,y\n0,1,2.5\n1,3,4.5\n",
            "\u{feff}t,u,y\r\n0,1,2.5\r\n\r\n1,3,4.5\r\n",
            "# by hand\nt , u , y\n0 , 1 , 2.5\n# pause\n1,3,4.5",
            "t;u;y\n0;1;2,5\n1;3;4,5\n",
            "t\tu\ty\n0\t1\t2.5\n1\t3\t4,5\n",
            "  t   u  y\n  # pause\n  0   1  2.5\n 10   3  4.5\n",
            "\"t, s\",\"u\",y\n0,\"1\",2.5\n1,3,4.5\n",
        ] {
            assert_eq!(column(text, "u"), [1.0, 3.0], "{text}");
            assert_eq!(column(text, "y"), [2.5, 4.5], "{text}");
            assert_eq!(column(text, "3"), [2.5, 4.5], "{text}");
        }
    }

    #[test]
    fn without_a_header_the_first_line_is_data() {
        assert_eq!(column("2024-05-01,1\n2024-05-02,2\n", "2"), [1.0, 2.0]);
        assert_eq!(table("1 2\n3 4\n").name(1), "column 2");
    }

    #[test]
    fn a_bad_cell_is_named_by_line_column_and_text_and_only_where_it_is_used() {
        let t = table("# x\nu,y\n1,2\n3,abc\n5,\n7,NaN\n9,10\n");
        for (row, text) in
            [(1, "line 4, column 2 (y) is `abc`"), (2, "line 5, column 2 (y) is empty"), (3, "`NaN`")]
        {
            let message = t.values(1, row..row + 1).unwrap_err().to_string();
            assert!(message.contains(text) && message.contains("--from"), "{message}");
        }
        assert_eq!(t.values(1, 4..5).unwrap(), [10.0]);
        assert_eq!(t.values(0, 0..5).unwrap(), [1.0, 3.0, 5.0, 7.0, 9.0]);
    }

    /// Whatever ends a line, and whatever stands between the rows.
    #[test]
    fn lines_are_counted_as_an_editor_counts_them() {
        for end in ["\n", "\r\n", "\r"] {
            for (lines, at) in [
                (["u,y", "1,2", "3,x"].as_slice(), 3),
                (&["# by hand", "u,y", "", "1,2", "# pause", "", "3,x", "4,5"], 7),
            ] {
                let t = table(&lines.join(end));
                let said = t.values_or_gaps(1).unwrap_err().to_string();
                assert!(said.starts_with(&format!("f, line {at}, column 2 (y) is `x`")), "{end:?}: {said}");
                assert_eq!(t.line_of(1), at, "{end:?}");
            }
        }
    }

    #[test]
    fn units_below_the_header_and_a_line_that_was_cut_off_are_no_rows() {
        assert_eq!(column("t,u,y\ns,%,degC\n0,1,2\n1,3,4\n2,5", "y"), [2.0, 4.0]);
        // Below what a logger tells of itself, with as many cells and with others; lines that end with a comma.
        for above in ["Logger:,X,\nof:,,\n", "Logger X\nSerial: 12, 7\n\n", "Logger X\n\n"] {
            let text = format!("{above}t,u,y\n0,1,2,\n1,3,4,\n2,x,5,\n");
            assert_eq!(table(&text).values(2, 0..2).unwrap(), [2.0, 4.0], "{above}");
            let said = table(&text).values_or_gaps(1).unwrap_err().to_string();
            let line = 4 + above.lines().count();
            assert!(said.contains(&format!("line {line}, column 2 (u) is `x`")), "{said}");
        }
        assert_eq!(column("t,u\n2024-05-01 10:00:00,off\n2024-05-01 10:00:01,on\n", "u"), [0.0, 1.0]);
    }

    #[test]
    fn rows_out_of_bounds_say_how_many_there_are() {
        let t = table("1\n2\n");
        for range in [0..3, 2..2, Range { start: 2, end: 1 }] {
            assert!(t.values(0, range).unwrap_err().to_string().contains("<= 2, the number of data rows"));
        }
    }

    #[test]
    fn ragged_and_empty_files_are_refused() {
        assert_eq!(error("u,y\n1,2\n3\n"), "f, line 3: 1 cells, expected 2 as on the first line");
        assert_eq!(error("# only this\n"), "f contains no data rows");
        assert_eq!(error("u,y\n"), "f contains no data rows");
    }
}
