//! How well the faults of a recording were seen: alarm, name, size, end, and alarms where nothing was wrong.

use fdi_core::FaultClass;
use pt326_rig::fault::Fault;
use serde::Serialize;

use crate::experiment::{Record, Row};
use crate::score::expectation::{Expectation, is_right, size_as};

/// How a fault was seen. Times are since its onset, s; none: never while it acted. An alarm that stood before it says nothing of it, until it ends or
/// takes a right name that it did not have.
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
    /// How long an alarm stood after its end, s; none: the record or the next fault leaves no time to see.
    pub tail: Option<f64>,
    /// The alarm did not end before the record or the next fault did.
    pub endless: bool,
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
    let faults = record.faults.iter().filter(|fault| fault.at >= from).map(|fault| seen(record, fault));
    Score {
        faults: faults.collect(),
        false_alarms: false_alarms_at.len() as u32,
        false_alarms_at,
        watched: record.end() - from,
    }
}

fn seen(record: &Record, fault: &Fault) -> Seen {
    let time = |row: &Row| record.time(row.tick.index);
    let right: Vec<FaultClass> = Expectation::of(fault).class.into_iter().collect();
    let name = |row: &Row| row.report.likelihood.finding.map(|finding| finding.class.name());
    let names_it = |row: &Row| name(row).is_some_and(|name| is_right(&right, name));
    let onset = record.rows.partition_point(|row| time(row) < fault.at);
    let end = record.rows.partition_point(|row| time(row) < fault.end());
    let before = onset.checked_sub(1).map(|k| &record.rows[k]);
    let mut stands = before.is_some_and(|row| row.report.likelihood.alarm);
    let of_it = |row: &&Row| {
        stands &= row.report.likelihood.alarm && !(names_it(row) && name(row) != before.and_then(name));
        !stands
    };
    let of_it: Vec<&Row> = record.rows[onset..end].iter().filter(of_it).collect();
    let since = |row: &&Row| time(row) - fault.at;
    let last = of_it.iter().rfind(|row| names_it(row)).and_then(|row| row.report.likelihood.finding);
    let is_over = |row: &&Row| {
        !row.report.likelihood.alarm || record.faults.iter().any(|fault| fault.is_active(time(row)))
    };
    let over = record.rows[end..].iter().find(is_over);
    let tail = over.map_or(record.end(), time) - fault.end();
    let endless = tail > 0.0
        && over.is_none_or(|row| {
            row.report.likelihood.alarm || record.faults.iter().any(|fault| fault.is_active(time(row)))
        });
    Seen {
        fault: fault.label(),
        at: fault.at,
        duration: fault.duration,
        alarmed: of_it.iter().find(|row| row.report.likelihood.alarm).map(since),
        named: of_it.iter().find(|row| names_it(row)).map(since),
        said: of_it.iter().rev().find_map(|row| name(row)),
        size: last.and_then(|finding| finding.magnitude).map(|m| f64::from(m.value)),
        size_true: right.first().and_then(|class| size_as(fault, *class, fault.at)),
        tail: over.map(|_| tail).or((tail > 0.0).then_some(tail)),
        endless,
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
            seen.tail
                .map_or("-".into(), |t| if seen.endless { "> " } else { "" }.to_owned() + &time(Some(t))),
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

#[cfg(test)]
mod tests {
    use fdi_core::{Config, Finding};
    use pt326_rig::fault::{Sensor, Verb};

    use super::*;
    use crate::experiment::scenario::Scenario;
    use crate::experiment::{Origin, run};

    /// Two offsets of T1, at 2 and 6 s for 2 s, in 12 s of samples on which there is an alarm, under a name, or none.
    fn scored(says: impl Fn(f64) -> Option<FaultClass>) -> Score {
        let scenario = Scenario { duration: 12.0, faults: vec![], ..Scenario::default() };
        let rows = run(&Config::default(), &scenario, 1).unwrap().rows;
        let offset = |at| Fault::new(Verb::Offset, Some(Sensor::T1), Some(5.0), at, 2.0);
        let origin = Origin::Watched { file: "f".into() };
        let mut record = Record::new(origin, &Config::default(), &[offset(2.0), offset(6.0)], rows, None);
        let sample_time = record.sample_time;
        for row in &mut record.rows {
            let said = says(sample_time * f64::from(row.tick.index));
            row.report.likelihood.alarm = said.is_some();
            row.report.likelihood.finding =
                said.map(|class| Finding { class, confidence: 0.9, magnitude: None, onset: 0 });
        }
        score(&record, 0.0)
    }

    #[test]
    fn an_alarm_that_is_left_over_is_no_detection_and_one_without_end_is_told() {
        let stays = scored(|t| (t >= 3.0).then_some(FaultClass::T1Offset));
        let [first, second] = stays.faults.as_slice() else { panic!("{stays:?}") };
        assert!(first.alarmed.is_some() && first.named.is_some() && first.endless, "{first:?}");
        assert!(first.tail.is_some_and(|tail| (tail - 2.0).abs() < 0.12), "{first:?}");
        assert_eq!((second.alarmed, second.named, second.said), (None, None, None));
        assert!(second.endless && second.tail.is_some_and(|tail| tail > 3.5), "{second:?}");
        assert!(table(&stays).contains("> "), "{}", table(&stays));
    }

    #[test]
    fn an_alarm_that_takes_the_right_name_or_comes_again_is_one() {
        let renamed = scored(|t| match t {
            7.0..8.5 => Some(FaultClass::T1Offset),
            3.0..7.0 => Some(FaultClass::HeaterPower),
            _ => None,
        });
        let [first, second] = renamed.faults.as_slice() else { panic!("{renamed:?}") };
        assert!(first.alarmed.is_some() && first.named.is_none());
        assert!(
            second.alarmed == second.named && second.alarmed.is_some_and(|t| (t - 1.0).abs() < 0.12),
            "{second:?}"
        );
        assert!(!second.endless && second.tail.is_some_and(|tail| tail < 0.7), "{second:?}");
        let again =
            scored(|t| ((2.5..6.5).contains(&t) || (7.0..8.0).contains(&t)).then_some(FaultClass::T1Offset));
        assert!(again.faults[1].alarmed.is_some_and(|t| (t - 1.0).abs() < 0.12), "{again:?}");
        let quiet = scored(|_| None);
        assert!(
            quiet.faults.iter().all(|seen| seen.tail.is_some_and(|tail| tail < 0.11) && !seen.endless),
            "{quiet:?}"
        );
    }
}
