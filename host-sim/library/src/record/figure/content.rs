//! What each figure of the paper shows.

use super::canvas::Colour;
use fdi_core::Mode;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::diagnosis::residual::{RESIDUALS, Residual};
use fdi_core::likelihood::Readiness;

use super::Number;
use super::plot::{BLUE, Band, Figure, INK, Panel, Pen, Scale, Trace, VERMILLION};
use crate::experiment::{Record, Row};

// Okabe and Ito's colours, which the colour-blind can tell apart.
const ORANGE: Colour = Colour(0xE6, 0x9F, 0x00);
const SKY: Colour = Colour(0x56, 0xB4, 0xE9);
const GREEN: Colour = Colour(0x00, 0x9E, 0x73);
const PURPLE: Colour = Colour(0xCC, 0x79, 0xA7);
const GREY: Colour = Colour(0xB4, 0xBB, 0xC4);
const NAVY: Colour = Colour(0x0B, 0x3C, 0x6F);
const PALE_GREY: Colour = Colour(0xB9, 0xC1, 0xCB);
const PALE_BLUE: Colour = Colour(0x9C, 0xCB, 0xE6);
const PALE_ORANGE: Colour = Colour(0xF3, 0xC0, 0x9A);

/// Tints of the faults, in turn.
const FAULT_COLOURS: [Colour; 4] = [ORANGE, GREEN, PURPLE, SKY];

const RAW: Pen = Pen::new(PALE_GREY, 1.0);
const FILTERED: Pen = Pen::new(NAVY, 1.5);

/// Collects a figure of the paper.
pub(super) fn figure(number: Number, record: &Record) -> Figure {
    let times: Vec<f64> = record.rows.iter().map(|row| record.time(row.tick.index)).collect();
    let start = times.first().copied().unwrap_or(0.0);
    let end = times.last().map_or(start + 1.0, |last| last + record.sample_time);
    let panels = match number {
        Number::Four => measurements(record),
        Number::Five => output_residuals_and_features(record),
        Number::Six => residuals_and_vectors(record),
    };
    Figure { span: (start, end), times, bands: bands(record, (start, end)), panels }
}

/// Learning, trips and faults, as far as they lie in the figure.
fn bands(record: &Record, (start, end): (f64, f64)) -> Vec<Band> {
    let learning = spans(record, |row| matches!(row.tick.mode, Mode::Learn { .. }));
    let tripped = spans(record, |row| matches!(row.tick.mode, Mode::Tripped(_)));
    let of_modes = |spans: Vec<_>, label: &'static str| {
        spans.into_iter().map(move |span| Band { label: label.into(), span, colour: GREY })
    };
    let of_faults = record.faults.iter().zip(FAULT_COLOURS.iter().cycle()).map(|(fault, &colour)| Band {
        label: fault.label(),
        span: (fault.at.max(start), fault.end().min(end)),
        colour,
    });
    of_modes(learning, "learning what is normal")
        .chain(of_modes(tripped, "tripped"))
        .chain(of_faults)
        .filter(|band| band.span.0 < band.span.1)
        .collect()
}

/// Times during which something holds.
fn spans(record: &Record, holds: impl Fn(&Row) -> bool) -> Vec<(f64, f64)> {
    let time = |row: &Row| record.time(row.tick.index);
    record
        .rows
        .chunk_by(|a, b| holds(a) == holds(b))
        .filter(|rows| holds(&rows[0]))
        .map(|rows| (time(&rows[0]), time(&rows[rows.len() - 1]) + record.sample_time))
        .collect()
}

/// Figure 4: what is measured, and what the models predict.
fn measurements(record: &Record) -> Vec<Panel> {
    let trace = |label, pen, value: fn(&Row) -> Option<f32>| trace(record, label, pen, value);
    vec![
        panel(
            "Ambient temperature T0 (°C)",
            Scale::AtLeast(1.0),
            vec![trace("T0", Pen::new(NAVY, 1.0), |r| r.tick.sample.t0.good())],
        ),
        panel(
            "Set-point R and outlet temperatures T1, T2 (°C)",
            Scale::AtLeast(1.0),
            vec![
                trace("T2", Pen::new(VERMILLION, 1.0), |r| r.tick.sample.t2.good()),
                trace("T1", Pen::new(BLUE, 1.0), |r| r.tick.sample.t1.good()),
                trace("R", Pen::new(INK, 1.5).stepped(), |r| Some(r.tick.setpoint.0)),
            ],
        ),
        panel(
            "Heating power Pa (%)",
            Scale::AtLeast(1.0),
            vec![trace("Pa", Pen::new(NAVY, 1.0), |r| Some(r.applied.0))],
        ),
        panel(
            "Rise over the room: measured y1, y2 and one-step predictions y1m, y2m (°C)",
            Scale::AtLeast(1.0),
            vec![
                trace("y2", Pen::new(PALE_ORANGE, 2.5), |r| r.report.y2),
                trace("y2m", Pen::new(VERMILLION, 1.0), |r| r.report.ms2.prediction),
                trace("y1", Pen::new(PALE_BLUE, 2.5), |r| r.report.y1),
                trace("y1m", Pen::new(BLUE, 1.0), |r| r.report.ms1.prediction),
            ],
        ),
    ]
}

/// Figure 5: the residuals that are shown only, and the features of the models.
fn output_residuals_and_features(record: &Record) -> Vec<Panel> {
    let trace = |label, pen, value: fn(&Row) -> Option<f32>| trace(record, label, pen, value);
    vec![
        panel(
            "Output residual ry1 = y1 \u{2212} y1m (°C)",
            Scale::AtLeast(0.2),
            vec![
                trace("raw", RAW, |r| Some(r.report.features?[Residual::Ry1 as usize])),
                trace("low-passed", FILTERED, |r| Some(r.report.features_filtered?[Residual::Ry1 as usize])),
            ],
        ),
        panel(
            "Output residual ry2 = y2 \u{2212} y2m (°C)",
            Scale::AtLeast(0.2),
            vec![
                trace("raw", RAW, |r| Some(r.report.features?[Residual::Ry2 as usize])),
                trace("low-passed", FILTERED, |r| Some(r.report.features_filtered?[Residual::Ry2 as usize])),
            ],
        ),
        panel(
            "Static gains sg1 of model MS1 and sg2 of model MS2 (°C per %)",
            Scale::AtLeast(0.02),
            vec![
                trace("sg1", Pen::new(BLUE, 1.2), |r| r.report.ms1.static_gain),
                trace("sg2", Pen::new(VERMILLION, 1.2), |r| r.report.ms2.static_gain),
            ],
        ),
        panel(
            "Bandwidth bw1 of model MS1 (rad/s)",
            Scale::AtLeast(0.2),
            vec![trace("bw1", Pen::new(NAVY, 1.2), |r| r.report.ms1.bandwidth)],
        ),
    ]
}

/// Figure 6: the residuals that decide, with their thresholds, and what was decided.
fn residuals_and_vectors(record: &Record) -> Vec<Panel> {
    let vector = |label, pen: Pen, value: fn(&Row) -> Option<u8>| {
        trace(record, label, pen.stepped(), move |r| value(r).map(f32::from))
    };
    let own: String = record.names.rows.iter().map(|(number, name)| format!("; {number}: {name}")).collect();
    let highest = record.names.rows.iter().map(|(number, _)| f64::from(*number)).fold(3.0, f64::max);
    vec![
        decisive(record, Residual::Rap, "Power residual rAP (%)", 1.0),
        decisive(record, Residual::Ry12, "Sensor difference residual ry12 (°C)", 0.2),
        decisive(record, Residual::Rsg1, "Static gain residual rsg1 of MS1 (°C per %)", 0.02),
        decisive(record, Residual::Rsg2, "Static gain residual rsg2 of MS2 (°C per %)", 0.02),
        decisive(record, Residual::Rbw1, "Bandwidth residual rbw1 of MS1 (rad/s)", 0.2),
        panel(
            "Fault detection vector fdv (1: additive, on T2; 2: multiplicative, on T1 or the process)",
            Scale::Levels(2.0),
            vec![
                vector("raw", RAW, |r| Some(r.report.raw?.fdv)),
                vector("low-passed", FILTERED, |r| Some(r.report.filtered?.fdv)),
            ],
        ),
        panel(
            format!("Fault isolation vector fiv (1: AFS2; 2: MFS1; 3: MFP{own})"),
            Scale::Levels(highest),
            vec![
                vector("raw", RAW, |r| Some(r.report.raw?.fiv)),
                vector("low-passed", FILTERED, |r| Some(r.report.filtered?.fiv)),
            ],
        ),
        likelihood(record),
    ]
}

/// What the likelihood diagnosis says: nothing, an alarm, or one of the classes that it named in this run.
fn likelihood(record: &Record) -> Panel {
    let mut names = vec!["quiet", "alarm"];
    for finding in record.rows.iter().filter_map(|row| row.report.likelihood.finding) {
        if !names.contains(&finding.class.name()) {
            names.push(finding.class.name());
        }
    }
    let level = |row: &Row| {
        let likelihood = &row.report.likelihood;
        let named = likelihood.finding.and_then(|f| names.iter().position(|name| *name == f.class.name()));
        let armed = likelihood.readiness == Readiness::Armed || likelihood.alarm;
        named.or(armed.then_some(usize::from(likelihood.alarm))).map(|level| level as f32)
    };
    let verdict = trace(record, "verdict", FILTERED.stepped(), level);
    let top = names.len() as f64 - 0.6; // room for the uppermost name above its line
    Panel { names, ..panel("Likelihood diagnosis: alarm and verdict", Scale::Levels(top), vec![verdict]) }
}

/// A decisive residual as it was judged; before monitoring, what it would have been with the baseline learnt later.
fn decisive(record: &Record, residual: Residual, title: &'static str, min_span: f64) -> Panel {
    let i = residual as usize;
    let nominal = record.baseline.as_ref().map(|b| b.raw.mean[i]);
    let either = |judged: Option<[f32; RESIDUALS]>, features: Option<[f32; RESIDUALS]>| {
        judged.map(|residuals| residuals[i]).or_else(|| Some(features?[i] - nominal?))
    };
    let traces = vec![
        trace(record, "raw", RAW, |r| either(r.report.residuals, r.report.features)),
        trace(record, "low-passed", FILTERED, |r| {
            either(r.report.residuals_filtered, r.report.features_filtered)
        }),
    ];
    Panel { thresholds: thresholds(record, residual), ..panel(title, Scale::AtLeast(min_span), traces) }
}

fn panel(title: impl Into<String>, scale: Scale, traces: Vec<Trace>) -> Panel {
    Panel { title: title.into(), scale, traces, thresholds: Vec::new(), names: Vec::new() }
}

fn trace(record: &Record, label: &'static str, pen: Pen, value: impl Fn(&Row) -> Option<f32>) -> Trace {
    let values = record.rows.iter().map(|row| value(row).map_or(f64::NAN, f64::from)).collect();
    Trace { label, pen, values }
}

/// Thresholds of a low-passed residual. It is centred on the mean of the raw feature, they on that of the low-passed
/// one. None without a baseline.
fn thresholds(record: &Record, residual: Residual) -> Vec<f64> {
    let i = residual as usize;
    let ends = |b: &Baseline| {
        let centre = f64::from(b.filtered.mean[i]) - f64::from(b.raw.mean[i]);
        let reach = record.sigma_factor * f64::from(b.filtered.sigma[i]);
        [centre - reach, centre + reach]
    };
    record.baseline.iter().flat_map(ends).collect()
}
