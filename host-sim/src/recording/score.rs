//! How well the faults of a recording were seen: alarm, name, size, end, and alarms where nothing was wrong.

use fdi_core::FaultClass;
use serde::Serialize;

use crate::experiment::Record;
use crate::score::expectation::{Expectation, is_right, size_as};

/// How a fault was seen. Times are since its onset, s; none: never while it acted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Seen {
    /// What it was.
    pub fault: String,
    /// Onset, s.
    pub at: f64,
    /// Duration, s.
    pub duration: f64,
    /// First alarm, and the first tick that names it rightly.
    pub alarmed: Option<f64>,
    /// The same of its name.
    pub named: Option<f64>,
    /// The name that was said last while it acted.
    pub said: Option<&'static str>,
    /// Its size as said last under the right name, in that class's unit, and as it truly was.
    pub size: Option<f64>,
    /// The same, true.
    pub size_true: Option<f64>,
    /// How long an alarm stood after its end, s; none: until the end of the record or the next fault.
    pub tail: Option<f64>,
}

/// How well a recording was diagnosed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Each fault.
    pub faults: Vec<Seen>,
    /// Alarms raised while nothing was wrong.
    pub false_alarms: u32,
    /// When each of these was raised, s.
    pub false_alarms_at: Vec<f64>,
    /// Time that was watched, s.
    pub watched: f64,
}

/// Scores what was watched from a time on, s; `record` holds its faults.
pub fn score(record: &Record, from: f64) -> Score {
    let rows = || record.rows.iter().filter(|row| record.time(row.tick.index) >= from);
    let acts = |t: f64| record.faults.iter().any(|fault| fault.is_active(t));
    let mut false_alarms_at = Vec::new();
    let mut was = false;
    for row in rows() {
        let (t, alarm) = (record.time(row.tick.index), row.report.likelihood.alarm);
        if alarm && !was && !acts(t) {
            false_alarms_at.push(t);
        }
        was = alarm;
    }
    let faults = record.faults.iter().filter(|fault| fault.at >= from).map(|fault| {
        let right: Vec<FaultClass> = Expectation::of(fault).class.into_iter().collect();
        let during = || rows().filter(|row| fault.is_active(record.time(row.tick.index)));
        let since = |row: &crate::experiment::Row| record.time(row.tick.index) - fault.at;
        let name =
            |row: &crate::experiment::Row| row.report.likelihood.finding.map(|finding| finding.class.name());
        let is_right = |row: &&crate::experiment::Row| name(row).is_some_and(|name| is_right(&right, name));
        let last = during().rfind(is_right);
        let finding = last.and_then(|row| row.report.likelihood.finding);
        let after = rows().find(|row| {
            let t = record.time(row.tick.index);
            t >= fault.end() && (acts(t) || !row.report.likelihood.alarm)
        });
        let tail =
            after.map(|row| record.time(row.tick.index)).filter(|t| !acts(*t)).map(|t| t - fault.end());
        Seen {
            fault: fault.label(),
            at: fault.at,
            duration: fault.duration,
            alarmed: during().find(|row| row.report.likelihood.alarm).map(since),
            named: during().find(is_right).map(since),
            said: during().rev().find_map(name),
            size: finding.and_then(|finding| finding.magnitude).map(|m| f64::from(m.value)),
            size_true: right.first().and_then(|class| size_as(fault, *class, fault.at)),
            tail,
        }
    });
    Score {
        faults: faults.collect(),
        false_alarms: false_alarms_at.len() as u32,
        false_alarms_at,
        watched: record.end() - from,
    }
}

/// The score as a table, with a line end.
pub fn table(score: &Score) -> String {
    let time = |t: Option<f64>| t.map_or("never".into(), |t| format!("{:.3} s", t).replace(".000 s", " s"));
    let number = |x: Option<f64>| x.map_or("-".into(), |x| format!("{x:.1}"));
    let head = ["Fault", "onset", "alarm", "named", "said last", "size", "true", "alarm after"];
    let rows = score.faults.iter().map(|seen| {
        [
            seen.fault.clone(),
            format!("{:.1} s", seen.at),
            time(seen.alarmed),
            time(seen.named),
            seen.said.unwrap_or("-").to_owned(),
            number(seen.size),
            number(seen.size_true),
            seen.tail.map_or("-".into(), |t| time(Some(t))),
        ]
    });
    let line = |cells: [String; 8]| {
        let [fault, cells @ ..] = cells;
        let cells: String = cells.iter().map(|cell| format!(" {cell:>12}")).collect();
        format!("{fault:<20}{cells}\n")
    };
    let rows: String = std::iter::once(head.map(str::to_owned)).chain(rows).map(line).collect();
    let at: Vec<String> = score.false_alarms_at.iter().take(10).map(|t| format!("{t:.1}")).collect();
    let at = if at.is_empty() { String::new() } else { format!(" (at {} s)", at.join(", ")) };
    format!("{rows}Alarms while nothing was wrong: {}{at} in {:.0} s\n", score.false_alarms, score.watched)
}
