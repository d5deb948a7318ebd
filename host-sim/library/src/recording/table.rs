//! A recording: rows of numbers in a text file, read column by column.

mod cells;
mod columns;
mod rows;

use std::path::Path;

use anyhow::{Context, ensure};
use csv::{ReaderBuilder, StringRecord, Trim};

pub use cells::Column;

use super::cell::{Decimal, is_missing, number, value};
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
    /// Which mark stands before decimals.
    decimal: Decimal,
    /// Lines that are no rows, the first of them, and how many cells it has.
    bad: usize,
    first_bad: Option<(u64, usize)>,
    /// How often the header stands there again, which a logger writes each time that it starts.
    headers: usize,
}

/// One line, or one cell of a column, in so many may be none: more are no accident, but another layout. Chosen.
const FEW: usize = 20;
/// Rows that are asked which mark stands before decimals.
const ASKED: usize = 2000;

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
        match (Self::cut(file.clone(), text), below) {
            // Where blanks separate, what a logger tells of itself may have as many words as the rows below.
            (Ok(table), Some(below)) if !table.has_header() => Self::cut(file, below),
            (Err(_), Some(below)) => Self::cut(file, below),
            (table, _) => table,
        }
    }

    fn cut(file: String, text: String) -> anyhow::Result<Self> {
        let separator = separator(&text);
        let text = if separator.is_some() { text } else { single_blanks(&text) };
        let separator = separator.unwrap_or(' ') as u8;
        let mut table = Self {
            file,
            text,
            separator,
            header: None,
            heads: 0,
            rows: 0,
            width: 0,
            decimal: Decimal::Either,
            bad: 0,
            first_bad: None,
            headers: 0,
        };
        let first = table.first()?;
        table.width = first.len();
        let is_header = first.iter().all(|cell| number(cell, Decimal::Either).is_none());
        table.heads = usize::from(is_header);
        table.header = is_header.then_some(first);
        table.count()?;
        let named = table.header.clone();
        while is_header && table.rows > 1 && table.skips_words()? {}
        if table.header != named {
            table.count()?;
        }
        ensure!(table.rows > 0, "{} contains no data rows", table.file);
        table.decimal = table.told_decimal()?;
        Ok(table)
    }

    /// The first line that is one.
    fn first(&self) -> anyhow::Result<StringRecord> {
        let mut first = StringRecord::new();
        self.reader().read_record(&mut first).with_context(|| self.cannot_read())?;
        Ok(first)
    }

    /// Which mark stands before decimals. Cells between commas that hold one are quoted: there it stands between thousands.
    fn told_decimal(&self) -> anyhow::Result<Decimal> {
        let else_ = if self.separator == b',' { Decimal::Point } else { Decimal::Either };
        let rows = self.map(0..self.rows.min(ASKED), |cells| Ok(cells.clone()))?;
        Ok(Decimal::of(rows.iter().flatten(), else_))
    }

    /// Passes over the first row if it is but words: units, or the header below what a logger tells of itself, where it has more of them.
    fn skips_words(&mut self) -> anyhow::Result<bool> {
        let filled = |cells: &StringRecord| cells.iter().filter(|cell| !is_missing(cell)).count();
        let says = |cell: &str| value(cell, Decimal::Either).is_some() || stamp::is_time(cell);
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

    /// Which mark stands before decimals.
    pub(super) fn decimal(&self) -> Decimal {
        self.decimal
    }

    /// What to call the file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// How many data rows there are; comments, empty lines and the header do not count.
    pub fn rows(&self) -> usize {
        self.rows
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
    use std::ops::Range;

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
        let commas = format!("t,u,y\n{}", "0,20,5,1\n".repeat(30));
        assert!(
            error(&commas).contains("line 2: 4 cells, expected 3")
                && error(&commas).contains("put a semicolon")
        );
        assert_eq!(error("# only this\n"), "f contains no data rows");
        assert_eq!(error("u,y\n"), "f contains no data rows");
    }
}
