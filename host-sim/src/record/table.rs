//! The table that a run prints.

use std::fmt::Write;

use fdi_core::diagnosis::event::Event;

use crate::experiment::{Origin, Record};
use crate::record::summary::{FaultSummary, Summary, sentence};
use crate::score::Score;

/// The paper's own figures: fault, detection delay, indicated duration (sections 4.3 and 4.4).
pub const PAPER: [(&str, f64, f64); 3] = [("AFS2", 2.0, 27.0), ("MFS1", 2.0, 14.0), ("MFP", 2.0, 27.0)];

/// Largest control error that the paper reports, % of the set-point (section 4.1).
pub const PAPER_CONTROL_ERROR: f64 = 4.3;

/// The whole table, with a line end.
pub fn of_run(record: &Record, summary: &Summary) -> String {
    let mut text = String::new();
    let s = summary;
    let duration = record.rows.len() as f64 * s.ts_s;
    let _ = writeln!(text, "PT-326 fault diagnosis: {duration:.0} s {}", record.origin);
    let _ = writeln!(text);
    faults(&mut text, &s.faults);
    verdicts(&mut text, &s.faults);
    if s.faults.is_empty() {
        events(&mut text, record);
    }
    let _ = writeln!(text);
    let _ = writeln!(
        text,
        "Largest control error  {:.2} % of the set-point ({:.2} degC)   paper {PAPER_CONTROL_ERROR} %",
        s.control_error_max_pct, s.control_error_max_c
    );
    let f = &s.false_alarms;
    let _ = writeln!(
        text,
        "{:<22} fdv {}, fiv {} (low-passed)   fdv {}, fiv {} (raw)   likelihood {}",
        if matches!(record.origin, Origin::Recorded { .. }) && s.faults.is_empty() {
            "Alarms"
        } else {
            "False alarms"
        },
        f.fdv,
        f.fiv,
        f.fdv_raw,
        f.fiv_raw,
        f.likelihood
    );
    if s.baseline.is_none() {
        let _ = writeln!(text, "No baseline learnt     {}", why_not_learnt(record));
    }
    if let Some(w) = &s.without_t1 {
        let _ = writeln!(
            text,
            "Without T1             {:.1} s by T2 and the models: {:.2} degC off in the mean, {:.2} at most",
            w.duration_s, w.error_mean_c, w.error_max_c
        );
    }
    for trip in &s.trips {
        let _ = writeln!(
            text,
            "TRIPPED                at {:.2} s: {:?}; T1 {}, expected {:.1} degC; T2 {}; heater off until acknowledged",
            trip.t_s, trip.reason, trip.t1, trip.setpoint_c, trip.t2
        );
    }
    for (t, reason) in &record.refused {
        let _ = writeln!(text, "Refused                at {t:.2} s: {reason}");
    }
    text
}

/// What both diagnoses said happened, where there is no truth to hold it against.
fn events(text: &mut String, record: &Record) {
    let mut named = None;
    let mut alarm = false;
    for row in &record.rows {
        for event in &row.report.events {
            signature_event(text, record, event);
        }
        let likelihood = &row.report.likelihood;
        let t = record.time(row.tick.index);
        if let Some(finding) = likelihood.finding.filter(|finding| named != Some(finding.class)) {
            let _ = writeln!(text, "{t:>9.2} s  likelihood: {}", sentence(record, row, &finding));
        }
        if alarm && !likelihood.alarm {
            let _ = writeln!(text, "{t:>9.2} s  likelihood: all is as expected again");
        }
        named = likelihood.finding.map(|finding| finding.class);
        alarm = likelihood.alarm;
    }
}

fn signature_event(text: &mut String, record: &Record, event: &Event) {
    let (what, fault, at) = match event {
        Event::Detected(fault) => ("detected", fault, fault.detected),
        Event::Isolated(fault) => ("isolated", fault, fault.isolated.unwrap_or(fault.detected)),
        Event::Ended(fault) => ("ended", fault, fault.last_seen),
    };
    let _ = writeln!(
        text,
        "{:>9.2} s  {what}: fdv {}, fiv {}, since about {:.2} s",
        record.time(at),
        fault.detection_number,
        fault.isolation_number,
        record.time(fault.onset)
    );
}

/// One line a fault and form, the paper's own beside it.
fn faults(text: &mut String, faults: &[FaultSummary]) {
    if faults.is_empty() {
        let _ = writeln!(text, "Nothing is known to have been done to the rig.");
        return;
    }
    let _ = writeln!(
        text,
        "Fault             onset      detected at (delay)    isolated at (delay)    indicated / true   paper"
    );
    for fault in faults {
        let paper = PAPER.iter().find(|(name, ..)| *name == fault.name);
        let paper = paper.map_or(String::from("-"), |(_, delay, span)| format!("{delay} s, {span} s"));
        line(text, &fault.name, fault, &fault.signature, &paper);
        line(text, "  raw residuals", fault, &fault.signature_raw, "");
        line(text, "  likelihood", fault, &fault.likelihood.score, "");
    }
}

/// What the likelihood diagnosis said of each fault, and how far that is from the truth.
fn verdicts(text: &mut String, faults: &[FaultSummary]) {
    if faults.iter().all(|fault| fault.likelihood.verdict.is_none()) {
        return;
    }
    let _ = writeln!(
        text,
        "\nWhat the likelihood diagnosis said at the end of each fault (with 95 % intervals), and the truth\n"
    );
    for fault in faults {
        let p = &fault.likelihood;
        let told = fault.likelihood_told.as_deref().unwrap_or("it was never named");
        let _ = writeln!(text, "{:<15} {told}", fault.name);
        let mut truth = Vec::new();
        truth.extend(p.magnitude_true.zip(p.magnitude_unit).map(|(x, unit)| format!("true {x} {unit}")));
        truth.extend(p.onset_error_s.map(|t| match t {
            ..0.0 => format!("onset dated {:.2} s too early", -t),
            _ => format!("onset dated {t:.2} s too late"),
        }));
        truth.extend(
            p.first_verdict
                .filter(|_| p.first_verdict_right == Some(false))
                .map(|first| format!("first taken for {first}")),
        );
        if !truth.is_empty() {
            let _ = writeln!(text, "{:<15} ({})", "", truth.join(", "));
        }
    }
}

fn line(text: &mut String, name: &str, fault: &FaultSummary, score: &Score, paper: &str) {
    let detected = moment(score.detected_s, score.detection_delay_s);
    let isolated = moment(score.isolated_s, score.isolation_delay_s);
    let indicated = score.indicated_duration_s.map_or("-".into(), |d| format!("{d:.1}"));
    let _ = writeln!(
        text,
        "{name:<15} {:>7.1} s   {detected:<20}   {isolated:<20}   {indicated:>6} / {:<5.1} s   {paper}",
        fault.onset_s, fault.duration_s
    );
}

fn moment(at: Option<f64>, delay: Option<f64>) -> String {
    match (at, delay) {
        (Some(at), Some(delay)) => format!("{at:.2} s ({delay:.2} s)"),
        _ => "never".into(),
    }
}

/// The last thing that kept the instrument from learning.
fn why_not_learnt(record: &Record) -> String {
    let last = record.rows.iter().rev().find_map(|row| row.tick.blocked);
    let mode = record.rows.last().map_or("off", |row| row.tick.mode.name());
    match last {
        Some(blocker) => format!("mode {mode} at the end; learning was refused: {}", blocker.words()),
        None => format!("mode {mode} at the end; the run is shorter than the learning window"),
    }
}
