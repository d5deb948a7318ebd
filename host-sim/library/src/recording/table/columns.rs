//! The columns of a table: their names, or numbers where they have none.

use anyhow::bail;

use super::Table;

impl Table {
    /// Whether the first line names the columns.
    pub fn has_header(&self) -> bool {
        self.header.is_some()
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

    /// Whether a column is called so.
    pub fn has(&self, name: &str) -> bool {
        self.header.as_ref().is_some_and(|header| header.iter().any(|cell| cell == name))
    }

    /// How many columns there are.
    pub fn width(&self) -> usize {
        self.width
    }

    /// All columns, for messages: each by its name, or by its first value.
    pub fn columns(&self) -> String {
        let describe = |i: usize| match self.header.as_ref().map(|h| &h[i]) {
            Some(name) if !name.is_empty() => format!("{} `{name}`", i + 1),
            _ => {
                let first = self.first_of(i).ok().flatten().unwrap_or_default();
                format!("{} (no name, begins with `{first}`)", i + 1)
            }
        };
        (0..self.width()).map(describe).collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Table {
        Table::parse("f".into(), text).unwrap()
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
        assert_eq!(unknown, "f: no column `Q`; the columns are 1 (no name, begins with `1`), 2 `T`, 3 `T`");
        assert!(t.column("T").unwrap_err().to_string().contains("several columns are called `T`"));
    }
}
