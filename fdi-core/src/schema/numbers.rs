//! The list, but for the shares of the classes, which stand in their rows (`likelihood/class.rs`). Places are never changed: a new number takes the next
//! one wherever it is to stand.

use super::{Bits, Kind, Metric, Moment, Number, Source, Value, WORDS};
use crate::diagnosis::Report;
use crate::diagnosis::residual::{DECISIVE, Residual};
use crate::diagnosis::signature::{Symptom, Symptoms};
use crate::identify::observer::Identified;
use crate::likelihood::{FaultClass, Finding, Magnitude, Readiness, RejectReason};
use crate::numbered::numbered;
use crate::observation::Shelving;
use crate::sense::Validity;
use crate::supervisor::{Blocker, Mode, TripReason};

use Residual::{Rap, Rbw1, Rsg1, Rsg2, Ry1, Ry2, Ry12};

numbered! {
    Readiness from 0;
    Self::Untrained => 0, "untrained";
    Self::Training => 1, "training";
    Self::Armed => 2, "armed";
    Self::Refused(RejectReason::Unstable) => 3, "refused_unstable";
    Self::Refused(RejectReason::Gain) => 4, "refused_gain";
    Self::Refused(RejectReason::PoorFit) => 5, "refused_poor_fit";
    Self::Refused(RejectReason::DeadTime) => 6, "refused_dead_time";
    Self::Restarted => 7, "restarted";
}

/// Words that several numbers share.
pub(super) const SHARED: [(usize, &str); 4] =
    [(1, "timing"), (10, "state"), (25, "vectors"), (26, "likelihood")];

/// The word of the symptoms.
pub(super) const SYMPTOMS: usize = 24;

/// `Kind("unit", |on| value) column(place, "name") field(place, "name") log(word, "name") metric("name", "help", "label");`, each place only
/// where it stands there; `log(word, "name", shift, width)` where it shares a word.
macro_rules! numbers {
    ($($kind:ident($unit:expr, |$on:ident| $value:expr)
        $(column($column:literal, $column_name:literal))?
        $(field($field:literal, $field_name:literal))?
        $(log($word:expr, $log_name:literal $(, $shift:literal, $width:literal)?))?
        $(metric($metric:literal, $help:literal, $label:literal))?;)*) => {
        /// Every number of the list.
        pub(super) static LISTED: [Number; [$(stringify!($value)),*].len()] = [$(Number {
            unit: $unit,
            kind: Kind::$kind,
            source: Source::Of(|$on| Value::$kind(($value).into())),
            column: optional!($(($column, $column_name))?),
            field: optional!($(($field, $field_name))?),
            log: optional!($(bits!($word, $log_name $(, $shift, $width)?))?),
            metric: optional!($(Metric { name: $metric, help: $help, label: $label })?),
        }),*];

        /// The record of a tick.
        pub fn words(on: &Moment) -> [u32; WORDS] {
            let mut words = [0; WORDS];
            $($({
                let $on = on;
                bits!($word, $log_name $(, $shift, $width)?).put(Value::$kind(($value).into()).bits(), &mut words);
            })?)*
            words
        }
    };
}

macro_rules! optional {
    () => {
        None
    };
    ($given:expr) => {
        Some($given)
    };
}

macro_rules! bits {
    ($word:expr, $name:literal) => {
        bits!($word, $name, 0, 32)
    };
    ($word:expr, $name:literal, $shift:literal, $width:literal) => {
        Bits { word: $word, name: $name, shift: $shift, width: $width }
    };
}

const DEGC: &str = "degC";
const PER_CENT: &str = "%";
const GAIN: &str = "degC/%";
const PER_SECOND: &str = "1/s";

#[rustfmt::skip]
numbers! {
    Tick("s", |on| on.tick.index) column(0, "t_s") field(0, "tick") log(0, "tick");
    Count("us", |on| if on.missed { 0 } else { on.late_us }) log(1, "late_us", 0, 31);
    Count("", |on| u32::from(on.missed)) log(1, "missed", 31, 1);

    // What the thermistors read, and what they should by the models. A log has the codes.
    Reading(DEGC, |on| on.tick.sample.t0) column(1, "t0_c") field(1, "t0") metric("pt326_temperature_celsius", "What a thermistor reads", "sensor=\"t0\"");
    Reading(DEGC, |on| on.tick.sample.t1) column(2, "t1_c") field(2, "t1") metric("pt326_temperature_celsius", "", "sensor=\"t1\"");
    Reading(DEGC, |on| on.tick.sample.t2) column(3, "t2_c") field(3, "t2") metric("pt326_temperature_celsius", "", "sensor=\"t2\"");
    Float("", |on| on.raw.t0.0) log(2, "t0_code");
    Float("", |on| on.raw.t1.0) log(3, "t1_code");
    Float("", |on| on.raw.t2.0) log(4, "t2_code");
    Float("", |on| on.raw.supply.0) log(31, "supply_code");
    Count("", |on| on.tick.sample.t0.validity.number()) log(10, "t0_validity", 4, 4);
    Count("", |on| on.tick.sample.t1.validity.number()) log(10, "t1_validity", 8, 4);
    Count("", |on| on.tick.sample.t2.validity.number()) log(10, "t2_validity", 12, 4);
    Float(DEGC, |on| on.report.likelihood.expected[0]) field(4, "t0_expected");
    Float(DEGC, |on| on.report.likelihood.expected[1]) field(5, "t1_expected") metric("pt326_expected_celsius", "What it should read by the models", "sensor=\"t1\"");
    Float(DEGC, |on| on.report.likelihood.expected[2]) field(6, "t2_expected") metric("pt326_expected_celsius", "", "sensor=\"t2\"");

    Float(DEGC, |on| on.tick.setpoint.0) column(4, "setpoint_c") field(7, "setpoint") log(5, "setpoint") metric("pt326_setpoint_celsius", "Set-point of T1", "");
    // What the controller wants, and what the heater got: that, or the power of a self-test.
    Float(PER_CENT, |on| on.tick.pid.0) column(5, "u_pid_pct") field(8, "pid") log(6, "pid");
    Float(PER_CENT, |on| on.tick.prbs.0) column(6, "prbs_pct") log(7, "prbs");
    Float(PER_CENT, |on| on.tick.drive.0) column(7, "pa_pct") log(8, "drive");
    Float(PER_CENT, |on| on.applied.0) field(9, "drive") log(9, "applied") metric("pt326_power_percent", "What drives the heater", "");

    Named("", |on| on.tick.mode.numbered()) column(38, "mode") field(10, "mode") log(10, "mode", 0, 4) metric("pt326_mode", "0 off, 1 settle, 2 learn, 3 monitor, 4 tripped, 5 tune", "");
    Choice("", |on| on.trip()) field(11, "trip") log(10, "trip", 28, 4);
    Count("", |on| u32::from(on.tick.learn)) log(10, "learn", 16, 1);
    Choice("", |on| on.tick.blocked.map(|blocker| blocker.numbered())) field(12, "blocked") log(10, "blocked", 17, 3);
    Count("", |on| on.report.learned) field(13, "learned") log(11, "learned");

    // The paper's models. Their flags: held, gain held, bandwidth held, diverged.
    Float(DEGC, |on| on.report.y1) column(8, "y1_c");
    Float(DEGC, |on| on.report.y2) column(9, "y2_c");
    Float(DEGC, |on| on.report.ms1.prediction) column(10, "y1m_c") log(12, "y1m");
    Float(DEGC, |on| on.report.ms2.prediction) column(11, "y2m_c") log(13, "y2m");
    Float(GAIN, |on| on.report.ms1.static_gain) column(12, "sg1") log(14, "sg1");
    Float(GAIN, |on| on.report.ms2.static_gain) column(13, "sg2") log(15, "sg2");
    Float(PER_SECOND, |on| on.report.ms1.bandwidth) column(14, "bw1") log(16, "bw1");
    Count("", |on| flags(&on.report.ms1)) log(10, "ms1", 20, 4);
    Count("", |on| flags(&on.report.ms2)) log(10, "ms2", 24, 4);

    // Its residuals: ry1 and ry2 exist before the others do, for they have no mean to subtract. A log has all of them from then on.
    Float(DEGC, |on| difference(on.report.y1, on.report.ms1.prediction)) column(15, "ry1");
    Float(DEGC, |on| difference(on.report.y2, on.report.ms2.prediction)) column(16, "ry2");
    Float(PER_CENT, |on| on.residual(Rap)) column(17, "rap");
    Float(DEGC, |on| on.residual(Ry12)) column(18, "ry12");
    Float(GAIN, |on| on.residual(Rsg1)) column(19, "rsg1");
    Float(GAIN, |on| on.residual(Rsg2)) column(20, "rsg2");
    Float(PER_SECOND, |on| on.residual(Rbw1)) column(21, "rbw1");
    Float(DEGC, |on| on.report.features_filtered.map(|f| f[Ry1 as usize])) column(22, "ry1_f");
    Float(DEGC, |on| on.report.features_filtered.map(|f| f[Ry2 as usize])) column(23, "ry2_f");
    Float(DEGC, |on| on.filtered(Ry1)) log(17, "ry1_f");
    Float(DEGC, |on| on.filtered(Ry2)) log(18, "ry2_f");
    Float(PER_CENT, |on| on.filtered(Rap)) column(24, "rap_f") log(19, "rap_f");
    Float(DEGC, |on| on.filtered(Ry12)) column(25, "ry12_f") log(20, "ry12_f");
    Float(GAIN, |on| on.filtered(Rsg1)) column(26, "rsg1_f") log(21, "rsg1_f");
    Float(GAIN, |on| on.filtered(Rsg2)) column(27, "rsg2_f") log(22, "rsg2_f");
    Float(PER_SECOND, |on| on.filtered(Rbw1)) column(28, "rbw1_f") log(23, "rbw1_f");
    // The low-passed ones in units of their thresholds.
    Float("", |on| on.in_thresholds(Rap)) field(15, "rap");
    Float("", |on| on.in_thresholds(Ry12)) field(16, "ry12");
    Float("", |on| on.in_thresholds(Rsg1)) field(17, "rsg1");
    Float("", |on| on.in_thresholds(Rsg2)) field(18, "rsg2");
    Float("", |on| on.in_thresholds(Rbw1)) field(19, "rbw1");

    // Its verdict.
    Float("", |on| on.symptom(Rap)) column(29, "s_rap");
    Float("", |on| on.symptom(Ry12)) column(30, "s_ry12");
    Float("", |on| on.symptom(Rsg1)) column(31, "s_rsg1");
    Float("", |on| on.symptom(Rsg2)) column(32, "s_rsg2");
    Float("", |on| on.symptom(Rbw1)) column(33, "s_rbw1");
    Count("", |on| symptoms(on.report)) log(SYMPTOMS, "symptoms");
    Judged("", |on| on.report.filtered.map(|v| v.fdv)) column(34, "fdv") field(20, "fdv") log(25, "fdv", 0, 8) metric("pt326_fdv", "Fault detection vector", "");
    Judged("", |on| on.report.filtered.map(|v| v.fiv)) column(35, "fiv") field(21, "fiv") log(25, "fiv", 8, 8) metric("pt326_fiv", "Fault isolation vector", "");
    Judged("", |on| on.report.raw.map(|v| v.fdv)) column(36, "fdv_raw") log(25, "fdv_raw", 16, 8);
    Judged("", |on| on.report.raw.map(|v| v.fiv)) column(37, "fiv_raw") log(25, "fiv_raw", 24, 8);

    // The likelihood diagnosis.
    Named("", |on| on.report.likelihood.readiness.numbered()) field(14, "readiness") log(26, "readiness", 0, 4);
    Count("", |on| u32::from(on.report.likelihood.alarm)) column(40, "alarm") field(22, "alarm") log(26, "alarm", 4, 1) metric("pt326_alarm", "Whether the likelihood diagnosis is alarmed", "");
    Count("", |on| u32::from(on.report.likelihood.advice)) column(49, "advice") field(45, "advice") log(26, "advice", 5, 1) metric("pt326_advice", "Whether that alarm is advice: it creeps, has stood for an hour, or is known to the user", "");
    // What the user has said of an alarm: for how many ticks it is to be advice, -1 until it ends.
    Float("", |on| on.tick.shelve.map(shelved)) column(50, "shelve");
    Choice("", |on| on.finding().map(|f| (f.class.number(), f.class.name()))) column(41, "verdict") field(23, "class") log(26, "class", 8, 8);
    Float("", |on| on.finding().map(|f| f.confidence)) column(42, "confidence") field(24, "confidence") log(27, "confidence");
    // In the unit of its class, with half of its 95 % interval.
    Float("", |on| on.magnitude().map(|(_, m)| m.value)) column(43, "magnitude") field(25, "magnitude") log(28, "magnitude") metric("pt326_magnitude", "Estimated size of the fault that is named", "");
    Choice("", |on| on.magnitude().map(|(f, _)| (0, f.class.unit()))) column(44, "magnitude_unit");
    Float("", |on| on.magnitude().map(|(_, m)| m.half_width)) field(26, "half_width") log(29, "half_width");
    Tick("s", |on| on.finding().map(|f| f.onset)) column(45, "onset_s") field(27, "onset") log(30, "onset");
    // The fault of the user's own that it is: its place among those that were taught, and its size, % of what was taught.
    Place("", |on| on.report.likelihood.taught.map(|taught| u32::from(taught.place) + 1)) column(48, "taught") field(43, "taught") log(26, "taught", 16, 16);
    Float(PER_CENT, |on| on.report.likelihood.taught.map(|taught| taught.magnitude.value)) field(44, "taught_size");
    // Of a simulated rig; the only one that no instrument knows.
    Count("", |on| u32::from(on.truth)) column(39, "truth") field(28, "truth");
    // What is known of the rig's other inputs: share of the nominal voltage, and % of the usual level.
    Float("", |on| on.tick.known.supply) column(46, "supply");
    Float(PER_CENT, |on| on.tick.known.fan.map(|level| level.0)) column(47, "fan_pct");
}

// They have their bits in a log, those that need not be defined with room for none.
const _: () = assert!(Mode::NAMES.len() <= 1 << 4 && Validity::NAMES.len() <= 1 << 4);
const _: () = assert!(TripReason::NAMES.len() < 1 << 4 && Blocker::NAMES.len() < 1 << 3);
const _: () = assert!(Readiness::NAMES.len() <= 1 << 4);

impl Moment<'_> {
    fn trip(&self) -> Option<(u32, &'static str)> {
        match &self.tick.mode {
            Mode::Tripped(trip) => Some(trip.reason.numbered()),
            _ => None,
        }
    }

    fn finding(&self) -> Option<Finding> {
        self.report.likelihood.finding
    }

    fn magnitude(&self) -> Option<(Finding, Magnitude)> {
        self.finding().and_then(|finding| Some((finding, finding.magnitude?)))
    }

    fn residual(&self, residual: Residual) -> Option<f32> {
        self.report.residuals.map(|r| r[residual as usize])
    }

    fn filtered(&self, residual: Residual) -> Option<f32> {
        self.report.residuals_filtered.map(|r| r[residual as usize])
    }

    fn in_thresholds(&self, residual: Residual) -> Option<f32> {
        let (i, normal) = (residual as usize, self.normal?);
        self.report.filtered?;
        Some((self.report.features_filtered?[i] - normal.mean[i]) / (self.sigma_factor * normal.sigma[i]))
    }

    fn symptom(&self, residual: Residual) -> Option<f32> {
        let place = DECISIVE.iter().position(|decisive| *decisive == residual);
        self.report.filtered.zip(place).map(|(verdict, i)| f32::from(verdict.symptoms[i].sign()))
    }

    /// Share, 0 to 1, of what is unusual since the onset that a class would explain by itself.
    pub(super) fn share(&self, class: FaultClass) -> Option<f32> {
        let all = self.explained?.iter();
        all.filter(|(of, _)| *of == class).map(|(_, share)| *share).reduce(f32::max)
    }
}

fn difference(a: Option<f32>, b: Option<f32>) -> Option<f32> {
    a.zip(b).map(|(a, b)| a - b)
}

fn flags(o: &Identified) -> u32 {
    u32::from(o.held)
        | u32::from(o.gain_held) << 1
        | u32::from(o.bandwidth_held) << 2
        | u32::from(o.diverged) << 3
}

/// Ticks for which what is told is to be advice; -1 until it ends.
fn shelved(how: Shelving) -> f32 {
    match how {
        Shelving::UntilItEnds => -1.0,
        Shelving::For(ticks) => ticks as f32,
    }
}

/// Two bits a symptom: filtered from bit 0, raw from bit 16; 0 normal, 1 high, 2 low. Not defined where nothing is judged.
fn symptoms(report: &Report) -> Option<u32> {
    let bits = |symptoms: &Symptoms| {
        symptoms.iter().rev().fold(0, |bits, symptom| {
            bits << 2
                | match symptom {
                    Symptom::Normal => 0,
                    Symptom::High => 1,
                    Symptom::Low => 2,
                }
        })
    };
    let (filtered, raw) = (report.filtered.as_ref()?, report.raw.as_ref()?);
    Some(bits(&filtered.symptoms) | bits(&raw.symptoms) << 16)
}
