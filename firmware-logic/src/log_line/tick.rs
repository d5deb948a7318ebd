//! The record of one tick, as the log carries it: the bits of what went in and of what came out, so that a replay on
//! the host can run the core again and compare. It is text of 32 hexadecimal words after "tick ", in the order of
//! [`FIELDS`]; a number that is not defined on the tick is written as [`NONE`].

use core::fmt;

use fdi_core::diagnosis::Verdict;
use fdi_core::diagnosis::signature::{Symptom, Symptoms};
use fdi_core::identify::observer::Estimate;
use fdi_core::likelihood::{LikelihoodReport, Readiness, RejectReason};
use fdi_core::supervisor::Blocker;
use fdi_core::{AdcCode, Mode, Percent, RawSample, Report, Validity};

use crate::control_loop::TickRecord;

/// Words in a record.
pub const WORDS: usize = 32;

/// Characters of the longest record: "tick", and a blank and 8 digits a word.
pub const LONGEST: usize = 4 + 9 * WORDS;

/// Names of the words. Plain numbers are `f32` bits.
#[rustfmt::skip]
pub const FIELDS: [&str; WORDS] = [
    "tick", "timing", "t0_code", "t1_code", "t2_code", "setpoint", "pid", "prbs", "drive", "applied",
    "state", "learned", "y1m", "y2m", "sg1", "sg2", "bw1", "ry1_f", "ry2_f", "rap_f", "ry12_f", "rsg1_f",
    "rsg2_f", "rbw1_f", "symptoms", "vectors", "likelihood", "confidence", "magnitude", "half_width", "onset",
    "supply_code",
];

/// Names of the modes by the numbers of the word "state".
pub const MODES: [&str; 6] = ["off", "settle", "learn", "monitor", "tripped", "tune"];

/// The readiness of a likelihood diagnosis that watches.
pub const ARMED: u32 = 2;
/// That of one that has begun anew because its memory held what is no number.
pub const RESTARTED: u32 = 7;

/// "Not defined": a NaN that no arithmetic gives.
pub const NONE: u32 = u32::MAX;

/// Set in the word "timing" where the tick never began; the bits below are its lateness in µs.
const MISSED: u32 = 1 << 31;

/// One tick as words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickLine(pub [u32; WORDS]);

impl TickLine {
    /// The record of a tick.
    pub fn new(record: &TickRecord, report: &Report) -> Self {
        let tick = &record.tick;
        let timing = if record.missed { MISSED } else { record.arrival.late_us };
        let numbers = |x: Option<f32>| x.map_or(NONE, f32::to_bits);
        let (raw, filtered) = (&record.raw, report.residuals_filtered.as_ref());
        let residual = |i: usize| numbers(filtered.and_then(|filtered| filtered.get(i).copied()));
        let finding = &report.likelihood.finding;
        let magnitude = finding.and_then(|finding| finding.magnitude);
        Self([
            tick.index,
            timing,
            raw.t0.0.to_bits(),
            raw.t1.0.to_bits(),
            raw.t2.0.to_bits(),
            tick.setpoint.0.to_bits(),
            tick.pid.0.to_bits(),
            tick.prbs.0.to_bits(),
            tick.drive.0.to_bits(),
            record.applied.0.to_bits(),
            state(record, report),
            report.learned,
            numbers(report.ms1.prediction),
            numbers(report.ms2.prediction),
            numbers(report.ms1.static_gain),
            numbers(report.ms2.static_gain),
            numbers(report.ms1.bandwidth),
            residual(0),
            residual(1),
            residual(2),
            residual(3),
            residual(4),
            residual(5),
            residual(6),
            symptoms(report),
            vectors(report),
            likelihood(&report.likelihood),
            numbers(finding.map(|finding| finding.confidence)),
            numbers(magnitude.map(|magnitude| magnitude.value)),
            numbers(magnitude.map(|magnitude| magnitude.half_width)),
            finding.map_or(NONE, |finding| finding.onset),
            raw.supply.0.to_bits(),
        ])
    }

    /// Number of the tick.
    pub fn tick(&self) -> u32 {
        self.0[0]
    }

    /// The word of this name in [`FIELDS`]; [`NONE`] where there is none.
    pub fn word(&self, name: &str) -> u32 {
        FIELDS.iter().position(|field| *field == name).map_or(NONE, |i| self.0[i])
    }

    /// The mode, as a place in [`MODES`].
    pub fn mode(&self) -> u32 {
        self.word("state") & 0xF
    }

    /// What kept the tick from being learnt, from 1 in the order of [`Blocker`]; 0 is nothing.
    pub fn blocked(&self) -> u32 {
        self.word("state") >> 17 & 7
    }

    /// How far the likelihood diagnosis is: not trained, in training, [`ARMED`], [`RESTARTED`], or refused and why.
    pub fn readiness(&self) -> u32 {
        self.word("likelihood") & 0xF
    }

    /// Codes that went in.
    pub fn raw(&self) -> RawSample {
        let [t0, t1, t2, supply] = [2, 3, 4, 31].map(|i: usize| AdcCode(f32::from_bits(self.0[i])));
        RawSample { t0, t1, t2, supply }
    }

    /// What the heater got.
    pub fn applied(&self) -> Percent {
        Percent(f32::from_bits(self.0[9]))
    }

    /// The tick never began.
    pub fn missed(&self) -> bool {
        self.0[1] & MISSED != 0
    }

    /// Microseconds that the tick began late.
    pub fn late_us(&self) -> u32 {
        self.0[1] & !MISSED
    }

    /// Names of the words that differ, with the words; all NaN codes are one.
    pub fn differences(&self, other: &Self) -> impl Iterator<Item = (&'static str, u32, u32)> {
        let pairs = self.0.into_iter().zip(other.0);
        FIELDS.into_iter().zip(pairs).filter_map(|(name, (a, b))| (a != b).then_some((name, a, b)))
    }
}

impl fmt::Display for TickLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("tick")?;
        self.0.iter().try_for_each(|word| write!(f, " {word:x}"))
    }
}

/// The same text, put together where the log is decoded.
#[cfg(feature = "defmt")]
impl defmt::Format for TickLine {
    #[rustfmt::skip]
    fn format(&self, f: defmt::Formatter<'_>) {
        let w = &self.0;
        defmt::write!(
            f,
            "tick {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} \
             {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} \
             {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x}",
            w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7], w[8], w[9], w[10], w[11], w[12],
            w[13], w[14], w[15], w[16], w[17], w[18], w[19], w[20], w[21], w[22], w[23], w[24], w[25],
            w[26], w[27], w[28], w[29], w[30], w[31],
        );
    }
}

/// Why a line is no record of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TickLineError {
    /// It has another number of words.
    Words {
        /// How many.
        found: usize,
    },
    /// A word is no hexadecimal number of up to 8 digits.
    Word {
        /// The name of the word.
        name: &'static str,
    },
}

impl fmt::Display for TickLineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Words { found } => write!(f, "record has {found} words, expected {WORDS}"),
            Self::Word { name } => write!(f, "{name}: expected a hexadecimal number of up to 8 digits"),
        }
    }
}

impl core::error::Error for TickLineError {}

/// Parses what follows "tick ", as far as it belongs to the record; `None` where it is a sentence that speaks of a tick.
pub(super) fn find(text: &str) -> Result<Option<TickLine>, TickLineError> {
    let words = || text.split_ascii_whitespace().take(WORDS);
    if words().count() < SENTENCE || words().take(SENTENCE).any(|digits| word(digits).is_none()) {
        return Ok(None);
    }
    let found = words().count();
    if found != WORDS {
        return Err(TickLineError::Words { found });
    }
    let mut line = TickLine([0; WORDS]);
    for ((to, name), digits) in line.0.iter_mut().zip(FIELDS).zip(words()) {
        *to = word(digits).ok_or(TickLineError::Word { name })?;
    }
    Ok(Some(line))
}

/// Words at the beginning that are all hexadecimal in no sentence.
const SENTENCE: usize = 8;

/// A hexadecimal number of up to 8 digits.
pub(super) fn word(digits: &str) -> Option<u32> {
    let plain = digits.bytes().all(|b| b.is_ascii_hexdigit()); // from_str_radix would also take a sign
    u32::from_str_radix(digits, 16).ok().filter(|_| plain)
}

/// Mode in bits 0..3, validity of T0, T1, T2 from bits 4, 8 and 12, learning in bit 16, what blocks it from bit 17, flags
/// of MS1 from bit 20 and of MS2 from bit 24.
fn state(record: &TickRecord, report: &Report) -> u32 {
    let mode = mode(&record.tick.mode);
    let blocked = match record.tick.blocked {
        None => 0,
        Some(Blocker::Saturated) => 1,
        Some(Blocker::OutOfRegulation) => 2,
        Some(Blocker::Unexcited) => 3,
        Some(Blocker::InvalidSample) => 4,
        Some(Blocker::NotSteady) => 5,
        Some(Blocker::NotIdentified) => 6,
    };
    let sample = &record.tick.sample;
    mode | validity(sample.t0.validity) << 4
        | validity(sample.t1.validity) << 8
        | validity(sample.t2.validity) << 12
        | u32::from(record.tick.learn) << 16
        | blocked << 17
        | observer(&report.ms1) << 20
        | observer(&report.ms2) << 24
}

/// Its place in [`MODES`].
fn mode(mode: &Mode) -> u32 {
    match mode {
        Mode::Off => 0,
        Mode::Settle { .. } => 1,
        Mode::Learn { .. } => 2,
        Mode::Monitor => 3,
        Mode::Tripped(_) => 4,
        Mode::Tune => 5,
    }
}

fn validity(validity: Validity) -> u32 {
    match validity {
        Validity::Good => 0,
        Validity::Missing => 1,
        Validity::Open => 2,
        Validity::Short => 3,
        Validity::OutOfRange => 4,
        Validity::Spike => 5,
        Validity::Rate => 6,
        Validity::Stuck => 7,
    }
}

fn observer(o: &Estimate) -> u32 {
    u32::from(o.held)
        | u32::from(o.gain_held) << 1
        | u32::from(o.bandwidth_held) << 2
        | u32::from(o.diverged) << 3
}

/// Two bits a symptom: filtered from bit 0, raw from bit 16; 0 normal, 1 high, 2 low. All ones where nothing is judged.
fn symptoms(report: &Report) -> u32 {
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
    match (&report.filtered, &report.raw) {
        (Some(filtered), Some(raw)) => bits(&filtered.symptoms) | bits(&raw.symptoms) << 16,
        _ => NONE,
    }
}

/// Readiness of the likelihood diagnosis in bits 0..4, its alarm in bit 4, the class that it names from bit 8, the place from 1 of the taught fault
/// from bit 16; 0 for none.
fn likelihood(report: &LikelihoodReport) -> u32 {
    let readiness = match report.readiness {
        Readiness::Untrained => 0,
        Readiness::Training => 1,
        Readiness::Armed => ARMED,
        Readiness::Refused(RejectReason::Unstable) => 3,
        Readiness::Refused(RejectReason::Gain) => 4,
        Readiness::Refused(RejectReason::PoorFit) => 5,
        Readiness::Refused(RejectReason::DeadTime) => 6,
        Readiness::Restarted => RESTARTED,
    };
    let class = report.finding.map_or(0, |finding| finding.class.number());
    let taught = report.taught.map_or(0, |taught| u32::from(taught.place) + 1);
    readiness | u32::from(report.alarm) << 4 | class << 8 | taught << 16
}

/// fdv and fiv of the filtered residuals, then of the raw ones, a byte each.
fn vectors(report: &Report) -> u32 {
    let byte =
        |verdict: &Option<Verdict>, number: fn(&Verdict) -> u8| u32::from(verdict.as_ref().map_or(0, number));
    byte(&report.filtered, |v| v.fdv)
        | byte(&report.filtered, |v| v.fiv) << 8
        | byte(&report.raw, |v| v.fdv) << 16
        | byte(&report.raw, |v| v.fiv) << 24
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_called_as_everywhere() {
        let modes =
            [Mode::Off, Mode::Settle { steady: 1 }, Mode::Learn { accepted: 1 }, Mode::Monitor, Mode::Tune];
        for each in modes {
            assert_eq!(MODES.get(mode(&each) as usize), Some(&each.name()));
        }
    }
}
