//! `trace.csv` of a run; its columns are declared in `pt326-lab`, which writes the same of a session.

use std::io::Write;

use fdi_core::schema::{COLUMNS, Moment};
pub use pt326_lab::trace::*;

use crate::experiment::Record;

/// Writes the trace of a run.
///
/// # Errors
/// Those of the writer.
pub fn write_trace(record: &Record, out: &mut impl Write) -> std::io::Result<()> {
    let tells_settings = !record.settings.is_empty();
    let mut line = header(COLUMNS.iter());
    if tells_settings {
        line = line + "," + SETTINGS;
    }
    writeln!(out, "{line}")?;
    let mut settings = record.settings.iter().peekable();
    for (k, row) in record.rows.iter().enumerate() {
        line.clear();
        let on = Moment { truth: row.truth, ..Moment::new(&row.tick, &row.report) };
        append_cells(&mut line, COLUMNS.iter(), &on, record.sample_time);
        if tells_settings {
            line += ",";
            line += settings.next_if(|(tick, _)| *tick == k).map_or("", |(_, told)| told);
        }
        writeln!(out, "{line}")?;
    }
    Ok(())
}
