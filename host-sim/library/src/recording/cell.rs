//! What a cell of a table says.

/// What loggers write where they have nothing to say; what a spreadsheet could not compute begins with `#`.
const NOTHING: [&str; 10] = ["", "nan", "null", "none", "n/a", "na", "-", "--", "unknown", "unavailable"];

/// A switch that is on, and one that is off: English, German, Portuguese, Spanish.
const ON: [&str; 8] = ["on", "true", "yes", "ein", "an", "ligado", "encendido", "heating"];
const OFF: [&str; 8] = ["off", "false", "no", "aus", "nein", "desligado", "apagado", "idle"];

/// What may stand between thousands, besides the mark that is not the decimals'.
const BETWEEN: [char; 6] = [' ', '\u{a0}', '\u{202f}', '\u{2009}', '\'', '\u{2019}'];

/// Which mark stands before the decimals of a table, where a cell by itself does not tell: `1.000` and `1,000` are one or a thousand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Decimal {
    /// A point in some cells, and a comma in others.
    #[default]
    Either,
    /// A point; commas stand between thousands.
    Point,
    /// A comma; points stand between thousands.
    Comma,
}

impl Decimal {
    /// By cells that tell; `else_` if none does.
    pub(super) fn of<'a>(cells: impl Iterator<Item = &'a str>, else_: Self) -> Self {
        let (mut point, mut comma) = (false, false);
        for cell in cells.filter(|cell| cell.contains(['.', ','])) {
            match [with_decimals(cell, '.'), with_decimals(cell, ',')] {
                [Some(_), None] => point = true,
                [None, Some(_)] => comma = true,
                _ => {}
            }
        }
        match (point, comma) {
            (true, true) => Self::Either,
            (true, false) => Self::Point,
            (false, true) => Self::Comma,
            (false, false) => else_,
        }
    }
}

/// Whether a cell says that its sample is missing.
pub(super) fn is_missing(cell: &str) -> bool {
    // Most cells are numbers, and need no more than a look at how they begin.
    !cell.starts_with(|c: char| c.is_ascii_digit())
        && (cell.starts_with('#') || NOTHING.iter().any(|word| cell.eq_ignore_ascii_case(word)))
}

/// A number with this mark before its decimals, and perhaps marks between its thousands.
fn with_decimals(cell: &str, decimal: char) -> Option<f64> {
    let (whole, decimals) = cell
        .split_once(decimal)
        .map_or((cell, String::new()), |(whole, decimals)| (whole, format!(".{decimals}")));
    if decimals[..].contains(',') || decimals.matches('.').count() > 1 {
        return None;
    }
    let other = if decimal == '.' { ',' } else { '.' };
    let digits = whole.trim_start_matches(['-', '+']);
    let between = |c: char| c == other || BETWEEN.contains(&c);
    let Some(mark) = digits.chars().find(|c| between(*c)) else {
        return (whole.to_owned() + &decimals).parse().ok();
    };
    let mut groups = digits.split(mark);
    let first = groups.next().filter(|first| (1..=3).contains(&first.len()) && !first.starts_with('0'))?;
    let is_group = |group: &str| group.len() == 3 && group.bytes().all(|c| c.is_ascii_digit());
    let rest = groups.map(|group| Some(group).filter(|group| is_group(group))).collect::<Option<String>>()?;
    let sign = &whole[..whole.len() - digits.len()];
    format!("{sign}{first}{rest}{decimals}").parse().ok()
}

/// A number with a point or a comma before its decimals, and perhaps marks between its thousands.
pub(super) fn number(cell: &str, decimal: Decimal) -> Option<f64> {
    if decimal != Decimal::Comma
        && let Ok(number) = cell.parse()
    {
        return Some(number);
    }
    let minus = cell.starts_with('\u{2212}').then(|| cell.replacen('\u{2212}', "-", 1));
    let cell = minus.as_deref().unwrap_or(cell);
    // A mark that stands alone is the decimals', unless the table says otherwise.
    let order = match decimal {
        Decimal::Comma => [',', '.'],
        Decimal::Either if cell.contains(',') => [',', '.'],
        _ => ['.', ','],
    };
    let [first, other] = order.map(|mark| with_decimals(cell, mark));
    first.or(other)
}

/// A number, one with its unit behind it, or a switch as 0 or 1.
pub(super) fn value(cell: &str, decimal: Decimal) -> Option<f64> {
    let is = |words: &[&str]| words.iter().any(|word| cell.eq_ignore_ascii_case(word));
    let switch = || match () {
        () if is(&ON) => Some(1.0),
        () if is(&OFF) => Some(0.0),
        () => None,
    };
    let unit = |c: char| c.is_alphabetic() || c.is_whitespace() || ['%', '°'].contains(&c);
    number(cell, decimal).or_else(switch).or_else(|| number(cell.trim_end_matches(unit), decimal))
}

#[cfg(test)]
mod tests {
    use super::super::table::Table;

    #[test]
    fn numbers_are_read_as_people_and_loggers_write_them() {
        let read = |cell: &str| {
            let t = Table::parse("f".into(), &format!("u;y\n0;0\n0;{cell}\n")).unwrap();
            t.values_or_gaps(1).ok().map(|column| column.values[1])
        };
        for (cell, number) in [
            ("20,5", 20.5),
            ("1.234,5", 1234.5),
            ("1,234.5", 1234.5),
            ("1 234,5", 1234.5),
            ("-1\u{202f}234.5", -1234.5),
            ("1'234'567.25", 1_234_567.25),
            ("\u{2212}3,5", -3.5),
            ("-3", -3.0),
            ("1e3", 1000.0),
            ("2,5E+01", 25.0),
            ("23.5 °C", 23.5),
            ("45%", 45.0),
            ("on", 1.0),
            ("FALSE", 0.0),
        ] {
            assert_eq!(read(cell), Some(Some(number)), "{cell}");
        }
        for cell in ["", "NaN", "null", "n/a", "unavailable", "inf", "#VALUE!", "#N/A"] {
            assert_eq!(read(cell), Some(None), "{cell}");
        }
        for cell in ["x", "°C", "1.2.3", "3V3", "1 23,5"] {
            assert_eq!(read(cell), None, "{cell}");
        }
        let quoted = Table::parse("f".into(), "u,y\n0,\"20,5\"\n").unwrap();
        assert_eq!(quoted.values(1, 0..1).unwrap(), [20.5]);
    }

    /// `1.000` and `1,000` are a thousand where another cell of the table, or what separates its cells, says so.
    #[test]
    fn a_mark_between_thousands_is_told_by_the_rest_of_the_table() {
        for (text, expected) in [
            ("t,u\n\"999\",20.5\n\"1,000\",20.5\n", [999.0, 1000.0]),
            ("t;u\n999;20,5\n1.000;20,5\n", [999.0, 1000.0]),
            ("t,u\n999,20.5\n1.000,20.5\n", [999.0, 1.0]),
            ("t;u\n999;20\n1,000;20\n", [999.0, 1.0]),
            ("t,u\n\"999\",20\n\"1,000\",20\n", [999.0, 1000.0]),
            ("t;u\n0.5;20,5\n1.000;20,5\n", [0.5, 1.0]),
        ] {
            let t = Table::parse("f".into(), text).unwrap();
            assert_eq!(t.values(0, 0..2).unwrap(), expected, "{text}");
        }
    }
}
