//! What a run showed, in numbers: delays and durations of each fault, false alarms, control error, what was learnt.

use crate::score::expectation::Expectation;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::diagnosis::residual::{DECISIVE, Residual};
use fdi_core::likelihood::Magnitude;
use fdi_core::likelihood::verdict::TaughtFinding;
use fdi_core::{AdcCode, Finding, Reading, Validity};
use firmware_logic::finding::Sentence;
use serde::Serialize;

use crate::experiment::{Origin, Record, Row};
use crate::score::{
    LikelihoodScore, LikelihoodScorer, Rise, Score, Scorer, TAIL, likelihood_alarm, signature_indication,
};
use pt326_rig::Disturbance;
use pt326_rig::fault::Fault;

/// `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Seed of the rig's noise; null for a recording.
    pub seed: Option<u64>,
    /// How the surroundings moved; null for a recording.
    pub disturbance: Option<Disturbance>,
    /// What was done to the rig, with the keys of a scenario's `[[fault]]`.
    pub truth: Vec<Fault>,
    /// Sample time.
    pub ts_s: f64,
    /// Set-point.
    pub setpoint_c: f64,
    /// Largest control error in the nominal window (180 to 360 s in the paper); null: the run has nothing of it.
    pub control_error_max_c: Option<f64>,
    /// The same in % of the set-point.
    pub control_error_max_pct: Option<f64>,
    /// What was learnt; null if the run was too short or unfit for learning.
    pub baseline: Option<BaselineSummary>,
    /// How each fault was seen.
    pub faults: Vec<FaultSummary>,
    /// Times that a vector left zero outside any fault (and its tail of 15 s).
    pub false_alarms: FalseAlarms,
    /// How it went while the virtual T1 was regulated; null where it never was.
    pub without_t1: Option<WithoutT1>,
    /// Trips, with time and reason.
    pub trips: Vec<TripSummary>,
}

/// Regulation by the virtual T1 in place of a faulty one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WithoutT1 {
    /// For how long.
    pub duration_s: f64,
    /// Mean of set-point minus virtual T1, degC. What the virtual T1 itself is off by, no instrument can know.
    pub error_mean_c: f64,
    /// Largest of it, without sign, degC.
    pub error_max_c: f64,
}

/// Learnt values of the five decisive residuals.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct BaselineSummary {
    /// Applied power, %.
    pub rap: Learnt,
    /// y1 - y2, degC; its mean is delta12.
    pub ry12: Learnt,
    /// Static gain of MS1, degC per %.
    pub rsg1: Learnt,
    /// Static gain of MS2, degC per %.
    pub rsg2: Learnt,
    /// Bandwidth of MS1, rad/s.
    pub rbw1: Learnt,
}

/// Learnt values of one feature: a residual is the feature minus `mean`.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Learnt {
    /// Mean of the feature.
    pub mean: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// Mean of the low-passed feature.
    pub mean_f: f64,
    /// Its standard deviation.
    pub sigma_f: f64,
}

/// One fault as the diagnosis saw it.
#[derive(Clone, Debug, Serialize)]
pub struct FaultSummary {
    /// Name.
    pub name: String,
    /// True onset.
    pub onset_s: f64,
    /// True duration.
    pub duration_s: f64,
    /// It lasts beyond the end of the run.
    pub beyond_the_end: bool,
    /// By the low-passed residuals.
    pub signature: Score,
    /// By the raw residuals.
    pub signature_raw: Score,
    /// By the likelihood diagnosis.
    pub likelihood: LikelihoodScore,
    /// The last sentence of the likelihood diagnosis about the fault; null: it never named it.
    pub likelihood_sentence: Option<String>,
}

/// Rising edges of each vector outside any fault; null where it never monitored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FalseAlarms {
    /// Detection, low-passed.
    pub fdv: Option<u32>,
    /// Isolation, low-passed.
    pub fiv: Option<u32>,
    /// Detection, raw.
    pub fdv_raw: Option<u32>,
    /// Isolation, raw.
    pub fiv_raw: Option<u32>,
    /// The likelihood diagnosis. What is no fault (a warmer room, a spike) excuses none of its alarms.
    pub likelihood: Option<u32>,
}

/// One trip.
#[derive(Clone, Debug, Serialize)]
pub struct TripSummary {
    /// When.
    pub t_s: f64,
    /// Why.
    pub reason: fdi_core::TripReason,
    /// What T1 was to be, degC.
    pub setpoint_c: f32,
    /// The temperature above which T1 or T2 trips, degC.
    pub limit_c: f32,
    /// What T1 read.
    pub t1: TripReading,
    /// What T2 read.
    pub t2: TripReading,
}

/// What a thermistor read on the tick that tripped.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TripReading {
    /// 12-bit code; null where none came.
    pub code: f32,
    /// Whether it could be believed.
    pub validity: fdi_core::Validity,
    /// The temperature that the code stands for, degC.
    pub celsius: f32,
}

impl std::fmt::Display for TripReading {
    /// The temperature, or what was wrong where it means nothing.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.validity {
            Validity::Missing => f.write_str("no sample"),
            Validity::Open => write!(f, "open (code {})", self.code),
            Validity::Short => write!(f, "shorted (code {})", self.code),
            _ => write!(f, "{:.1} \u{b0}C", self.celsius),
        }
    }
}

impl Summary {
    /// Scores a run.
    pub fn new(record: &Record) -> Self {
        let error = control_error_max(record);
        let (seed, disturbance) = match record.origin {
            Origin::Simulated { seed, disturbance } => (Some(seed), Some(disturbance)),
            Origin::Recorded { .. } | Origin::Watched { .. } => (None, None),
        };
        Self {
            seed,
            disturbance,
            truth: record.faults.clone(),
            ts_s: record.sample_time,
            setpoint_c: record.setpoint,
            control_error_max_c: error,
            control_error_max_pct: error.map(|error| 100.0 * error / record.setpoint),
            baseline: record.baseline.as_ref().map(baseline),
            faults: record.faults.iter().map(|f| fault(record, f)).collect(),
            false_alarms: false_alarms(record),
            without_t1: without_t1(record),
            trips: trips(record),
        }
    }
}

/// The faults that a `summary.json` knows of; `None` of what is none.
pub fn faults_in(json: &str) -> Option<Vec<Fault>> {
    let summary: serde_json::Value = serde_json::from_str(json).ok()?;
    serde_json::from_value(summary.get("truth")?.clone()).ok()
}

/// Largest |set-point - T1| over the nominal window, degC.
fn control_error_max(record: &Record) -> Option<f64> {
    let (from, to) = record.nominal_window;
    record
        .rows
        .iter()
        .filter(|row| (from..to).contains(&record.time(row.tick.index)))
        .filter_map(|row| Some(f64::from((row.tick.setpoint.0 - row.tick.sample.t1.good()?).abs())))
        .max_by(f64::total_cmp)
}

fn baseline(baseline: &Baseline) -> BaselineSummary {
    let learnt = |residual: Residual| {
        let i = residual as usize;
        Learnt {
            mean: baseline.raw.mean[i].into(),
            sigma: baseline.raw.sigma[i].into(),
            mean_f: baseline.filtered.mean[i].into(),
            sigma_f: baseline.filtered.sigma[i].into(),
        }
    };
    let [rap, ry12, rsg1, rsg2, rbw1] = DECISIVE.map(learnt);
    BaselineSummary { rap, ry12, rsg1, rsg2, rbw1 }
}

/// How the three forms of the diagnosis saw a fault.
fn fault(record: &Record, fault: &Fault) -> FaultSummary {
    let others = || record.faults.iter().filter(|other| !std::ptr::eq(*other, fault));
    let mut filtered = Scorer::new(fault).beside(others());
    let mut raw = filtered.clone();
    let mut likelihood = LikelihoodScorer::new(fault, record.sample_time).beside(others());
    for row in &record.rows {
        let t = record.time(row.tick.index);
        filtered.observe(t, signature_indication(fault, row.report.filtered));
        raw.observe(t, signature_indication(fault, row.report.raw));
        likelihood.observe(t, &row.report.likelihood);
    }
    let isolable = Expectation::of(fault).fiv.is_some();
    let likelihood = likelihood.score();
    FaultSummary {
        name: fault.label(),
        onset_s: fault.at,
        duration_s: fault.duration,
        beyond_the_end: (fault.at..fault.end()).contains(&record.end()),
        signature: filtered.score(record.sample_time, isolable),
        signature_raw: raw.score(record.sample_time, isolable),
        likelihood_sentence: last_sentence(record, fault, likelihood.verdict),
        likelihood,
    }
}

/// The last sentence about a fault while it acted, under the class that was settled on.
fn last_sentence(record: &Record, fault: &Fault, verdict: Option<&str>) -> Option<String> {
    let during = record.rows.iter().rev().filter(|row| fault.is_active(record.time(row.tick.index)));
    let (row, finding) = during
        .filter_map(|row| Some((row, row.report.likelihood.finding.as_ref()?)))
        .find(|(_, finding)| Some(finding.class.name()) == verdict)?;
    Some(sentence(record, row, finding))
}

/// A finding on the tick of `row`, for people: a board's console has no degree sign.
pub fn sentence(record: &Record, row: &Row, finding: &Finding) -> String {
    let (sample, expected) = (&row.tick.sample, row.report.likelihood.expected);
    let sentence = Sentence { finding, sample, expected, sample_time: record.sample_time as f32 };
    let taught = as_taught(row).map_or(String::new(), |taught| format!("; {taught}"));
    with_degree_sign(&format!("{sentence}{taught}"))
}

/// The fault of the user's own that it is, with its size.
pub fn as_taught(row: &Row) -> Option<String> {
    let TaughtFinding { name, magnitude: Magnitude { value, half_width }, .. } =
        row.report.likelihood.taught?;
    let [low, high] = [value - half_width, value + half_width];
    Some(format!("as taught: {name}, {value:.0} ({low:.0} to {high:.0}) % of what was taught"))
}

/// Text of the board, or the unit of a class, as people write it.
pub fn with_degree_sign(text: &str) -> String {
    text.replace("degC", "\u{b0}C")
}

/// Times that each alarm rises while nothing acts that it should report, nor has shortly before.
fn false_alarms(record: &Record) -> FalseAlarms {
    let mut rises = [Rise::default(); 5];
    let mut alarms = [None; 5];
    for row in &record.rows {
        let t = record.time(row.tick.index);
        let acting = || record.faults.iter().filter(|f| t >= f.at && t < f.end() + TAIL);
        let anything = acting().next().is_some();
        let faulty = acting().any(|f| Expectation::of(f).class.is_some());
        let (filtered, raw) = (row.report.filtered, row.report.raw);
        let flags = [
            (filtered.map(|v| v.fdv != 0), anything),
            (filtered.map(|v| v.fiv != 0), anything),
            (raw.map(|v| v.fdv != 0), anything),
            (raw.map(|v| v.fiv != 0), anything),
            (likelihood_alarm(&row.report.likelihood), faulty),
        ];
        for ((alarms, rise), (flag, excused)) in alarms.iter_mut().zip(&mut rises).zip(flags) {
            let rises = rise.of(flag == Some(true)) && !excused;
            if flag.is_some() {
                *alarms = Some(alarms.unwrap_or(0) + u32::from(rises));
            }
        }
    }
    let [fdv, fiv, fdv_raw, fiv_raw, likelihood] = alarms;
    FalseAlarms { fdv, fiv, fdv_raw, fiv_raw, likelihood }
}

fn without_t1(record: &Record) -> Option<WithoutT1> {
    let errors: Vec<f64> = record
        .rows
        .iter()
        .filter_map(|row| Some(f64::from(row.tick.setpoint.0 - row.tick.virtual_t1?.0)))
        .collect();
    let count = errors.len() as f64;
    (!errors.is_empty()).then(|| WithoutT1 {
        duration_s: count * record.sample_time,
        error_mean_c: errors.iter().sum::<f64>() / count,
        error_max_c: errors.iter().fold(0.0, |worst: f64, e| worst.max(e.abs())),
    })
}

fn trips(record: &Record) -> Vec<TripSummary> {
    let mut trips: Vec<fdi_core::Trip> = Vec::new();
    for row in &record.rows {
        if let fdi_core::Mode::Tripped(trip) = row.tick.mode
            && trips.last().is_none_or(|last| last.tick != trip.tick)
        {
            trips.push(trip);
        }
    }
    let read = |code: AdcCode, reading: Reading| TripReading {
        code: code.0,
        validity: reading.validity,
        celsius: reading.celsius.0,
    };
    let summary = |trip: &fdi_core::Trip| TripSummary {
        t_s: record.time(trip.tick),
        reason: trip.reason,
        setpoint_c: trip.setpoint.0,
        limit_c: trip.limit.0,
        t1: read(trip.raw.t1, trip.sample.t1),
        t2: read(trip.raw.t2, trip.sample.t2),
    };
    trips.iter().map(summary).collect()
}
