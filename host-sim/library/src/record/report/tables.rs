//! The tables of the page, and the words for what happened.

use super::numbers::{NOTHING, count, escape, maybe, significant, written};
use crate::experiment::{Record, Row};
use crate::record::paper;
use crate::record::summary::{FaultSummary, Learnt, Summary, with_degree_sign};
use crate::score::Score;
use crate::score::expectation::Expectation;
use fdi_core::diagnosis::Verdict;
use pt326_rig::Disturbance;
use pt326_rig::fault::{Fault, Verb};

/// How each fault was seen, by the low-passed residuals and by the raw ones.
pub(super) fn faults(record: &Record, summary: &Summary) -> String {
    if record.faults.is_empty() {
        return String::new();
    }
    let rows = |score: fn(&FaultSummary) -> &Score, verdict: fn(&Row) -> Option<Verdict>| {
        let pairs = record.faults.iter().zip(&summary.faults);
        pairs.map(move |(fault, seen)| fault_row(seen, score(seen), fault, stands(record, fault, verdict)))
    };
    let head = "<th>Fault</th><th>Onset<br>s</th><th>Detected at<br>(delay), s</th><th>Isolated at<br>(delay), s</th>\
                <th>Lasted<br>s</th><th>Indicated<br>s</th><th>Pieces</th><th>Isolated for<br>% of the fault</th>";
    let head_with_paper = format!("{head}<th>Paper: delay<br>s</th><th>Paper: indicated<br>s</th>");
    let low_passed = rows(|f| &f.signature, |row| row.report.filtered);
    let (head_low_passed, low_passed): (&str, Vec<_>) = if record.is_papers {
        let beside = low_passed.zip(&summary.faults).map(|(row, f)| [row, paper_cells(f)].concat());
        (&head_with_paper, beside.collect())
    } else {
        (head, low_passed.collect())
    };
    [
        "<h2>How each fault was seen</h2>\n",
        &html_table(
            "By the low-passed residuals, which is what the instrument goes by. fiv flickers while the models adapt: a name counts \
             where it has stood for 19 samples, from the first of them.",
            head_low_passed,
            low_passed,
        ),
        &html_table(
            "By the raw residuals, for comparison.",
            head,
            rows(|f| &f.signature_raw, |row| row.report.raw).collect(),
        ),
        &likelihood(record, summary),
    ]
    .concat()
}

/// How each fault was seen by the likelihood diagnosis: when, as what, how large.
fn likelihood(record: &Record, summary: &Summary) -> String {
    let head = "<th>Fault</th><th>Detected at<br>(delay), s</th><th>Isolated at<br>(delay), s</th><th>Indicated<br>s</th>\
                <th>First named</th><th>Settled on</th><th>Magnitude</th><th>True</th><th>Onset dated<br>off by, s</th>";
    let pairs = record.faults.iter().zip(&summary.faults);
    let rows = pairs.map(|(fault, seen)| likelihood_row(fault, seen)).collect();
    let sentences = summary.faults.iter().filter_map(|f| Some((&f.name, f.likelihood_sentence.as_ref()?)));
    let sentences: String =
        sentences.map(|(name, text)| format!("<li>{}: {}.</li>\n", escape(name), escape(text))).collect();
    let caption =
        "By the likelihood diagnosis: it names the fault and says how large it is, with a 95 % interval.";
    let table = html_table(caption, head, rows);
    if sentences.is_empty() {
        table
    } else {
        format!("{table}<p>What it said at the end of each fault:</p>\n<ul>\n{sentences}</ul>\n")
    }
}

fn likelihood_row(fault: &Fault, seen: &FaultSummary) -> Vec<String> {
    let p = &seen.likelihood;
    let expected = Expectation::of(fault).class;
    let class = |name: Option<&str>| match name {
        None => NOTHING.into(),
        Some(name) if expected.is_some_and(|class| class.name() == name) => name.to_owned(),
        Some(name) => format!("<span class='miss'>{name}</span>"),
    };
    let magnitude = p.magnitude.zip(p.magnitude_half_width).map(|(value, half)| {
        let unit = with_degree_sign(p.magnitude_unit.unwrap_or_default());
        format!("{} &plusmn; {} {unit}", significant(value, 3), significant(half, 2))
    });
    let truth = p.magnitude_true.zip(p.magnitude_true_unit);
    let never = |word| never(&p.score, expected.is_some(), word);
    vec![
        escape(&seen.name),
        moment(p.score.detected_s, p.score.detection_delay_s).unwrap_or_else(|| never("detected")),
        moment(p.score.isolated_s, p.score.isolation_delay_s).unwrap_or_else(|| never("isolated")),
        maybe(p.score.indicated_duration_s, 3),
        class(p.first_verdict),
        class(p.verdict),
        magnitude.unwrap_or_else(|| NOTHING.into()),
        truth
            .map_or_else(|| NOTHING.into(), |(x, unit)| format!("{} {}", written(x), with_degree_sign(unit))),
        maybe(p.onset_error_s, 2),
    ]
}

/// What the paper reports of a fault of this name.
fn paper_cells(fault: &FaultSummary) -> Vec<String> {
    let paper = paper::FAULTS.iter().find(|(name, ..)| *name == fault.name);
    vec![maybe(paper.map(|p| p.1), 1), maybe(paper.map(|p| p.2), 2)]
}

/// So long a name stands before it counts, samples: 2 s of the usual rig, as the page above counts.
const STANDS: usize = 19;

/// When fiv first began to name a fault for so long, while it acted.
fn stands(record: &Record, fault: &Fault, verdict: fn(&Row) -> Option<Verdict>) -> Option<f64> {
    let expected = Expectation::of(fault).fiv?;
    let names = |row: &Row| {
        fault.is_active(record.time(row.tick.index)) && verdict(row).is_some_and(|v| v.fiv == expected)
    };
    let mut runs = record.rows.chunk_by(|a, b| names(a) == names(b));
    let run = runs.find(|run| names(&run[0]) && run.len() > STANDS)?;
    Some(record.time(run[0].tick.index))
}

/// When fiv named a fault, and where that is another tick, when it first did.
fn isolated(score: &Score, fault: &Fault, stands: Option<f64>) -> Option<String> {
    let first = score.isolated_s?;
    let flicker = format!("<br><small>first tick {first:.2}</small>");
    Some(match stands {
        Some(at) if at == first => moment(stands, score.isolation_delay_s)?,
        Some(at) => moment(stands, Some(at - fault.at))? + &flicker,
        None => format!("{NOTHING} never for long{flicker}"),
    })
}

fn fault_row(seen: &FaultSummary, score: &Score, fault: &Fault, stands: Option<f64>) -> Vec<String> {
    let expected = Expectation::of(fault);
    let never = |answer: Option<u8>, word| never(score, answer.is_some(), word);
    let detected = moment(score.detected_s, score.detection_delay_s);
    let isolated = isolated(score, fault, stands);
    vec![
        escape(&seen.name),
        written(seen.onset_s),
        detected.unwrap_or_else(|| never(expected.fdv, "detected")),
        isolated.unwrap_or_else(|| never(expected.fiv, "isolated")),
        written(seen.duration_s),
        maybe(score.indicated_duration_s, 3),
        score.segments.map_or_else(|| NOTHING.into(), |n| n.to_string()),
        maybe(score.isolated_share.map(|share| 100.0 * share), 2),
    ]
}

/// A time and the delay since the onset, s.
fn moment(at: Option<f64>, delay: Option<f64>) -> Option<String> {
    Some(format!("{:.2} ({:.2})", at?, delay?))
}

/// Why there is no such time; `known`: whether the diagnosis has an answer for the fault.
fn never(score: &Score, known: bool, word: &str) -> String {
    let why = match (known, score.not_scored) {
        (_, Some(why)) => why.words().to_owned(),
        (false, None) => "not in the tables".to_owned(),
        (true, None) => format!("<span class='miss'>not {word}</span>"),
    };
    format!("{NOTHING} {why}")
}

/// Alarms with no fault behind them.
pub(super) fn false_alarms(summary: &Summary) -> String {
    let f = &summary.false_alarms;
    let row = |name: &str, low_passed: Option<u32>, raw: Option<u32>| {
        vec![name.into(), count(low_passed), count(raw)]
    };
    let rows = vec![
        row("Detection, fdv", f.fdv, f.fdv_raw),
        row("Isolation, fiv", f.fiv, f.fiv_raw),
        vec!["Likelihood alarm".into(), count(f.likelihood), NOTHING.into()],
    ];
    let caption = "Times that a vector left zero, or the likelihood alarm rose, outside every fault and the 15 s after it.";
    format!(
        "<h2>False alarms</h2>\n{}",
        html_table(caption, "<th>Indication</th><th>Low-passed</th><th>Raw</th>", rows)
    )
}

/// What is normal, as it was learnt.
pub(super) fn baseline(record: &Record, summary: &Summary) -> String {
    let Some(b) = &summary.baseline else { return String::new() };
    let features = [
        ("Power Pa (rAP), %", b.rap),
        ("y1 \u{2212} y2 (ry12), °C", b.ry12),
        ("Static gain of MS1 (rsg1), °C per %", b.rsg1),
        ("Static gain of MS2 (rsg2), °C per %", b.rsg2),
        ("Bandwidth of MS1 (rbw1), rad/s", b.rbw1),
    ];
    let k = record.sigma_factor;
    let rows = features.into_iter().map(|(name, normal)| baseline_row(name, &normal, k)).collect();
    let samples = record.baseline.map_or(0, |b| b.samples);
    let caption = format!(
        "Learnt from {samples} samples ({} s). A threshold lies {} standard deviations from the mean.",
        significant(f64::from(samples) * record.sample_time, 3),
        written(k)
    );
    let head = "<th>Feature (residual)</th><th>Mean</th><th>&sigma;</th><th>Thresholds</th><th>Low-passed:<br>mean</th>\
                <th>Low-passed:<br>&sigma;</th><th>Low-passed:<br>thresholds</th>";
    format!("<h2>What is normal</h2>\n{}", html_table(&caption, head, rows))
}

fn baseline_row(name: &str, learnt: &Learnt, sigma_factor: f64) -> Vec<String> {
    let thresholds = |mean: f64, sigma: f64| {
        let reach = sigma_factor * sigma;
        format!("{} to {}", significant(mean - reach, 4), significant(mean + reach, 4))
    };
    vec![
        name.into(),
        significant(learnt.mean, 4),
        significant(learnt.sigma, 3),
        thresholds(learnt.mean, learnt.sigma),
        significant(learnt.mean_f, 4),
        significant(learnt.sigma_f, 3),
        thresholds(learnt.mean_f, learnt.sigma_f),
    ]
}

/// `caption` and `head` are HTML, and so are the cells.
fn html_table(caption: &str, head: &str, rows: Vec<Vec<String>>) -> String {
    let row = |cells: Vec<String>| format!("<tr><td>{}</td></tr>\n", cells.join("</td><td>"));
    let rows: String = rows.into_iter().map(row).collect();
    format!(
        "<div class='wide'><table>\n<caption>{caption}</caption>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n\
         </table></div>\n"
    )
}

/// What a fault does, in words.
pub(super) fn what_happens(fault: &Fault) -> String {
    let sensor = fault.sensor.map_or_else(String::new, |s| format!("{s:?}"));
    let size = written(fault.size.unwrap_or_default());
    let what = match fault.verb {
        Verb::Offset if fault.size.is_some_and(|size| size < 0.0) => {
            format!("{sensor} reads {} °C too low", size.trim_start_matches(['-', '−']))
        }
        Verb::Offset => format!("{sensor} reads {size} °C too high"),
        Verb::Loose => format!("the contact of {sensor} is loose: it reads {size} °C too high now and then"),
        Verb::Shunt => format!("{size} ohm lie across {sensor}"),
        Verb::Return => format!("the thermistors' common return has {size} ohm"),
        Verb::Drift => format!("{sensor} drifts by {size} °C a minute"),
        Verb::Clog => {
            let lag = fault.lag.map_or_else(String::new, |lag| format!(" with a lag of {} s", written(lag)));
            format!("{sensor} clogged: it sees {size} of the rise{lag}")
        }
        Verb::Open => format!("wire of {sensor} broken"),
        Verb::Short => format!("{sensor} shorted"),
        Verb::Stuck => format!("{sensor} stuck"),
        Verb::Spike => format!("one sample of {sensor} is {size} °C off"),
        Verb::Missing => format!("samples of {sensor} missing with probability {size}"),
        Verb::AirFlow => format!("air flow {size} times the nominal one"),
        Verb::HeaterPower => format!("heater gives {size} times the power asked for"),
        Verb::SupplyVoltage => format!("supply of the heater at {size} times its nominal voltage"),
        Verb::HeaterStuck => format!("heater stuck at {size} %"),
        Verb::Ambient => format!("room {size} °C warmer"),
        Verb::AmbientDrift => format!("room warmer by {size} °C a minute"),
        Verb::Detach => {
            let over = fault.over.map_or_else(String::new, |over| format!(", over {} s", written(over)));
            format!("{sensor} out of the tube: it misses {size} of the rise{over}")
        }
        Verb::Swap => {
            let with = fault.with.map_or_else(String::new, |s| format!("{s:?}"));
            format!("{sensor} and {with} exchanged")
        }
        Verb::Freeze => format!("{sensor} frozen, with noise of {size} codes"),
    };
    format!("{what}, from {} s for {} s", written(fault.at), written(fault.duration))
}

/// How the surroundings moved, in words.
pub(super) fn surroundings(disturbance: Disturbance) -> &'static str {
    match disturbance {
        Disturbance::None => "still",
        Disturbance::Calm => "calm (slow room drift)",
        Disturbance::Lively => "lively (room drift, wandering air flow and mains)",
    }
}
