//! What a column says of the time: numbers in some unit, clocks, or dates.

use anyhow::{Context, bail};
use serde::Deserialize;

use super::clock::is_newest_first;
pub use super::date::is_time;
use super::date::{DAY, Form, HOUR};
use super::names::words;
use super::table::{Column, Table};

/// The unit of a time that is told as a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Unit {
    /// Nanoseconds.
    #[serde(rename = "ns")]
    Nanoseconds,
    /// Ticks of .NET and of Windows, 100 ns each.
    #[serde(rename = "ticks")]
    Ticks,
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
const UNITS: [(Unit, &[&str], f64); 8] = [
    (Unit::Nanoseconds, &["ns", "nanos", "nanoseconds"], 1e-9),
    (Unit::Ticks, &["ticks"], 1e-7),
    (Unit::Microseconds, &["us", "µs", "micros", "microseconds"], 1e-6),
    (Unit::Milliseconds, &["ms", "msec", "millis", "milliseconds"], 1e-3),
    (Unit::Seconds, &["s", "sec", "secs", "second", "seconds"], 1.0),
    (Unit::Minutes, &["min", "mins", "minute", "minutes"], 60.0),
    (Unit::Hours, &["h", "hr", "hrs", "hour", "hours"], HOUR),
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

    /// As the numbers themselves say: since 1970 there have been so many seconds, milliseconds .., and no logger waits for 1000 s. A spreadsheet counts
    /// days since 1900: no logger of a heater takes 100 samples a second.
    fn of_values(first: f64, step: f64) -> Self {
        /// Steps of 100 and more that are seconds: minutes and hours.
        const SLOW: [f64; 12] =
            [120.0, 180.0, 240.0, 300.0, 360.0, 600.0, 720.0, 900.0, 1200.0, 1800.0, 3600.0, 7200.0];
        let is_slow = |step: f64| SLOW.iter().any(|slow| (step - slow).abs() <= 1.0);
        match (first.abs(), step) {
            (1e18.., _) => Self::Nanoseconds,
            (1e17.., _) => Self::Ticks,
            (1e14.., _) => Self::Microseconds,
            (1e11.., _) => Self::Milliseconds,
            (2e4..3e6, 0.0..0.01) => Self::Days,
            (_, 1e9..) => Self::Nanoseconds,
            (_, 1e6..) if !is_slow(step / 1000.0) => Self::Microseconds,
            (_, 100.0..) if !is_slow(step) => Self::Milliseconds,
            _ => Self::Seconds,
        }
    }
}

/// How the times of a column are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamps {
    form: Form,
    unit: Unit,
}

/// What a cell of a column of times should say.
const EXPECTED: &str = "a time such as 10.5, 22:00:05 or 2026-03-28 22:00:05";

/// A clock that has counted up to so much begins at nought again: 32 bits of the unit, or 16. `millis() / 1000` is in seconds.
const BITS: [f64; 2] = [4_294_967_296.0, 65_536.0];
/// Samples that may be lost while it does, of each.
const LOST: [f64; 2] = [10.0, 1.5];

impl Stamps {
    /// How a column tells its times, and these in s; `unit`: said by whoever knows.
    ///
    /// # Errors
    /// The cell that is no time, with file, line, column and text.
    pub fn of(table: &Table, column: usize, unit: Option<Unit>) -> anyhow::Result<(Self, Column)> {
        /// Cells that are asked first how they are written.
        const ASKED: usize = 20;
        let begin = table.begin_of(column, ASKED)?;
        let reads = |form: &Form| {
            2 * begin.iter().filter(|cell| form.seconds(cell).is_some()).count() >= begin.len().max(1)
        };
        // Of 22:00 the unit says what the first number counts.
        let is_said = |form: &Form| match unit {
            Some(Unit::Minutes) => *form != Form::Clock,
            Some(Unit::Hours) => *form != Form::Stopwatch,
            _ => true,
        };
        let forms = Form::all(table.decimal()).into_iter().filter(|form| reads(form) && is_said(form));
        let read = |form: Form| Some((form, table.read_as(column, EXPECTED, |cell| form.seconds(cell))));
        let (mut found, mut refused) = (Vec::new(), None);
        for (form, column) in forms.filter_map(read) {
            match column {
                Ok(column) => found.push((form, column)),
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        let Some((form, column_of, is_doubtful)) = best(found) else {
            if let Some(error) = refused {
                return Err(error);
            }
            let first = begin.into_iter().next().unwrap_or_default();
            bail!(
                "{}, line {}, column {} ({}) is `{first}`, expected {EXPECTED}",
                table.file(),
                table.line_of(0),
                column + 1,
                table.name(column)
            )
        };
        let (stamps, mut column) = Self::with(form, column_of, &table.name(column), unit);
        let first = begin.first().map_or("", String::as_str);
        column.remarks.extend(
            form.in_doubt()
                .filter(|_| is_doubtful)
                .map(|said| format!("Times such as `{first}` are taken for {said}.")),
        );
        Ok((stamps, column))
    }

    fn with(form: Form, mut column: Column, name: &str, unit: Option<Unit>) -> (Self, Column) {
        let mut stamps = Self { form, unit: Unit::Seconds };
        let times = &mut column.values;
        if matches!(form, Form::Number(_)) {
            let known = unit.or_else(|| Unit::of_header(name));
            stamps.unit = known.unwrap_or_else(|| {
                let first = times.iter().flatten().next().copied().unwrap_or(0.0);
                let step = |turned: bool| {
                    let times = times.iter().flatten().copied();
                    if turned { usual_step(times.rev()) } else { usual_step(times) }
                };
                Unit::of_values(first, step(false).or(step(true)).unwrap_or(0.0))
            });
            times.iter_mut().flatten().for_each(|number| *number *= stamps.unit.seconds());
            if known.is_none() && stamps.unit != Unit::Seconds {
                let unit = stamps.unit.name();
                column.remarks.push(format!("Times are taken for {unit}; --time-unit says otherwise."));
            }
        }
        stamps.go_on(times);
        (stamps, column)
    }

    /// A clock that passes midnight, or has counted up to all that it can, goes on.
    fn go_on(&self, times: &mut [Option<f64>]) {
        let is_turned = is_newest_first(times.iter().flatten().copied());
        if is_turned {
            times.reverse();
        }
        let step = usual_step(times.iter().flatten().copied()).unwrap_or(0.0);
        let (mut passed, mut last) = (0.0, None);
        for time in times.iter_mut().flatten() {
            let shown = *time;
            passed += last.map_or(0.0, |last| self.period(last, shown, step));
            last = Some(shown);
            *time += passed;
        }
        if is_turned {
            times.reverse();
        }
    }

    /// What is added to the times from here on, where they fall back from one to another.
    fn period(&self, from: f64, to: f64, step: f64) -> f64 {
        let day = match self.form {
            _ if to >= from => return 0.0,
            Form::Clock => DAY,
            Form::Stopwatch => HOUR,
            Form::Number(_) => 0.0,
            _ => return 0.0,
        };
        if day > 0.0 {
            return if to < from - 0.5 * day { day } else { 0.0 };
        }
        let units = [self.unit.seconds(), 1e-3, 1e-6];
        let units = &units[..if self.unit == Unit::Seconds { 3 } else { 1 }];
        let wraps =
            units.iter().flat_map(|unit| BITS.iter().zip(LOST).map(move |(bits, lost)| (bits * unit, lost)));
        let passes = |(period, lost): &(f64, f64)| (0.0..lost * step).contains(&(to + period - from));
        wraps.into_iter().find(passes).map_or(0.0, |(period, _)| period)
    }

    /// The seconds of a cell.
    pub fn seconds(&self, cell: &str) -> Option<f64> {
        Some(self.form.seconds(cell)? * self.unit.seconds())
    }

    /// From one time to another where a sample comes each `step`, s: a clock passes midnight, begins at nought again, or is put back by an hour.
    pub fn between(&self, from: f64, to: f64, step: f64) -> f64 {
        let passed = to + self.period(from, to, step) - from;
        let is_winter =
            self.are_on_a_wall() && (passed + HOUR - step).abs() <= 1.5 * step && step < 0.1 * HOUR;
        if is_winter { passed + HOUR } else { passed }
    }

    /// The unit of times that are numbers.
    pub fn unit(&self) -> Option<Unit> {
        matches!(self.form, Form::Number(_)).then_some(self.unit)
    }

    /// The same where times that are numbers are in the unit that the name of their column says, if it says one.
    pub fn under(self, name: &str) -> Self {
        let unit = Unit::of_header(name).filter(|_| self.unit().is_some()).unwrap_or(self.unit);
        Self { unit, ..self }
    }

    /// Whether a clock on a wall shows them, which is put forward and back for summer time.
    pub(super) fn are_on_a_wall(&self) -> bool {
        self.form.is_on_a_wall()
    }
}

/// The form that reads most of the cells, and whether another reads as many in another way. Of dates it is the one by which least time has passed:
/// 3/4/2026 is followed by 4/4/2026 if the day comes first. Of clocks that begin at 0:00 it is a stopwatch.
fn best(found: Vec<(Form, Column)>) -> Option<(Form, Column, bool)> {
    let rank = |(form, column): &(Form, Column)| {
        let times = || column.values.iter().flatten().copied();
        let (low, high) =
            times().fold((f64::MAX, f64::MIN), |(low, high), time| (low.min(time), high.max(time)));
        let passed = if matches!(form, Form::Date(_)) { high - low } else { f64::MAX };
        let is_later = *form == Form::Clock && times().next() == Some(0.0);
        (column.values.len() - times().count(), passed, is_later)
    };
    let mut found = found.into_iter();
    let (mut best, mut is_doubtful) = (found.next()?, false);
    for other in found {
        let (theirs, ours) = (rank(&other), rank(&best));
        if theirs.0 > ours.0 || other.1.values == best.1.values {
            continue;
        }
        is_doubtful = theirs.0 == ours.0;
        if theirs.partial_cmp(&ours) == Some(std::cmp::Ordering::Less) {
            best = other;
        }
    }
    Some((best.0, best.1, is_doubtful))
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
        let times = Stamps::of(&table, 0, None)?.1.values;
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
            ("t", ["28 Mar 2026 22:00:00", "28 Mar 2026 22:00:00,500", "28 Mar 2026 22:00:01"]),
            ("t", ["Sat Mar 28 22:00:00 2026", "Sat Mar 28 22:00:00.5 2026", "Sat Mar 28 22:00:01 2026"]),
            (
                "t",
                [
                    "Sat, 28 Mar 2026 22:00:00 +0100",
                    "Sat, 28 Mar 2026 22:00:00.5 +0100",
                    "Sat, 28 Mar 2026 22:00:01 +0100",
                ],
            ),
            ("t", ["28/Mar/2026:23:59:59.5 CET", "29/Mar/2026:00:00:00 CET", "28/Mar/2026:23:00:00.5 GMT"]),
            ("t", ["28. März 2026 22:00:00", "28. März 2026 22:00:00,5", "28. März 2026 22:00:01"]),
            ("t", ["20260328220000", "20260328220000.5", "20260328220001"]),
            ("t", ["20260328T220000Z", "20260328T220000.5Z", "20260328T220001Z"]),
            ("t", ["28.3.2026 22.00.00", "28.3.2026 22.00.00,5", "28.3.2026 22.00.01"]),
            ("t", ["22:00:00:000", "22:00:00:500", "22:00:01:000"]),
            ("t", ["1 day, 0:00:00", "1 day, 0:00:00.5", "1 day, 0:00:01"]),
            ("t", ["59:59.5", "00:00.0", "00:00.5"]),
            ("t", ["PT10S", "PT10.5S", "PT11S"]),
            ("t", ["1000ms", "1500ms", "2000ms"]),
            ("t", ["4294966796", "0", "500"]),
            ("t", ["46109.916666667", "46109.916672454", "46109.916678241"]),
            ("t", ["639000000000000000", "639000000005000000", "639000000010000000"]),
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

    /// The order of a date is the one by which least time passes; where either would do, it is told.
    #[test]
    fn what_may_be_read_in_two_ways_is_told() {
        let told = |cells: &[&str]| {
            let table = Table::parse("f".into(), &format!("t;u\n{};1\n", cells.join(";1\n"))).unwrap();
            let (_, Column { values, remarks }) = Stamps::of(&table, 0, None).unwrap();
            (values[1].unwrap() - values[0].unwrap(), remarks.concat())
        };
        for (cells, step, said) in [
            (["03/04/2026 23:59:50", "04/04/2026 00:00:00"], 10.0, "day, month and year"),
            (["03/04/2026 23:59:50", "03/05/2026 00:00:00"], 10.0, "month, day and year"),
            (["03/04/2026 22:00:00", "03/04/2026 22:00:10"], 10.0, "month, day and year"),
            (["28/04/2026 22:00:00", "28/04/2026 22:00:10"], 10.0, ""),
            (["22:00", "22:01"], 60.0, "hours and minutes"),
            (["0:00", "0:01"], 1.0, "minutes and seconds"),
            (["23:59:59", "24:00:00"], 1.0, ""),
        ] {
            let (passed, told) = told(&cells);
            assert!(
                passed == step && told.contains(said) && told.is_empty() == said.is_empty(),
                "{cells:?}: {passed} {told}"
            );
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
