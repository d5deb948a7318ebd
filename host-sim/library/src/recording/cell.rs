//! What a cell of a table says.

/// What loggers write where they have nothing to say.
const NOTHING: [&str; 10] = ["", "nan", "null", "none", "n/a", "na", "-", "--", "unknown", "unavailable"];

/// Whether a cell says that its sample is missing.
pub(super) fn is_missing(cell: &str) -> bool {
    // Most cells are numbers, and need no more than a look at how they begin.
    !cell.starts_with(|c: char| c.is_ascii_digit())
        && NOTHING.iter().any(|word| cell.eq_ignore_ascii_case(word))
}

/// A number with a point or a comma before its decimals, and perhaps marks between its thousands.
pub(super) fn number(cell: &str) -> Option<f64> {
    cell.parse().ok().or_else(|| {
        let comma = cell.rfind(',')?;
        let plain = match cell.rfind('.') {
            Some(point) if point > comma => cell.replace(',', ""),
            _ => cell.replace('.', "").replace(',', "."),
        };
        plain.parse().ok()
    })
}

/// A number, one with its unit behind it, or a switch as 0 or 1.
pub(super) fn value(cell: &str) -> Option<f64> {
    let is = |words: [&str; 3]| words.iter().any(|word| cell.eq_ignore_ascii_case(word));
    let switch = || match () {
        () if is(["on", "true", "yes"]) => Some(1.0),
        () if is(["off", "false", "no"]) => Some(0.0),
        () => None,
    };
    let unit = |c: char| c.is_alphabetic() || c.is_whitespace() || ['%', '°'].contains(&c);
    number(cell).or_else(switch).or_else(|| number(cell.trim_end_matches(unit)))
}

#[cfg(test)]
mod tests {
    use super::super::table::Table;

    #[test]
    fn numbers_are_read_as_people_and_loggers_write_them() {
        let read = |cell: &str| {
            let t = Table::parse("f".into(), &format!("u;y\n0;0\n0;{cell}\n")).unwrap();
            t.values_or_gaps(1).ok().map(|values| values[1])
        };
        for (cell, number) in [
            ("20,5", 20.5),
            ("1.234,5", 1234.5),
            ("1,234.5", 1234.5),
            ("-3", -3.0),
            ("1e3", 1000.0),
            ("23.5 °C", 23.5),
            ("45%", 45.0),
            ("on", 1.0),
            ("FALSE", 0.0),
        ] {
            assert_eq!(read(cell), Some(Some(number)), "{cell}");
        }
        for cell in ["", "NaN", "null", "n/a", "unavailable", "inf"] {
            assert_eq!(read(cell), Some(None), "{cell}");
        }
        for cell in ["x", "°C", "1.2.3", "3V3"] {
            assert_eq!(read(cell), None, "{cell}");
        }
        let quoted = Table::parse("f".into(), "u,y\n0,\"20,5\"\n").unwrap();
        assert_eq!(quoted.values(1, 0..1).unwrap(), [20.5]);
    }
}
