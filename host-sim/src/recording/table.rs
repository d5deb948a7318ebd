//! A recording: rows of numbers in a text file, read column by column.

use std::io::Read;
use std::ops::Range;
use std::path::Path;

use anyhow::{Context, bail, ensure};
use csv::{ReaderBuilder, StringRecord, Trim};

/// A text file cut into cells. A cell becomes a number only when its column and row are asked for, so what nobody asks
/// for may hold dates, text or nothing.
#[derive(Clone, Debug)]
pub struct Table {
    /// The file as the user named it, for messages.
    file: String,
    /// The first line, if no cell of it is a number.
    header: Option<StringRecord>,
    rows: Vec<StringRecord>,
    /// A comma inside a number is a decimal point.
    decimal_comma: bool,
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
    /// blanks.
    pub fn parse(file: String, text: &str) -> anyhow::Result<Self> {
        let text = text.trim_start_matches('\u{feff}');
        let first = text
            .lines()
            .find(|l| !l.trim().is_empty() && !l.trim_start().starts_with('#'))
            .unwrap_or_default();
        let separator = [';', '\t', ','].into_iter().find(|&s| first.contains(s));
        let mut rows = match separator {
            Some(separator) => cells(&file, text, separator as u8)?,
            None => cells(&file, &single_blanks(text), b' ')?,
        };
        let decimal_comma = separator != Some(',');
        let is_header = |r: &StringRecord| r.iter().all(|c| number(c, decimal_comma).is_none());
        let header = rows.first().is_some_and(is_header).then(|| rows.remove(0));
        ensure!(!rows.is_empty(), "{file} contains no data rows");
        Ok(Self { file, header, rows, decimal_comma })
    }

    /// What to call the file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Whether the first line names the columns.
    pub fn has_header(&self) -> bool {
        self.header.is_some()
    }

    /// How many data rows there are; comments, empty lines and the header do not count.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Index of the column that `name` means: the name in the header or else the number, from 1.
    ///
    /// # Errors
    /// No such column, or a name that occurs twice; the message lists the columns.
    pub fn column(&self, name: &str) -> anyhow::Result<usize> {
        let named = |i: &usize| self.header.as_ref().is_some_and(|h| &h[*i] == name);
        let found: Vec<usize> = (0..self.width()).filter(named).collect();
        match found[..] {
            [column] => return Ok(column),
            [] => {}
            _ => bail!(
                "{}: several columns are called `{name}`, name one by its number: {}",
                self.file,
                self.columns()
            ),
        }
        match name.parse::<usize>() {
            Ok(n) if (1..=self.width()).contains(&n) => Ok(n - 1),
            _ => bail!("{}: no column `{name}`; the columns are {}", self.file, self.columns()),
        }
    }

    /// What to call a column in a report.
    pub fn name(&self, column: usize) -> String {
        let name = self.header.as_ref().map_or("", |h| &h[column]);
        if name.is_empty() { format!("column {}", column + 1) } else { name.to_owned() }
    }

    /// The numbers of `column` in `rows`.
    ///
    /// # Errors
    /// Rows that do not exist, and cells that are not finite numbers, with file, line, column and text.
    pub fn values(&self, column: usize, rows: Range<usize>) -> anyhow::Result<Vec<f64>> {
        let (count, file) = (self.rows(), &self.file);
        let Some(chosen) = self.rows.get(rows.clone()).filter(|r| !r.is_empty()) else {
            let Range { start, end } = rows;
            bail!(
                "rows {start}:{end} of {file}: expected N:M with N < M <= {count}, the number of data rows"
            );
        };
        chosen.iter().zip(rows.start..).map(|(cells, row)| self.value(cells, column, row)).collect()
    }

    fn value(&self, cells: &StringRecord, column: usize, row: usize) -> anyhow::Result<f64> {
        let cell = &cells[column];
        let Some(value) = number(cell, self.decimal_comma).filter(|v| v.is_finite()) else {
            let what = if cell.is_empty() { "is empty".to_owned() } else { format!("is `{cell}`") };
            bail!(
                "{}, line {}, column {} ({}) {what}, expected a number. A regression cannot step over a gap: leave \
                 row {row} out with --from and --to, or fill it in",
                self.file,
                line(cells),
                column + 1,
                self.name(column),
            );
        };
        Ok(value)
    }

    /// The numbers of `column`, with `None` where a cell is empty or says `nan`.
    ///
    /// # Errors
    /// Cells that hold anything else, with file, line, column and text.
    pub fn values_or_gaps(&self, column: usize) -> anyhow::Result<Vec<Option<f64>>> {
        let value = |cells: &StringRecord| {
            let cell = &cells[column];
            if cell.is_empty() || cell.eq_ignore_ascii_case("nan") {
                return Ok(None);
            }
            let value = number(cell, self.decimal_comma).or_else(|| clock(cell)).filter(|v| v.is_finite());
            let place = || {
                let (file, line) = (&self.file, line(cells));
                format!(
                    "{file}, line {line}, column {} ({}) is `{cell}`, expected a number, or nothing where a sample is missing",
                    column + 1,
                    self.name(column)
                )
            };
            Ok(Some(value.with_context(place)?))
        };
        self.rows.iter().map(value).collect()
    }

    /// The line of the file that a row came from, from 1.
    pub fn line_of(&self, row: usize) -> u64 {
        self.rows.get(row).map_or(0, line)
    }

    /// Whether a column is called so.
    pub fn has(&self, name: &str) -> bool {
        self.header.as_ref().is_some_and(|header| header.iter().any(|cell| cell == name))
    }

    /// How many columns there are.
    pub fn width(&self) -> usize {
        self.rows.first().map_or(0, StringRecord::len)
    }

    /// All columns, for messages.
    pub fn columns(&self) -> String {
        let describe = |i: usize| match self.header.as_ref().map(|h| &h[i]) {
            Some(name) if !name.is_empty() => format!("{} `{name}`", i + 1),
            _ => format!("{} (no name)", i + 1),
        };
        (0..self.width()).map(describe).collect::<Vec<_>>().join(", ")
    }
}

/// What to call a file, and its text; `-` is standard input.
///
/// # Errors
/// It cannot be read.
pub fn text_of(path: &Path) -> anyhow::Result<(String, String)> {
    let (file, bytes) = match path.to_str() {
        Some("-") => {
            let mut bytes = Vec::new();
            ("standard input".into(), std::io::stdin().read_to_end(&mut bytes).map(|_| bytes))
        }
        _ => (path.display().to_string(), std::fs::read(path)),
    };
    let bytes = bytes.with_context(|| format!("cannot read {file}"))?;
    // Lossy: a degree sign in an old encoding must not keep anyone from the numbers.
    Ok((file, String::from_utf8_lossy(&bytes).into_owned()))
}

/// Every line as cells; all lines must have as many as the first.
fn cells(file: &str, text: &str, separator: u8) -> anyhow::Result<Vec<StringRecord>> {
    let mut reader = ReaderBuilder::new();
    reader.delimiter(separator).has_headers(false).flexible(true).comment(Some(b'#')).trim(Trim::All);
    let mut rows: Vec<StringRecord> = Vec::new();
    for row in reader.from_reader(text.as_bytes()).records() {
        let row = row.with_context(|| format!("cannot read {file}"))?;
        let width = rows.first().map_or(row.len(), StringRecord::len);
        ensure!(
            row.len() == width,
            "{file}, line {}: {} cells, expected {width} as on the first line",
            line(&row),
            row.len()
        );
        rows.push(row);
    }
    Ok(rows)
}

/// The same lines with each run of blanks made one.
fn single_blanks(text: &str) -> String {
    text.lines().map(|l| l.split_whitespace().collect::<Vec<_>>().join(" ") + "\n").collect()
}

/// The line of the file that a row came from, from 1.
fn line(row: &StringRecord) -> u64 {
    row.position().map_or(0, csv::Position::line)
}

/// A time of day or a duration: hours, minutes and seconds, or the last two.
fn clock(cell: &str) -> Option<f64> {
    let mut parts = cell.split(':');
    let first = parts.next().filter(|_| cell.contains(':'))?;
    parts.try_fold(first.parse::<f64>().ok()?, |time, part| Some(60.0 * time + part.parse::<f64>().ok()?))
}

fn number(cell: &str, decimal_comma: bool) -> Option<f64> {
    if decimal_comma { cell.replace(',', ".").parse().ok() } else { cell.parse().ok() }
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
    fn a_name_in_the_header_wins_over_a_number() {
        // "1" is no header on its own, so the line needs a cell that is no number, and none that is.
        let t = table("a,b\n5,6\n");
        assert_eq!((t.column("b").unwrap(), t.column("1").unwrap()), (1, 0));
        assert!(t.column("0").is_err() && t.column("3").is_err());
    }

    #[test]
    fn an_unknown_or_ambiguous_column_lists_the_columns() {
        let t = table(",T,T\n1,2,3\n");
        let unknown = t.column("Q").unwrap_err().to_string();
        assert_eq!(unknown, "f: no column `Q`; the columns are 1 (no name), 2 `T`, 3 `T`");
        assert!(t.column("T").unwrap_err().to_string().contains("several columns are called `T`"));
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
