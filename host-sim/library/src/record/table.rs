//! The table that a run prints.

use std::fmt::Write;

use fdi_core::diagnosis::event::Event;

use crate::experiment::{Origin, Record};
use crate::record::paper;
use crate::record::summary::{FaultSummary, Summary, as_taught, sentence, with_degree_sign};
use crate::score::Score;
use crate::score::expectation::Expectation;

/// Columns of a terminal.
const WIDTH: usize = 100;

/// The whole table, with a line end.
pub fn of_run(record: &Record, summary: &Summary) -> String {
    let mut text = String::new();
    let s = summary;
    let duration = record.duration();
    let _ = writeln!(text, "PT-326 fault diagnosis: {duration:.0} s {}", record.origin);
    let _ = writeln!(text);
    faults(&mut text, record, &s.faults);
    verdicts(&mut text, &s.faults);
    if s.faults.is_empty() {
        events(&mut text, record);
    }
    let _ = writeln!(text);
    if record.setpoint.is_finite() {
        let _ = writeln!(text, "Largest control error  {}", control_error(record, summary));
    }
    let f = &s.false_alarms;
    let count = |alarms: Option<u32>| alarms.map_or("-".into(), |n| n.to_string());
    let _ = writeln!(
        text,
        "{:<22} fdv {}, fiv {} (low-passed)   fdv {}, fiv {} (raw)   likelihood {}",
        if matches!(record.origin, Origin::Recorded { .. } | Origin::Watched { .. }) && s.faults.is_empty() {
            "Alarms"
        } else {
            "False alarms"
        },
        count(f.fdv),
        count(f.fiv),
        count(f.fdv_raw),
        count(f.fiv_raw),
        count(f.likelihood)
    );
    if s.baseline.is_none() && !matches!(record.origin, Origin::Watched { .. }) {
        let _ = writeln!(text, "No baseline learnt     {}", why_not_learnt(record));
    }
    if let Some(w) = &s.without_t1 {
        let _ = writeln!(
            text,
            "Without T1             {:.1} s by T2 and the models: {:.2} °C off in the mean, {:.2} at most",
            w.duration_s, w.error_mean_c, w.error_max_c
        );
    }
    for trip in &s.trips {
        let _ = writeln!(
            text,
            "TRIPPED                at {:.2} s: {}\n{:23}T1 {}, expected {:.1} °C; T2 {}; heater off until acknowledged",
            trip.t_s,
            trip.reason.words(),
            "",
            trip.t1,
            trip.setpoint_c,
            trip.t2
        );
    }
    for (t, reason) in &record.refused {
        let _ = writeln!(text, "Refused                at {t:.2} s: {reason}");
    }
    for t in &record.actions_after_end {
        let _ = writeln!(text, "Not done               an action at {t:.2} s, after the end of the run");
    }
    text
}

/// What both diagnoses said happened, where there is no truth to hold it against. The sentence about a class tells the taught fault, too.
fn events(text: &mut String, record: &Record) {
    let (mut named, mut taught) = (None, None);
    let mut alarm = false;
    for row in &record.rows {
        for event in &row.report.events {
            signature_event(text, record, event);
        }
        let likelihood = &row.report.likelihood;
        let place = likelihood.taught.map(|taught| taught.place);
        let t = record.time(row.tick.index);
        if let Some(finding) = likelihood.finding.filter(|finding| named != Some(finding.class)) {
            let _ = writeln!(text, "{t:>9.2} s  likelihood: {}", sentence(record, row, &finding));
        } else if let Some(told) = as_taught(row).filter(|_| taught != place) {
            let _ = writeln!(text, "{t:>9.2} s  likelihood: {told}");
        }
        if alarm && !likelihood.alarm {
            let _ = writeln!(text, "{t:>9.2} s  likelihood: all is as expected again");
        }
        named = likelihood.finding.map(|finding| finding.class);
        taught = place;
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

fn control_error(record: &Record, summary: &Summary) -> String {
    let (from, to) = record.nominal_window;
    let paper = if record.is_papers { format!("   paper {} %", paper::CONTROL_ERROR) } else { String::new() };
    match summary.control_error_max_pct.zip(summary.control_error_max_c) {
        Some((percent, celsius)) => format!("{percent:.2} % of the set-point ({celsius:.2} °C){paper}"),
        None => format!("not measured: the run has nothing of {from} to {to} s, when nothing acts"),
    }
}

/// One line a fault and form; beside the paper's own experiment what the paper reports of it.
fn faults(text: &mut String, record: &Record, faults: &[FaultSummary]) {
    if faults.is_empty() {
        let _ = writeln!(text, "Nothing is known to have been done to the rig.");
        return;
    }
    let paper = if record.is_papers { "paper" } else { "" };
    let head =
        row("Fault", "onset", ["detected at (delay)", "isolated at (delay)"], ["indicated", "true"], paper);
    let _ = writeln!(text, "{head}");
    for (fault, summary) in record.faults.iter().zip(faults) {
        let papers = paper::FAULTS.iter().find(|(name, ..)| record.is_papers && *name == summary.name);
        let papers = papers.map_or(String::new(), |(_, delay, span)| format!("{delay} s, {span} s"));
        let expected = Expectation::of(fault);
        let (fdv, fiv, class) = (expected.fdv.is_some(), expected.fiv.is_some(), expected.class.is_some());
        for (name, score, known, papers) in [
            (summary.name.as_str(), &summary.signature, [fdv, fiv], papers.as_str()),
            ("  raw residuals", &summary.signature_raw, [fdv, fiv], ""),
            ("  likelihood", &summary.likelihood.score, [class, class], ""),
        ] {
            let _ = writeln!(text, "{}", line(name, record, summary, score, known, papers));
        }
    }
    for fault in faults.iter().filter(|fault| fault.beyond_the_end) {
        let (name, end, span) = (&fault.name, record.end(), fault.duration_s);
        let _ = writeln!(text, "{name} lasts {span:.1} s, beyond the end of the run at {end:.1} s.");
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
    for fault in faults.iter().filter(|fault| fault.likelihood.score.not_scored.is_none()) {
        let sentence = fault.likelihood_sentence.as_deref().unwrap_or("it was never named");
        paragraph(text, &fault.name, sentence);
        let truth = truth(fault);
        if !truth.is_empty() {
            paragraph(text, "", &format!("({})", truth.join(", ")));
        }
    }
}

/// The truth about a fault, and how far the verdict is from it.
fn truth(fault: &FaultSummary) -> Vec<String> {
    let p = &fault.likelihood;
    let mut truth = Vec::new();
    let size = p.magnitude_true.zip(p.magnitude_true_unit);
    truth.extend(size.map(|(x, unit)| format!("true {x} {}", with_degree_sign(unit))));
    truth.extend(p.onset_error_s.map(|t| match t {
        ..0.0 => format!("onset dated {:.2} s too early", -t),
        _ => format!("onset dated {t:.2} s too late"),
    }));
    let first = p.first_verdict.filter(|_| p.first_verdict_right == Some(false));
    truth.extend(first.map(|first| format!("first taken for {first}")));
    truth
}

/// Text beside a name, in lines that a terminal holds.
fn paragraph(text: &mut String, name: &str, content: &str) {
    let first = format!("{name:<15} ");
    let options = textwrap::Options::new(WIDTH).initial_indent(&first).subsequent_indent("                ");
    let _ = writeln!(text, "{}", textwrap::fill(content, options));
}

fn line(
    name: &str,
    record: &Record,
    fault: &FaultSummary,
    score: &Score,
    [detectable, isolable]: [bool; 2],
    paper: &str,
) -> String {
    let detected = moment(score.detected_s, score.detection_delay_s, score, detectable);
    let isolated = moment(score.isolated_s, score.isolation_delay_s, score, isolable);
    let indicated = score.indicated_duration_s.map_or("-".into(), |d| format!("{d:.1}"));
    let lasted = fault.duration_s.min((record.end() - fault.onset_s).max(0.0));
    let durations = [indicated.as_str(), &format!("{lasted:.1} s")];
    row(name, &format!("{:.1} s", fault.onset_s), [&detected, &isolated], durations, paper)
}

fn row(
    name: &str,
    onset: &str,
    [detected, isolated]: [&str; 2],
    [indicated, lasted]: [&str; 2],
    paper: &str,
) -> String {
    let row = format!(
        "{name:<15} {onset:>9}  {detected:<20}  {isolated:<20} {indicated:>9} / {lasted:<7}  {paper}"
    );
    row.trim_end().to_owned()
}

/// When, and how long after the onset; or why not. `known`: whether the diagnosis has an answer for the fault.
fn moment(at: Option<f64>, delay: Option<f64>, score: &Score, known: bool) -> String {
    match (at.zip(delay), score.not_scored) {
        (Some((at, delay)), _) => format!("{at:.2} s ({delay:.2} s)"),
        (None, Some(why)) => why.words().into(),
        (None, None) if !known => "not in the tables".into(),
        (None, None) => "never".into(),
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

#[cfg(test)]
mod tests {
    use fdi_core::Config;
    use fdi_core::likelihood::verdict::TaughtFinding;
    use fdi_core::likelihood::{FaultClass, Finding, Magnitude};

    use super::*;
    use crate::experiment::{run, scenario::Scenario};

    #[test]
    fn a_taught_fault_is_told_once() {
        let scenario = Scenario { duration: 1.0, ..Scenario::default() };
        let class = Finding { class: FaultClass::T2Offset, confidence: 0.9, magnitude: None, onset: 1 };
        let size = Magnitude { value: 100.0, half_width: 5.0 };
        for from in [3, 5] {
            let mut record = run(&Config::default(), &scenario, 1).unwrap();
            record.names.taught = vec!["cap".into()];
            for (i, row) in record.rows.iter_mut().enumerate() {
                let likelihood = &mut row.report.likelihood;
                likelihood.finding = (i >= 3).then_some(class);
                likelihood.taught = (i >= from).then(|| TaughtFinding {
                    name: "cap".parse().unwrap(),
                    place: 0,
                    confidence: 0.97,
                    magnitude: size,
                });
            }
            let mut text = String::new();
            events(&mut text, &record);
            assert_eq!(text.matches("cap").count(), 1, "{text}");
        }
    }
}
