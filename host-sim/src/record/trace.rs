//! `trace.csv` of a run; its columns are declared in `pt326-lab`, which writes the same of a session.

use std::io::Write;

pub use pt326_lab::trace::*;

use crate::experiment::Record;

/// Writes the trace of a run.
///
/// # Errors
/// Those of the writer.
pub fn write_trace(record: &Record, out: &mut impl Write) -> std::io::Result<()> {
    writeln!(out, "{}", header(COLUMNS.iter()))?;
    let mut line = String::new();
    for row in &record.rows {
        line.clear();
        let on = OneTick {
            tick: &row.tick,
            report: &row.report,
            truth: row.truth,
            sample_time: record.sample_time,
        };
        append_cells(&mut line, COLUMNS.iter(), &on);
        writeln!(out, "{line}")?;
    }
    Ok(())
}
