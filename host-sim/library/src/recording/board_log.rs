//! The log of a board as a table: what its thermistors read and what the heater got, tick by tick. It needs no whole log, as a replay does: what
//! is missing is a gap, and a start of the board is another session.

use std::fmt::Write as _;
use std::ops::Range;

use anyhow::Context;
use fdi_core::Config;
use firmware_logic::log_line::LogLine;
use pt326_lab::board::log::{Change, Start};
use pt326_lab::board::{readings, thermistors};

use crate::experiment::{as_written, tick_time};

/// Among so many lines a log has a record of a tick.
const LOOKED_AT: usize = 1000;
/// Columns of the table.
pub(super) const HEADER: &str = "board_s,t0_c,t1_c,t2_c,pa_pct";

/// A log as a table.
pub(super) struct Log {
    /// Lines of [`HEADER`] and one for each tick.
    pub(super) table: String,
    /// Rows from which the board learnt last what is normal; none where it did not, or not to the end.
    pub(super) learnt: Option<Range<usize>>,
    /// What must be known of it.
    pub(super) remark: Option<&'static str>,
}

/// The table of a log; `None` of what is none.
///
/// # Errors
/// The line of a log of another format, or with a setting that is not known here.
pub(super) fn table(text: &str) -> anyhow::Result<Option<Log>> {
    let is_tick = |line: &str| matches!(LogLine::find(line), Ok(Some(LogLine::Tick(_))));
    if !text.lines().take(LOOKED_AT).any(is_tick) {
        return Ok(None);
    }
    let mut table = format!("{HEADER}\n");
    let mut start = Start::new(Config::default());
    let mut measures = thermistors(&start.config)?;
    let (mut learnt, mut learning, mut rows) = (None, None, 0);
    let mut remark = Some(
        "The log does not begin with the start of the board: where that has other settings than the default, such as a calibration, they are not known.",
    );
    for (line, number) in text.lines().zip(1..) {
        // What is broken is missing.
        let Ok(Some(line)) = LogLine::find(line) else { continue };
        if let LogLine::Start { .. } = line {
            start = Start::new(Config::default());
            remark = remark.filter(|_| table.len() > HEADER.len() + 1);
        }
        start.line(line).with_context(|| format!("line {number}"))?;
        let is_first = start.heard == 1;
        let Some((changes, record)) = start.take() else { continue };
        if is_first {
            measures = thermistors(&start.config)?;
        }
        for change in changes {
            if let Change::Settings(config) = change {
                measures = thermistors(&config)?;
            }
        }
        let time = tick_time(record.tick(), as_written(start.config.sample_time.0));
        let _ = write!(table, "{time}");
        for celsius in readings(&record, &measures).into_iter().chain([record.applied().0]) {
            let _ = if celsius.is_finite() { write!(table, ",{celsius}") } else { write!(table, ",") };
        }
        table.push('\n');
        match record.readiness() {
            Some("training") => learning = learning.or(Some(rows)),
            Some("armed") => learnt = learning.take().map(|from| from..rows).or(learnt),
            _ => learning = None,
        }
        rows += 1;
    }
    Ok(Some(Log { table, learnt, remark }))
}

#[cfg(test)]
mod tests {
    use fdi_core::likelihood::Readiness::{self, Armed, Training, Untrained};
    use fdi_core::{Instrument, RawSample};
    use firmware_logic::control_loop::TickRecord;
    use firmware_logic::log_line::VERSION;
    use firmware_logic::log_line::tick::TickLine;

    use super::*;

    /// The rows that a board has learnt from by its log, with its readiness on each.
    fn learnt(readiness: &[Readiness]) -> Option<Range<usize>> {
        let mut instrument = Instrument::new(&Config::default()).unwrap();
        let mut log = format!("{}\n", LogLine::Start { version: VERSION });
        for readiness in readiness {
            let raw = RawSample::default();
            let tick = instrument.control(raw);
            let mut report = instrument.diagnose(&tick, tick.drive);
            report.likelihood.readiness = *readiness;
            let _ = writeln!(log, "{}", TickLine::new(&TickRecord::new(raw, tick, tick.drive), &report));
        }
        table(&log).unwrap().unwrap().learnt
    }

    #[test]
    fn what_a_board_has_learnt_last_and_to_the_end_counts() {
        assert_eq!(learnt(&[Untrained, Training, Training, Armed, Armed]), Some(1..3));
        assert_eq!(learnt(&[Training, Armed, Training, Training, Armed]), Some(2..4));
        assert_eq!(learnt(&[Training, Armed, Training, Untrained, Armed]), Some(0..1));
        assert_eq!(learnt(&[Untrained, Training, Training]), None);
    }
}
