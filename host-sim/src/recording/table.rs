//! A recording: rows of numbers in a text file, read column by column.

use std::io::Read;
use std::ops::Range;
use std::path::Path;

use anyhow::{Context, bail, ensure};
use csv::{ReaderBuilder, StringRecord, Trim};

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
    rows: usize,
    width: usize,
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
        let separator = separator(text);
        let text = if separator.is_some() { text.to_owned() } else { single_blanks(text) };
        let decimal_comma = separator != Some(',');
        let separator = separator.unwrap_or(' ') as u8;
        let mut table = Self { file, text, separator, header: None, rows: 0, width: 0, decimal_comma };
        let first = table.first()?;
        let rows = table.check_widths(first.len())?;
        let is_header = first.iter().all(|c| number(c, decimal_comma).is_none());
        table.width = first.len();
        table.rows = rows - usize::from(is_header && rows > 0);
        ensure!(table.rows > 0, "{} contains no data rows", table.file);
        table.header = is_header.then_some(first);
        Ok(table)
    }

    /// The first line that is one.
    fn first(&self) -> anyhow::Result<StringRecord> {
        let mut first = StringRecord::new();
        self.reader().read_record(&mut first).with_context(|| self.cannot_read())?;
        Ok(first)
    }

    /// All lines must have as many cells as the first; gives how many there are.
    fn check_widths(&self, width: usize) -> anyhow::Result<usize> {
        let (mut reader, mut row, mut rows) = (self.reader(), StringRecord::new(), 0);
        while reader.read_record(&mut row).with_context(|| self.cannot_read())? {
            ensure!(
                row.len() == width,
                "{}, line {}: {} cells, expected {width} as on the first line",
                self.file,
                line(&row),
                row.len()
            );
            rows += 1;
        }
        Ok(rows)
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
        for _ in 0..rows.start + usize::from(self.has_header()) {
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

    /// Whether the first line names the columns.
    pub fn has_header(&self) -> bool {
        self.header.is_some()
    }

    /// How many data rows there are; comments, empty lines and the header do not count.
    pub fn rows(&self) -> usize {
        self.rows
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
        self.map(0..self.rows, value)
    }

    /// The line of the file that a row came from, from 1.
    pub fn line_of(&self, row: usize) -> u64 {
        let found = self.map(row..row + 1, |cells| Ok(line(cells)));
        found.ok().and_then(|lines| lines.first().copied()).unwrap_or(0)
    }

    /// Whether a column is called so.
    pub fn has(&self, name: &str) -> bool {
        self.header.as_ref().is_some_and(|header| header.iter().any(|cell| cell == name))
    }

    /// How many columns there are.
    pub fn width(&self) -> usize {
        self.width
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

/// What stands between cells: the first of semicolon, tab, comma that the first line contains; none: blanks.
fn separator(text: &str) -> Option<char> {
    let is_row = |l: &&str| !l.trim().is_empty() && !l.trim_start().starts_with('#');
    let first = text.lines().find(is_row).unwrap_or_default();
    [';', '\t', ','].into_iter().find(|&s| first.contains(s))
}

/// A row of noughts below a header, to try the header with.
pub fn as_numbers(header: &str) -> String {
    let separator = separator(header);
    let cells = match separator {
        Some(separator) => header.split(separator).count(),
        None => header.split_whitespace().count(),
    };
    vec!["0"; cells].join(&separator.unwrap_or(' ').to_string())
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
