//! The last tick and what was counted, as text for Prometheus (exposition format 0.0.4).
//!
//! Which numbers a tick has, and their units and kinds, says `fdi_core::schema`. A unit becomes Prometheus' base unit: per cent a ratio. What
//! is not defined has no sample.

use std::fmt::Write;
use std::time::SystemTime;

use fdi_core::diagnosis::residual::DECISIVE;
use fdi_core::likelihood::{FaultClass, Readiness};
use fdi_core::schema::{Entry, FIELDS, Kind, Metric};
use fdi_core::supervisor::Blocker;
use fdi_core::{Mode, TripReason};

use crate::counts::{Counts, number};
use crate::history::History;
use crate::source::Numbers;

/// Metrics of one name, written as one group.
struct Family {
    name: String,
    help: String,
    kind: &'static str,
    samples: Vec<(String, f64)>,
}

/// All there is to say, of one rig or of several.
#[derive(Default)]
pub(crate) struct Families {
    all: Vec<Family>,
    /// Label that tells the rig from others.
    board: Option<String>,
}

impl Families {
    /// Adds a sample; the first of its name says what it is.
    fn put(&mut self, name: &str, help: &str, labels: &[(&str, &str)], value: f64) {
        let labels: Vec<_> =
            labels.iter().map(|(key, value)| format!("{key}=\"{}\"", escaped(value))).collect();
        self.put_labelled(name, help, labels.join(","), value);
    }

    fn put_labelled(&mut self, name: &str, help: &str, labels: String, value: f64) {
        let place = self.all.iter().position(|family| family.name == name).unwrap_or_else(|| {
            let kind = if name.ends_with("_total") { "counter" } else { "gauge" };
            self.all.push(Family { name: name.into(), help: help.into(), kind, samples: Vec::new() });
            self.all.len() - 1
        });
        let labels: Vec<_> = self.board.clone().into_iter().chain(Some(labels)).collect();
        self.all[place].samples.push((labels.join(",").trim_end_matches(',').into(), value));
    }

    /// What follows is of this rig.
    pub(crate) fn of_board(&mut self, board: &str) {
        self.board = Some(format!("board=\"{}\"", escaped(board)));
    }

    /// What there is to say of a rig now, which so many pages watch.
    pub(crate) fn add(&mut self, history: &History, clients: usize) {
        of_server(self, history, clients);
        of_counts(self, &history.counts);
        if let Some(row) = history.last() {
            let sample_time = history.about()["ts"].as_f64().unwrap_or(f64::NAN);
            let fields = FIELDS.iter().zip(row);
            fields.for_each(|(field, value)| of_field(self, field, *value, row, sample_time));
        }
    }

    /// Of a rig that has not been there yet.
    pub(crate) fn add_missing(&mut self) {
        connected(self, false);
    }

    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        for Family { name, help, kind, samples } in &self.all {
            let _ = writeln!(text, "# HELP {name} {help}\n# TYPE {name} {kind}");
            for (labels, value) in samples {
                let labels = if labels.is_empty() { String::new() } else { format!("{{{labels}}}") };
                let _ = writeln!(text, "{name}{labels} {value}");
            }
        }
        text
    }
}

/// The value of a label.
fn escaped(value: &str) -> String {
    value.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
}

fn connected(all: &mut Families, is_heard: bool) {
    let help = "Whether the board is heard; a simulated rig always is";
    all.put("pt326_connected", help, &[], f64::from(u8::from(is_heard)));
}

fn of_server(all: &mut Families, history: &History, clients: usize) {
    let about = history.about();
    let said = |key: &str| about[key].as_str().unwrap_or_default();
    all.put("pt326_build_info", "Version of pt326", &[("version", said("version"))], 1.0);
    let rig = [("kind", said("kind")), ("name", said("name"))];
    all.put("pt326_rig_info", "What is watched: a board, a simulated rig (live), a recording", &rig, 1.0);
    if let Some(seconds) = about["ts"].as_f64() {
        all.put("pt326_sample_time_seconds", "Time between two ticks", &[], seconds);
    }
    all.put("pt326_clients", "Pages that watch", &[], clients as f64);
}

fn of_counts(all: &mut Families, counts: &Counts) {
    let Counts { ticks, unheard, gaps, late, missed, alarms, trips, lost, heard, .. } = counts;
    connected(all, !lost);
    let since = heard.and_then(|at| at.duration_since(SystemTime::UNIX_EPOCH).ok());
    if let Some(since) = since {
        let help = "When the last tick was heard, since 1970";
        all.put("pt326_last_tick_timestamp_seconds", help, &[], since.as_secs_f64());
    }
    for (name, help, count) in [
        ("pt326_ticks_total", "Ticks since the start", ticks),
        ("pt326_ticks_unheard_total", "Ticks of the board that did not come through", unheard),
        ("pt326_stream_gaps_total", "Times that ticks of the board did not come through", gaps),
        ("pt326_ticks_late_total", "Ticks that the board began more than 1 ms late", late),
        ("pt326_ticks_missed_total", "Ticks that the board never began", missed),
        ("pt326_alarms_total", "Alarms of the likelihood diagnosis", alarms),
    ] {
        all.put(name, help, &[], *count as f64);
    }
    for (reason, count) in TripReason::NAMES.iter().zip(trips) {
        all.put("pt326_trips_total", "Trips, by their reason", &[("trip", reason)], *count as f64);
    }
}

/// A field of a tick, where it is defined and has a place here.
fn of_field(all: &mut Families, field: &Entry, value: f32, row: &Numbers, sample_time: f64) {
    if value.is_nan() {
        return;
    }
    if let Some(name) = name_of(field, value) {
        let help = format!("1 with the present {} as a label", field.name);
        all.put(&format!("pt326_{}_info", field.name), &help, &[(field.name, name)], 1.0);
    }
    let Some(Named { name, help, mut labels }) = named(field) else { return };
    if let Some(class) = class(row) {
        labels = match field.name {
            "confidence" | "onset" => format!("class=\"{}\"", class.name()),
            "magnitude" | "half_width" => format!("class=\"{}\",unit=\"{}\"", class.name(), class.unit()),
            _ => labels,
        };
    }
    let value = match field.number.kind {
        Kind::Tick => (f64::from(number(row, "tick").unwrap_or(value)) - f64::from(value)) * sample_time,
        _ => f64::from(value),
    };
    let (name, factor) = in_base_unit(&name);
    all.put_labelled(&name, &help, labels, value * factor);
}

/// Name, help and labels of a field.
struct Named {
    name: String,
    help: String,
    labels: String,
}

/// As the schema has it, or by the rules for what has no name there.
fn named(field: &Entry) -> Option<Named> {
    let named =
        |name: &str, help: &str, labels: String| Some(Named { name: name.into(), help: help.into(), labels });
    if let Some(Metric { name, help, label }) = &field.number.metric {
        return named(name, help, (*label).into());
    }
    if let Some(sensor) = field.name.strip_suffix("_expected") {
        return named(
            "pt326_expected_celsius",
            "What it should read by the models",
            format!("sensor=\"{sensor}\""),
        );
    }
    if let Some(class) = field.name.strip_prefix("x_") {
        let help = "Share of what is unusual that the class would explain by itself";
        return named("pt326_explained_ratio", help, format!("class=\"{class}\""));
    }
    if DECISIVE.iter().any(|residual| format!("{residual:?}").eq_ignore_ascii_case(field.name)) {
        let help = "Low-passed residual over its threshold; a symptom beyond -1 and 1";
        return named("pt326_residual_ratio", help, format!("residual=\"{}\"", field.name));
    }
    let (_, name, help) = UNNAMED.iter().find(|(of, ..)| *of == field.name)?;
    named(name, help, String::new())
}

/// Fields that have no name for Prometheus in the schema.
const UNNAMED: [(&str, &str, &str); 5] = [
    ("pid", "pt326_controller_percent", "What the controller wants, without the excitation"),
    ("learned", "pt326_baseline_samples", "Samples that the baseline has"),
    ("confidence", "pt326_confidence_ratio", "Confidence in the fault that is named"),
    ("half_width", "pt326_half_width", "Half of the 95 % interval of the size of the fault that is named"),
    ("onset", "pt326_fault_age_seconds", "Since when the fault that is named has been there"),
];

/// Per cent as a ratio.
fn in_base_unit(name: &str) -> (String, f64) {
    match name.strip_suffix("_percent") {
        Some(stem) => (format!("{stem}_ratio"), 0.01),
        None => (name.into(), 1.0),
    }
}

/// The fault that is named.
pub(crate) fn class(row: &Numbers) -> Option<FaultClass> {
    let number = number(row, "class")?;
    FaultClass::ALL.into_iter().find(|class| class.number() as f32 == number)
}

/// What a number stands for, where it stands for a name.
pub(crate) fn name_of(field: &Entry, value: f32) -> Option<&'static str> {
    if field.name == "class" {
        return FaultClass::ALL.iter().find(|class| class.number() as f32 == value).map(|class| class.name());
    }
    let names: &[&'static str] = match field.name {
        "mode" => &Mode::NAMES,
        "trip" => &TripReason::NAMES,
        "blocked" => &Blocker::NAMES,
        "readiness" => &Readiness::NAMES,
        _ => return None,
    };
    let first = usize::from(field.number.kind == Kind::Choice);
    names.get((value as usize).checked_sub(first)?).copied()
}

/// All there is to say now of one rig, to so many pages that watch.
pub(crate) fn text(history: &History, clients: usize) -> String {
    let mut all = Families::default();
    all.add(history, clients);
    all.text()
}

#[cfg(test)]
mod tests;
