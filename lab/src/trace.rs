//! `trace.csv`: one row a tick. Numbers are written so that reading them back gives the same bits; what is not defined
//! on a tick is left empty.

use std::fmt;
use std::fmt::Write as _;

use fdi_core::schema::{COLUMNS, Entry, Moment, Value};

use crate::time::tick_time;

/// Name of the column behind all others that a trace has where settings are not the defaults: what
/// [`Settings::take`](crate::change::Settings::take) gives for each row.
pub const SETTINGS: &str = "settings";

/// Name of the column with the number of the true fault, the only one that no instrument knows.
pub const TRUTH: &str = "truth";

/// What stands in the cell of a column on a tick, of so many s each.
pub fn cell(column: &Entry, on: &Moment, sample_time: f64) -> impl fmt::Display {
    Cell { value: column.number.value(on), sample_time }
}

struct Cell {
    value: Value,
    sample_time: f64,
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.value {
            Value::Float(Some(x)) if !x.is_nan() => x.fmt(f),
            Value::Reading(reading) => reading.celsius.0.fmt(f),
            Value::Count(Some(number)) | Value::Place(Some(number)) => number.fmt(f),
            Value::Judged(Some(number)) => number.fmt(f),
            Value::Tick(Some(tick)) => tick_time(tick, self.sample_time).fmt(f),
            Value::Named((_, name)) | Value::Choice(Some((_, name))) => f.write_str(name),
            Value::Float(_)
            | Value::Count(None)
            | Value::Place(None)
            | Value::Judged(None)
            | Value::Tick(None)
            | Value::Choice(None) => Ok(()),
        }
    }
}

/// The columns that an instrument can fill by itself: all but `truth`.
pub fn instrument_columns() -> impl Iterator<Item = &'static Entry> {
    COLUMNS.iter().filter(|column| column.name != TRUTH)
}

/// Names of some columns, with commas between.
pub fn header<'a>(columns: impl Iterator<Item = &'a Entry>) -> String {
    columns.map(|column| column.name).collect::<Vec<_>>().join(",")
}

/// Appends the cells of some columns to a line, with commas between.
pub fn append_cells<'a>(
    line: &mut String,
    columns: impl Iterator<Item = &'a Entry>,
    on: &Moment,
    sample_time: f64,
) {
    for (i, column) in columns.enumerate() {
        let comma = if i > 0 { "," } else { "" };
        let _ = write!(line, "{comma}{}", cell(column, on, sample_time));
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::likelihood::verdict::TaughtFinding;
    use fdi_core::likelihood::{FaultClass, LikelihoodReport, Magnitude};
    use fdi_core::name::Name;
    use fdi_core::{AdcCode, Config, Finding, Instrument, RawSample, Report};

    use super::*;

    #[test]
    fn the_likelihood_columns_say_what_was_found_or_nothing() {
        let mut instrument = Instrument::new(&Config::default()).unwrap();
        let code = AdcCode(2160.0);
        let tick = instrument.control(RawSample { t0: code, t1: code, t2: code, ..RawSample::default() });
        let report = instrument.diagnose(&tick, tick.drive);
        let cells = |likelihood: &LikelihoodReport| {
            let mut line = String::new();
            let report = Report { likelihood: *likelihood, ..report.clone() };
            let of_it =
                ["alarm", "verdict", "confidence", "magnitude", "magnitude_unit", "onset_s", "taught"];
            let columns = COLUMNS.iter().filter(|column| of_it.contains(&column.name));
            append_cells(&mut line, columns, &Moment::new(&tick, &report), 0.11);
            line
        };
        assert_eq!(cells(&LikelihoodReport::default()), "0,,,,,,");
        let finding = Finding {
            class: FaultClass::T2Offset,
            confidence: 0.75,
            magnitude: Some(Magnitude { value: -1.5, half_width: 0.25 }),
            onset: 100,
        };
        let magnitude = Magnitude { value: 90.0, half_width: 5.0 };
        let taught = Some(TaughtFinding { name: Name::NONE, place: 2, confidence: 0.96, magnitude });
        let found =
            LikelihoodReport { alarm: true, finding: Some(finding), taught, ..LikelihoodReport::default() };
        assert_eq!(cells(&found), "1,t2_offset,0.75,-1.5,degC,11,3");
        let unknown = Finding { class: FaultClass::Unknown, magnitude: None, ..finding };
        let found = LikelihoodReport { finding: Some(unknown), ..found };
        assert_eq!(cells(&found), "1,unknown,0.75,,,11,3");
    }
}
