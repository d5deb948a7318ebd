//! `trace.csv`: one row a tick. Numbers are written so that reading them back gives the same bits; what is not defined
//! on a tick is left empty.

use std::fmt::Write as _;

use fdi_core::diagnosis::Verdict;
use fdi_core::diagnosis::residual::{DECISIVE, Residual};
use fdi_core::likelihood::{Finding, Magnitude};
use fdi_core::{Report, Tick};

use crate::time::tick_time;

/// Every column, in its order. To add one is to add a line here; it comes last, so that programs which read an older
/// trace by position find the others where they were.
pub static COLUMNS: [Column; 49] = [
    column("t_s", |on| on.time(on.tick.index).into()),
    column("t0_c", |on| on.tick.sample.t0.celsius.0.into()),
    column("t1_c", |on| on.tick.sample.t1.celsius.0.into()),
    column("t2_c", |on| on.tick.sample.t2.celsius.0.into()),
    column("setpoint_c", |on| on.tick.setpoint.0.into()),
    column("u_pid_pct", |on| on.tick.pid.0.into()),
    column("prbs_pct", |on| on.tick.prbs.0.into()),
    column("pa_pct", |on| on.tick.drive.0.into()),
    column("y1_c", |on| on.report.y1.into()),
    column("y2_c", |on| on.report.y2.into()),
    column("y1m_c", |on| on.report.ms1.prediction.into()),
    column("y2m_c", |on| on.report.ms2.prediction.into()),
    column("sg1", |on| on.report.ms1.static_gain.into()),
    column("sg2", |on| on.report.ms2.static_gain.into()),
    column("bw1", |on| on.report.ms1.bandwidth.into()),
    // ry1 and ry2 exist before the other residuals do.
    column("ry1", |on| difference(on.report.y1, on.report.ms1.prediction)),
    column("ry2", |on| difference(on.report.y2, on.report.ms2.prediction)),
    column("rap", |on| on.residual(Residual::Rap)),
    column("ry12", |on| on.residual(Residual::Ry12)),
    column("rsg1", |on| on.residual(Residual::Rsg1)),
    column("rsg2", |on| on.residual(Residual::Rsg2)),
    column("rbw1", |on| on.residual(Residual::Rbw1)),
    // They have no mean to subtract, either.
    column("ry1_f", |on| on.report.features_filtered.map(|f| f[Residual::Ry1 as usize]).into()),
    column("ry2_f", |on| on.report.features_filtered.map(|f| f[Residual::Ry2 as usize]).into()),
    column("rap_f", |on| on.filtered(Residual::Rap)),
    column("ry12_f", |on| on.filtered(Residual::Ry12)),
    column("rsg1_f", |on| on.filtered(Residual::Rsg1)),
    column("rsg2_f", |on| on.filtered(Residual::Rsg2)),
    column("rbw1_f", |on| on.filtered(Residual::Rbw1)),
    column("s_rap", |on| on.symptom(Residual::Rap)),
    column("s_ry12", |on| on.symptom(Residual::Ry12)),
    column("s_rsg1", |on| on.symptom(Residual::Rsg1)),
    column("s_rsg2", |on| on.symptom(Residual::Rsg2)),
    column("s_rbw1", |on| on.symptom(Residual::Rbw1)),
    column("fdv", |on| on.report.filtered.map(|v: Verdict| v.fdv).into()),
    column("fiv", |on| on.report.filtered.map(|v| v.fiv).into()),
    column("fdv_raw", |on| on.report.raw.map(|v| v.fdv).into()),
    column("fiv_raw", |on| on.report.raw.map(|v| v.fiv).into()),
    column("mode", |on| on.tick.mode.name().into()),
    column(TRUTH, |on| on.truth.into()),
    column("alarm", |on| u8::from(on.report.likelihood.alarm).into()),
    column("verdict", |on| on.finding().map(|f| f.class.name()).into()),
    column("confidence", |on| on.finding().map(|f| f.confidence).into()),
    column("magnitude", |on| on.magnitude().map(|(_, m)| m.value).into()),
    column("magnitude_unit", |on| on.magnitude().map(|(f, _)| f.class.unit()).into()),
    column("onset_s", |on| on.finding().map(|f| on.time(f.onset)).into()),
    // What is known of the rig's other inputs: share of the nominal voltage, and % of the usual level.
    column("supply", |on| on.tick.known.supply.into()),
    column("fan_pct", |on| on.tick.known.fan.map(|level| level.0).into()),
    // Place, from 1, of the fault of the user's own that the likelihood diagnosis sees.
    column("taught", |on| on.report.likelihood.taught.map(|taught| taught.place + 1).into()),
];

/// Name of the column behind all others that a trace has where settings are not the defaults: what
/// [`Settings::take`](crate::change::Settings::take) gives for each row.
pub const SETTINGS: &str = "settings";

/// Name of the column with the number of the true fault, the only one that no instrument knows.
pub const TRUTH: &str = "truth";

/// A column.
pub struct Column {
    /// Name in the header.
    pub name: &'static str,
    /// What stands in it on a tick.
    pub value: fn(&OneTick) -> Value,
}

const fn column(name: &'static str, value: fn(&OneTick) -> Value) -> Column {
    Column { name, value }
}

/// What a row is made of.
#[derive(Clone, Copy, Debug)]
pub struct OneTick<'a> {
    /// First half of the tick.
    pub tick: &'a Tick,
    /// Second half of the tick.
    pub report: &'a Report,
    /// Number of the fault that acts; 0 for none.
    pub truth: u8,
    /// Ts in s.
    pub sample_time: f64,
}

impl OneTick<'_> {
    fn time(&self, tick: u32) -> f64 {
        tick_time(tick, self.sample_time)
    }

    fn residual(&self, residual: Residual) -> Value {
        self.report.residuals.map(|r| r[residual as usize]).into()
    }

    fn filtered(&self, residual: Residual) -> Value {
        self.report.residuals_filtered.map(|r| r[residual as usize]).into()
    }

    fn symptom(&self, residual: Residual) -> Value {
        let place = DECISIVE.iter().position(|decisive| *decisive == residual);
        self.report.filtered.zip(place).map(|(verdict, i)| verdict.symptoms[i].sign()).into()
    }

    fn finding(&self) -> Option<Finding> {
        self.report.likelihood.finding
    }

    fn magnitude(&self) -> Option<(Finding, Magnitude)> {
        self.finding().and_then(|finding| Some((finding, finding.magnitude?)))
    }
}

fn difference(a: Option<f32>, b: Option<f32>) -> Value {
    a.zip(b).map(|(a, b)| a - b).into()
}

/// What stands in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Not defined on this tick.
    Empty,
    /// A number of the instrument.
    Single(f32),
    /// A time, s.
    Double(f64),
    /// A flag, a sign, the number of a fault.
    Whole(i16),
    /// A name.
    Word(&'static str),
}

impl From<f32> for Value {
    fn from(x: f32) -> Self {
        Self::Single(x)
    }
}

impl From<f64> for Value {
    fn from(x: f64) -> Self {
        Self::Double(x)
    }
}

impl From<u8> for Value {
    fn from(x: u8) -> Self {
        Self::Whole(x.into())
    }
}

impl From<i8> for Value {
    fn from(x: i8) -> Self {
        Self::Whole(x.into())
    }
}

impl From<&'static str> for Value {
    fn from(word: &'static str) -> Self {
        Self::Word(word)
    }
}

impl<T: Into<Value>> From<Option<T>> for Value {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Empty => Ok(()),
            Self::Single(x) if x.is_nan() => Ok(()),
            Self::Single(x) => x.fmt(f),
            Self::Double(x) => x.fmt(f),
            Self::Whole(x) => x.fmt(f),
            Self::Word(word) => f.write_str(word),
        }
    }
}

/// The columns that an instrument can fill by itself: all but `truth`.
pub fn instrument_columns() -> impl Iterator<Item = &'static Column> {
    COLUMNS.iter().filter(|column| column.name != TRUTH)
}

/// Names of some columns, with commas between.
pub fn header<'a>(columns: impl Iterator<Item = &'a Column>) -> String {
    columns.map(|column| column.name).collect::<Vec<_>>().join(",")
}

/// Appends the cells of some columns to a line, with commas between.
pub fn append_cells<'a>(line: &mut String, columns: impl Iterator<Item = &'a Column>, on: &OneTick) {
    for (i, column) in columns.enumerate() {
        let comma = if i > 0 { "," } else { "" };
        let _ = write!(line, "{comma}{}", (column.value)(on));
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::likelihood::verdict::TaughtFinding;
    use fdi_core::likelihood::{FaultClass, LikelihoodReport};
    use fdi_core::name::Name;
    use fdi_core::{AdcCode, Config, Instrument, RawSample};

    use super::*;

    #[test]
    fn no_two_columns_have_one_name() {
        for (i, column) in COLUMNS.iter().enumerate() {
            assert!(COLUMNS[..i].iter().all(|other| other.name != column.name), "{}", column.name);
        }
    }

    #[test]
    fn the_likelihood_columns_say_what_was_found_or_nothing() {
        let mut instrument = Instrument::new(&Config::default()).unwrap();
        let code = AdcCode(2160.0);
        let tick = instrument.control(RawSample { t0: code, t1: code, t2: code, ..RawSample::default() });
        let report = instrument.diagnose(&tick, tick.drive);
        let cells = |likelihood: &LikelihoodReport| {
            let mut line = String::new();
            let report = Report { likelihood: *likelihood, ..report.clone() };
            let columns = COLUMNS.iter().skip_while(|column| column.name != "alarm");
            append_cells(
                &mut line,
                columns,
                &OneTick { tick: &tick, report: &report, truth: 0, sample_time: 0.11 },
            );
            line
        };
        assert_eq!(cells(&LikelihoodReport::default()), "0,,,,,,,,");
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
        assert_eq!(cells(&found), "1,t2_offset,0.75,-1.5,degC,11,,,3");
        let unknown = Finding { class: FaultClass::Unknown, magnitude: None, ..finding };
        let found = LikelihoodReport { finding: Some(unknown), ..found };
        assert_eq!(cells(&found), "1,unknown,0.75,,,11,,,3");
    }
}
