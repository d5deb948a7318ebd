//! `report.html`: a run explained on one page that needs nothing else: the lab's page, which walks through it, and tables.

mod numbers;
mod tables;

use crate::experiment::{Origin, Record};
use crate::record::summary::Summary;
use crate::record::{numbers as numbers_of, paper};
use crate::score::expectation::Expectation;
use pt326_lab::page::{self, Source};

pub use numbers::escape;
use numbers::{NOTHING, count};
pub(crate) use numbers::{significant, written};

/// How the method works, for whoever opens the page first.
const HOW_TO_READ: &str = include_str!("how_to_read.html");

/// The page: the lab's, with the recording within it and what is told here below.
pub fn html(record: &Record, summary: &Summary) -> String {
    let report = [
        introduction(record, summary),
        warnings(record, summary),
        if is_known(record) { key_numbers(record, summary) } else { String::new() },
        tables::faults(record, summary),
        if is_known(record) { tables::false_alarms(summary) } else { String::new() },
        tables::baseline(record, summary),
        HOW_TO_READ.into(),
    ];
    page::html(Source::Recording { json: &numbers_of::json(record), report: &report.concat() })
}

/// Whether it is known what was done to the rig: of a recording only where somebody says it.
fn is_known(record: &Record) -> bool {
    !matches!(record.origin, Origin::Watched { .. }) || !record.faults.is_empty()
}

/// What was run.
fn introduction(record: &Record, summary: &Summary) -> String {
    let duration = record.duration();
    let faults: Vec<String> = record
        .faults
        .iter()
        .map(|f| format!("<strong>{}</strong> ({})", escape(&f.label()), tables::what_happens(f)))
        .collect();
    let faults = match faults.as_slice() {
        [] if matches!(record.origin, Origin::Watched { .. }) => {
            "Nothing is known to have been wrong.".into()
        }
        [] => "Nothing was done to the rig.".into(),
        some => format!("What was done to the rig: {}.", some.join("; ")),
    };
    if let Origin::Watched { file } = &record.origin {
        let (duration, ts) = (significant(duration, 3), written(summary.ts_s));
        return format!(
            "<h1>Fault detection and isolation on a recording</h1>\n<p>{duration} s recorded in {}, diagnosed at every sample, \
             T<sub>s</sub> = {ts} s. {faults}</p>\n",
            escape(file)
        );
    }
    format!(
        "<h1>PT-326 fault detection and isolation</h1>\n<p>{} s of the PT-326 process trainer, {}, under the \
         instrument&rsquo;s control at a set-point of {} °C and diagnosed at every sample, T<sub>s</sub> = {} s. {faults}</p>\n",
        significant(duration, 3),
        origin(&record.origin),
        written(summary.setpoint_c),
        written(summary.ts_s),
    )
}

/// Where it comes from, in words.
fn origin(origin: &Origin) -> String {
    match origin {
        Origin::Simulated { seed, disturbance } => {
            format!("simulated with seed {seed} and {} surroundings", tables::surroundings(*disturbance))
        }
        Origin::Recorded { file } => format!("recorded in {} and replayed", escape(file)),
        Origin::Watched { file } => format!("recorded in {}", escape(file)),
    }
}

/// What went otherwise than it should.
fn warnings(record: &Record, summary: &Summary) -> String {
    let watched = matches!(record.origin, Origin::Watched { .. });
    let baseline = (summary.baseline.is_none() && !watched).then(|| {
        "No baseline was learnt: the run was too short or unfit for learning, so nothing could be diagnosed.".to_owned()
    });
    let trips = summary.trips.iter().map(|trip| {
        format!(
            "Tripped at {} s: {}. T1 read {}, expected {} °C; T2 read {}; the limit is {} °C. The heater was off until acknowledged.",
            significant(trip.t_s, 5),
            trip.reason.words(),
            trip.t1,
            significant(trip.setpoint_c.into(), 3),
            trip.t2,
            significant(trip.limit_c.into(), 3)
        )
    });
    let refused = record
        .refused
        .iter()
        .map(|(t, reason)| format!("A command was refused at {} s: {}.", significant(*t, 5), escape(reason)));
    let late = record
        .actions_after_end
        .iter()
        .map(|t| format!("An action at {} s was not done: the run ended before.", significant(*t, 5)));
    let beyond = summary.faults.iter().filter(|fault| fault.beyond_the_end).map(|fault| {
        format!(
            "{} lasts {} s, beyond the end of the run.",
            escape(&fault.name),
            significant(fault.duration_s, 5)
        )
    });
    let all = baseline.into_iter().chain(trips).chain(refused).chain(late).chain(beyond);
    all.map(|text| format!("<p class='warning'>{text}</p>\n")).collect()
}

/// The outcome at a glance.
fn key_numbers(record: &Record, summary: &Summary) -> String {
    let seen = |is_seen: fn(&crate::score::Score) -> bool| {
        summary.faults.iter().filter(|f| is_seen(&f.signature)).count()
    };
    let detected = seen(|score| score.detected_s.is_some());
    let isolated = seen(|score| score.isolated_s.is_some());
    let scored = |is_scored: fn(&crate::record::summary::FaultSummary, Expectation) -> bool| {
        let pairs = summary.faults.iter().zip(&record.faults);
        pairs.filter(|(seen, fault)| is_scored(seen, Expectation::of(fault))).count()
    };
    let all = scored(|seen, _| seen.signature.not_scored.is_none());
    let expected = scored(|seen, fault| seen.likelihood.score.not_scored.is_none() && fault.class.is_some());
    let named = summary.faults.iter().filter(|f| f.likelihood.score.isolated_s.is_some()).count();
    let (from, to) = record.nominal_window;
    let paper = if record.is_papers { format!("; paper {} %", paper::CONTROL_ERROR) } else { String::new() };
    let keys = [
        ("Faults detected", format!("{detected} of {all}"), "by the low-passed residuals".to_owned()),
        ("Faults isolated", format!("{isolated} of {all}"), "named rightly while they acted".to_owned()),
        ("Named by likelihood", format!("{named} of {expected}"), "while they acted".to_owned()),
        ("False alarms", count(summary.false_alarms.fdv), "of fdv, low-passed".to_owned()),
        (
            "Largest control error",
            summary.control_error_max_pct.map_or(NOTHING.into(), |x| format!("{} %", significant(x, 3))),
            format!("of the set-point, {from} to {to} s{paper}"),
        ),
    ];
    let cards = keys
        .map(|(name, value, note)| format!("<div><dt>{name}</dt><dd>{value}</dd><dd>{note}</dd></div>\n"));
    format!("<dl class='keys'>\n{}</dl>\n", cards.concat())
}

#[cfg(test)]
mod tests {
    use fdi_core::Config;

    use super::*;
    use crate::experiment::run;
    use crate::experiment::scenario::Scenario;
    use pt326_rig::fault::{Fault, Sensor, Verb};

    fn page(scenario: &Scenario) -> String {
        let record = run(&Config::default(), scenario, 1).unwrap();
        html(&record, &Summary::new(&record))
    }

    #[test]
    fn a_run_too_short_to_learn_says_so_and_escapes_names() {
        let mut scenario = Scenario { duration: 10.0, ..Scenario::default() };
        scenario.faults[1] = Fault { name: "<b>&".into(), at: 5.0, ..scenario.faults[1].clone() };
        let page = page(&scenario);
        assert!(page.contains("<td>&lt;b&gt;&amp;</td>") && !page.contains("<b>&"));
        assert!(page.contains("No baseline was learnt"));
        assert!(page.contains("before monitoring") && page.contains("after the end"));
        assert!(page.contains("<td>AFS2</td>") && page.contains("<td>MFP</td>"));
    }

    #[test]
    fn a_full_run_has_its_tables_and_needs_nothing_else() {
        let page = page(&Scenario { duration: 415.0, ..Scenario::default() });
        assert!(page.contains("What is normal") && page.contains("Static gain of MS1"));
        assert!(page.contains("1 of 1") && !page.contains("class='warning'"));
        assert!(page.contains("id=\"recording\"") && page.len() < 3_000_000);
        // A part of the page itself, and the name of SVG: neither is fetched.
        let page = page.replace("url(#", "").replace("http://www.w3.org/2000/svg", "");
        for outside in ["<img", "src=", "url(", "@import", "http:", "https:"] {
            assert!(!page.contains(outside), "{outside}");
        }
    }

    /// As the page above it says: MFP is named for good 16 s after it began, and for a moment before.
    #[test]
    fn a_flicker_of_fiv_is_no_name() {
        let page = page(&Scenario::default());
        assert!(page.contains("<td>746.02 (16.02)<br><small>first tick 744.15</small></td>"));
        assert!(page.contains("<td>385.11 (0.61)</td>"));
    }

    #[test]
    fn a_trip_is_in_the_warnings() {
        let open = Fault::new(Verb::Open, Some(Sensor::T1), None, 3.0, 10.0);
        let page = page(&Scenario { duration: 8.0, faults: vec![open], ..Scenario::default() });
        assert!(page.contains("Tripped at 3.") && page.contains("broken wire"), "{page}");
    }

    #[test]
    fn a_rig_to_which_nothing_was_done_is_described() {
        let page = page(&Scenario { duration: 2.0, faults: vec![], ..Scenario::default() });
        assert!(page.contains("Nothing was done to the rig") && page.contains("0 of 0"));
    }
}
