//! What a cell says of the time: a number in some unit, a clock, or a date.

use anyhow::Context;
use jiff::Timestamp;
use jiff::civil::DateTime;
use jiff::tz::TimeZone;
use serde::Deserialize;

use super::names::words;
use super::table::Table;

/// The unit of a time that is told as a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Unit {
    /// Nanoseconds.
    #[serde(rename = "ns")]
    Nanoseconds,
    /// Microseconds.
    #[serde(rename = "us")]
    Microseconds,
    /// Milliseconds.
    #[serde(rename = "ms")]
    Milliseconds,
    /// Seconds.
    #[serde(rename = "s")]
    Seconds,
    /// Minutes.
    #[serde(rename = "min")]
    Minutes,
    /// Hours.
    #[serde(rename = "h")]
    Hours,
    /// Days.
    #[serde(rename = "d")]
    Days,
}

/// Every unit: what it is called first on the command line, then in headers; and how many s it has.
const UNITS: [(Unit, &[&str], f64); 7] = [
    (Unit::Nanoseconds, &["ns", "nanos", "nanoseconds"], 1e-9),
    (Unit::Microseconds, &["us", "µs", "micros", "microseconds"], 1e-6),
    (Unit::Milliseconds, &["ms", "msec", "millis", "milliseconds"], 1e-3),
    (Unit::Seconds, &["s", "sec", "secs", "second", "seconds"], 1.0),
    (Unit::Minutes, &["min", "mins", "minute", "minutes"], 60.0),
    (Unit::Hours, &["h", "hr", "hrs", "hour", "hours"], 3600.0),
    (Unit::Days, &["d", "day", "days"], DAY),
];

impl Unit {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        UNITS.iter().find(|(unit, ..)| *unit == self).map_or("s", |(_, names, _)| names[0])
    }

    /// The one of this name on the command line.
    ///
    /// # Errors
    /// There is none.
    pub fn parse(name: &str) -> anyhow::Result<Self> {
        let found = UNITS.iter().find(|(_, names, _)| names[0] == name);
        let known = || UNITS.map(|(_, names, _)| names[0]).join(", ");
        found.map(|(unit, ..)| *unit).with_context(|| format!("`{name}`: expected one of {}", known()))
    }

    fn seconds(self) -> f64 {
        UNITS.iter().find(|(unit, ..)| *unit == self).map_or(1.0, |(.., seconds)| *seconds)
    }

    /// As the name of a column says: `t_s`, `Time (min)`, `millis`.
    fn of_header(name: &str) -> Option<Self> {
        let words = words(name);
        let unit = |word: &String| UNITS.iter().find(|(_, names, _)| names.contains(&word.as_str()));
        words.iter().rev().find_map(unit).map(|(unit, ..)| *unit)
    }

    /// As the numbers themselves say: since 1970 there have been so many seconds, milliseconds .., and no logger waits for 1000 s.
    fn of_values(first: f64, step: f64) -> Self {
        /// Steps of 100 and more that are seconds: minutes and hours.
        const SLOW: [f64; 12] =
            [120.0, 180.0, 240.0, 300.0, 360.0, 600.0, 720.0, 900.0, 1200.0, 1800.0, 3600.0, 7200.0];
        match first.abs() {
            1e17.. => Self::Nanoseconds,
            1e14.. => Self::Microseconds,
            1e11.. => Self::Milliseconds,
            _ if step >= 100.0 && !SLOW.iter().any(|slow| (step - slow).abs() <= 1.0) => Self::Milliseconds,
            _ => Self::Seconds,
        }
    }
}

/// How dates are written. Of 5/1/2024 the month comes first unless that can't be.
const PATTERNS: [&str; 20] = [
    "%m/%d/%Y %I:%M:%S%.f %p",
    "%m/%d/%Y %I:%M %p",
    "%m/%d/%Y %H:%M:%S%.f",
    "%m/%d/%Y %H:%M",
    "%m/%d/%y %I:%M:%S%.f %p",
    "%m/%d/%y %I:%M %p",
    "%m/%d/%y %H:%M:%S%.f",
    "%m/%d/%y %H:%M",
    "%d/%m/%Y %H:%M:%S%.f",
    "%d/%m/%Y %H:%M",
    "%d.%m.%Y %H:%M:%S%.f",
    "%d.%m.%Y %H:%M",
    "%d.%m.%y %H:%M:%S%.f",
    "%d.%m.%y %H:%M",
    "%d-%m-%Y %H:%M:%S%.f",
    "%d-%b-%Y %H:%M:%S%.f",
    "%Y/%m/%d %H:%M:%S%.f",
    "%Y/%m/%d %H:%M",
    "%Y-%m-%d %I:%M:%S%.f %p",
    "%a %b %d %H:%M:%S %Y",
];

/// The seconds of a day.
const DAY: f64 = 86_400.0;

/// How the times of a column are written.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// A number.
    Number,
    /// ISO 8601 with its distance from UTC.
    Instant,
    /// ISO 8601 as a clock on the wall shows it.
    Civil,
    /// One of [`PATTERNS`].
    Pattern(&'static str),
    /// Hours, minutes and seconds, or the last two.
    Clock,
}

/// Makes seconds of the cells of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamps {
    form: Form,
    unit: Unit,
    /// Nobody said the unit: the numbers look like it.
    pub guessed: bool,
}

impl Stamps {
    /// How a column tells its times; `unit`: said by whoever knows.
    ///
    /// # Errors
    /// The cell that is no time, with file, line, column and text.
    pub fn of(table: &Table, column: usize, unit: Option<Unit>) -> anyhow::Result<(Self, Vec<Option<f64>>)> {
        let first = table.first_of(column)?.unwrap_or_default();
        let mut refused = None;
        for form in Form::all().filter(|form| form.seconds(&first).is_some()) {
            match table.read_as(column, |cell| form.seconds(cell)) {
                Ok(numbers) => return Ok(Self::with(form, numbers, &table.name(column), unit)),
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        match refused {
            Some(error) => Err(error),
            // Nothing that it could be: the usual error, at the first cell.
            None => table.values_or_gaps(column).map(|numbers| Self::with(Form::Number, numbers, "", unit)),
        }
    }

    fn with(
        form: Form,
        mut numbers: Vec<Option<f64>>,
        name: &str,
        unit: Option<Unit>,
    ) -> (Self, Vec<Option<f64>>) {
        let mut stamps = Self { form, unit: Unit::Seconds, guessed: false };
        if form == Form::Number {
            let known = unit.or_else(|| Unit::of_header(name));
            stamps.unit = known.unwrap_or_else(|| {
                let first = numbers.iter().flatten().next().copied().unwrap_or(0.0);
                Unit::of_values(first, usual_step(numbers.iter().flatten().copied()).unwrap_or(0.0))
            });
            stamps.guessed = known.is_none() && stamps.unit != Unit::Seconds;
            numbers.iter_mut().flatten().for_each(|number| *number *= stamps.unit.seconds());
        }
        if form == Form::Clock {
            past_midnight(&mut numbers);
        }
        (stamps, numbers)
    }

    /// The seconds of a cell.
    pub fn seconds(&self, cell: &str) -> Option<f64> {
        Some(self.form.seconds(cell)? * self.unit.seconds())
    }

    /// From one time to another, s: a clock passes midnight.
    pub fn between(&self, from: f64, to: f64) -> f64 {
        let passed = to - from;
        if self.form == Form::Clock && passed < -0.5 * DAY { passed + DAY } else { passed }
    }

    /// The unit of times that are numbers.
    pub fn unit(&self) -> Option<Unit> {
        (self.form == Form::Number).then_some(self.unit)
    }
}

impl Form {
    fn all() -> impl Iterator<Item = Self> {
        let patterns = PATTERNS.into_iter().map(Self::Pattern);
        [Self::Number, Self::Instant, Self::Civil].into_iter().chain(patterns).chain([Self::Clock])
    }

    fn seconds(self, cell: &str) -> Option<f64> {
        match self {
            Self::Number => cell.parse().ok().or_else(|| cell.replace(',', ".").parse().ok()),
            Self::Instant => Some(instant(cell.parse().ok()?)),
            // A date alone is no time of a sample.
            Self::Civil => civil(cell.contains(':').then(|| cell.parse().ok())??),
            Self::Pattern(pattern) => {
                // 5/1/2024, 10:00:00 AM with a narrow space, as browsers write it.
                let plain = cell.replace(',', " ");
                let plain = plain.split_whitespace().collect::<Vec<_>>().join(" ");
                civil(DateTime::strptime(pattern, plain).ok()?)
            }
            Self::Clock => clock(cell),
        }
    }
}

/// Whether a cell may be a time that is no number.
pub fn is_time(cell: &str) -> bool {
    Form::all().any(|form| form != Form::Number && form.seconds(cell).is_some())
}

fn instant(instant: Timestamp) -> f64 {
    instant.as_nanosecond() as f64 * 1e-9
}

fn civil(time: DateTime) -> Option<f64> {
    TimeZone::UTC.to_timestamp(time).ok().map(instant)
}

/// A time of day or a duration: hours, minutes and seconds, or the last two.
fn clock(cell: &str) -> Option<f64> {
    let (cell, half) = match cell.split_once(char::is_whitespace) {
        Some((cell, half)) if half.eq_ignore_ascii_case("am") => (cell, Some(0.0)),
        Some((cell, half)) if half.eq_ignore_ascii_case("pm") => (cell, Some(12.0)),
        _ => (cell, None),
    };
    let mut parts = cell.split(':');
    let first: f64 = parts.next().filter(|_| cell.contains(':'))?.parse().ok()?;
    // Twelve is the hour before one.
    let first = half.map_or(first, |half| first % 12.0 + half);
    parts.try_fold(first, |time, part| Some(60.0 * time + part.parse::<f64>().ok()?))
}

/// A clock that falls back by more than half a day has passed midnight.
fn past_midnight(times: &mut [Option<f64>]) {
    let (mut days, mut last) = (0.0, None);
    for time in times.iter_mut().flatten() {
        let shown = *time;
        days += if last.is_some_and(|last| shown < last - 0.5 * DAY) { DAY } else { 0.0 };
        last = Some(shown);
        *time += days;
    }
}

/// The median of the steps forward.
pub fn usual_step(times: impl Iterator<Item = f64>) -> Option<f64> {
    let times: Vec<f64> = times.collect();
    let mut steps: Vec<f64> =
        times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    let middle = steps.len() / 2;
    (!steps.is_empty()).then(|| *steps.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(header: &str, cells: &[&str]) -> anyhow::Result<Vec<f64>> {
        let table = Table::parse("f".into(), &format!("{header};u\n{};1\n", cells.join(";1\n"))).unwrap();
        let (_, times) = Stamps::of(&table, 0, None)?;
        let first = times.iter().flatten().next().copied().unwrap_or(0.0);
        Ok(times.into_iter().flatten().map(|time| ((time - first) * 1e4).round() / 1e4).collect())
    }

    #[test]
    fn three_samples_of_half_a_second_are_the_same_however_they_are_stamped() {
        for (header, cells) in [
            ("t", ["0", "0.5", "1"]),
            ("t", ["0", "0,5", "1,0"]),
            ("t", ["1714557600", "1714557600.5", "1714557601"]),
            ("t", ["1714557600000", "1714557600500", "1714557601000"]),
            ("t", ["1714557600000000000", "1714557600500000000", "1714557601000000000"]),
            ("t", ["12000", "12500", "13000"]),
            ("t_ms", ["0", "500", "1000"]),
            ("Time (min)", ["0", "0.00833333333", "0.0166666667"]),
            ("t", ["2024-05-01T10:00:00Z", "2024-05-01T10:00:00.5Z", "2024-05-01T10:00:01Z"]),
            ("t", ["2024-05-01T10:00:00+02:00", "2024-05-01T10:00:00.5+02:00", "2024-05-01T10:00:01+02:00"]),
            ("t", ["2024-05-01 10:00:00", "2024-05-01 10:00:00.500", "2024-05-01 10:00:01"]),
            ("t", ["2024-05-01 10:00:00,000", "2024-05-01 10:00:00,500", "2024-05-01 10:00:01,000"]),
            ("t", ["5/1/2024 9:59:59.5 AM", "5/1/2024 10:00:00 AM", "5/1/2024 10:00:00.5 AM"]),
            ("t", ["05/01/2024 23:59:59.5", "05/02/2024 00:00:00", "05/02/2024 00:00:00.5"]),
            ("t", ["12/31/23 23:59:59.5", "01/01/24 00:00:00", "01/01/24 00:00:00.5"]),
            (
                "t",
                [
                    "5/1/2024, 9:59:59.5\u{202f}PM",
                    "5/1/2024, 10:00:00\u{202f}PM",
                    "5/1/2024, 10:00:00.5\u{202f}PM",
                ],
            ),
            ("t", ["12/05/2024 23:59:59.5", "13/05/2024 00:00:00", "13/05/2024 00:00:00.5"]),
            ("t", ["30.04.2024 23:59:59.5", "01.05.2024 00:00:00", "01.05.2024 00:00:00.5"]),
            ("t", ["2024/05/01 10:00:00", "2024/05/01 10:00:00.5", "2024/05/01 10:00:01"]),
            ("t", ["00:59:59.5", "01:00:00", "01:00:00.5"]),
            ("t", ["23:59:59.5", "00:00:00", "00:00:00.5"]),
            ("t", ["11:59:59.5 AM", "12:00:00 PM", "12:00:00.5 PM"]),
        ] {
            assert_eq!(times(header, &cells).unwrap(), [0.0, 0.5, 1.0], "{cells:?}");
        }
    }

    #[test]
    fn slow_loggers_count_seconds_and_what_is_no_time_is_named_by_its_place() {
        assert_eq!(times("t", &["0", "300", "600"]).unwrap(), [0.0, 300.0, 600.0]);
        assert_eq!(times("t", &["0", "10", "20"]).unwrap(), [0.0, 10.0, 20.0]);
        assert_eq!(times("hours", &["0", "1", "2"]).unwrap(), [0.0, 3600.0, 7200.0]);
        let said = times("t", &["2024-05-01 10:00:00", "yesterday"]).unwrap_err().to_string();
        assert!(said.contains("line 3, column 1 (t) is `yesterday`"), "{said}");
        let said = times("t", &["yesterday", "1"]).unwrap_err().to_string();
        assert!(said.contains("line 2, column 1 (t) is `yesterday`"), "{said}");
    }
}
