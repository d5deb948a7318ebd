//! `trace.csv`: one row a tick. Numbers are written so that reading them back gives the same bits; what is not defined
//! on a tick is left empty.

use std::fmt::Write as _;
use std::io::Write;

use fdi_core::diagnosis::Verdict;
use fdi_core::diagnosis::residual::{DECISIVE, RESIDUALS};
use fdi_core::likelihood::LikelihoodReport;
use fdi_core::{Report, Tick};

use crate::experiment::{Record, tick_time};

/// Columns from the time to the mode: what an instrument says on a tick.
pub const INSTRUMENT_COLUMNS: &str = "t_s,t0_c,t1_c,t2_c,setpoint_c,u_pid_pct,prbs_pct,pa_pct,y1_c,y2_c,y1m_c,y2m_c,sg1,sg2,bw1,\
ry1,ry2,rap,ry12,rsg1,rsg2,rbw1,ry1_f,ry2_f,rap_f,ry12_f,rsg1_f,rsg2_f,rbw1_f,\
s_rap,s_ry12,s_rsg1,s_rsg2,s_rbw1,fdv,fiv,fdv_raw,fiv_raw,mode";

/// Columns of the likelihood diagnosis. They come last, so that readers of older traces find every column where it was.
pub const LIKELIHOOD_COLUMNS: &str = "alarm,verdict,confidence,magnitude,magnitude_unit,onset_s";

/// Writes the trace of a run.
///
/// # Errors
/// Those of the writer.
pub fn write_trace(record: &Record, out: &mut impl Write) -> std::io::Result<()> {
    writeln!(out, "{INSTRUMENT_COLUMNS},truth,{LIKELIHOOD_COLUMNS}")?;
    let mut line = String::new();
    for row in &record.rows {
        line.clear();
        instrument_row(&mut line, &row.tick, &row.report, record.sample_time);
        let _ = write!(line, ",{}", row.truth);
        likelihood_row(&mut line, &row.report.likelihood, record.sample_time);
        writeln!(out, "{line}")?;
    }
    Ok(())
}

/// Appends the columns of [`INSTRUMENT_COLUMNS`] to `line`, without a line end.
pub fn instrument_row(line: &mut String, tick: &Tick, report: &Report, sample_time: f64) {
    let _ = write!(line, "{}", tick_time(tick.index, sample_time));
    let sample = &tick.sample;
    for celsius in [sample.t0.celsius, sample.t1.celsius, sample.t2.celsius, tick.setpoint] {
        number(line, Some(celsius.0));
    }
    for percent in [tick.pid, tick.prbs, tick.drive] {
        number(line, Some(percent.0));
    }
    for y in [report.y1, report.y2, report.ms1.prediction, report.ms2.prediction] {
        number(line, y);
    }
    for feature in [report.ms1.static_gain, report.ms2.static_gain, report.ms1.bandwidth] {
        number(line, feature);
    }
    for i in 0..2 {
        number(line, output_residual(report, i));
    }
    for i in 2..RESIDUALS {
        number(line, report.residuals.map(|r| r[i]));
    }
    for i in 0..2 {
        number(line, report.features_filtered.map(|f| f[i])); // ry1 and ry2 have no nominal value to subtract
    }
    for i in 2..RESIDUALS {
        number(line, report.residuals_filtered.map(|r| r[i]));
    }
    for i in 0..DECISIVE.len() {
        number(line, report.filtered.map(|v| v.symptoms[i].sign()));
    }
    let vectors = |v: Verdict| (v.fdv, v.fiv);
    for verdict in [report.filtered, report.raw] {
        let verdict = verdict.map(vectors);
        number(line, verdict.map(|v| v.0));
        number(line, verdict.map(|v| v.1));
    }
    let _ = write!(line, ",{}", tick.mode.name());
}

/// Appends the columns of [`LIKELIHOOD_COLUMNS`] to `line`, each behind a comma.
pub fn likelihood_row(line: &mut String, likelihood: &LikelihoodReport, sample_time: f64) {
    number(line, Some(u8::from(likelihood.alarm)));
    let finding = likelihood.finding;
    number(line, finding.map(|f| f.class.name()));
    number(line, finding.map(|f| f.confidence));
    let magnitude = finding.and_then(|f| f.magnitude);
    number(line, magnitude.map(|m| m.value));
    number(line, finding.zip(magnitude).map(|(f, _)| f.class.unit()));
    number(line, finding.map(|f| tick_time(f.onset, sample_time)));
}

/// ry1 or ry2, which exist before the other features do.
fn output_residual(report: &Report, i: usize) -> Option<f32> {
    match i {
        0 => Some(report.y1? - report.ms1.prediction?),
        _ => Some(report.y2? - report.ms2.prediction?),
    }
}

fn number(line: &mut String, x: Option<impl std::fmt::Display>) {
    line.push(',');
    if let Some(x) = x {
        let _ = write!(line, "{x}");
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::likelihood::{FaultClass, Finding, Magnitude};

    use super::*;

    #[test]
    fn the_likelihood_columns_say_what_was_found_or_nothing() {
        let row = |likelihood: &LikelihoodReport| {
            let mut line = String::new();
            likelihood_row(&mut line, likelihood, 0.11);
            line
        };
        assert_eq!(row(&LikelihoodReport::default()), ",0,,,,,");
        let finding = Finding {
            class: FaultClass::T2Offset,
            confidence: 0.75,
            magnitude: Some(Magnitude { value: -1.5, half_width: 0.25 }),
            onset: 100,
        };
        let found = LikelihoodReport { alarm: true, finding: Some(finding), ..LikelihoodReport::default() };
        assert_eq!(row(&found), ",1,t2_offset,0.75,-1.5,degC,11");
        let unknown = Finding { class: FaultClass::Unknown, magnitude: None, ..finding };
        let found = LikelihoodReport { finding: Some(unknown), ..found };
        assert_eq!(row(&found), ",1,unknown,0.75,,,11");
    }
}
