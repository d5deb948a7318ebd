//! A hash over every bit of what the instrument says.
//!
//! The structures are taken apart by name and in full: a field added to one of them does not compile until it is
//! hashed too.

use fdi_core::diagnosis::baseline::{Baseline, Normal};
use fdi_core::diagnosis::event::{Event, Fault};
use fdi_core::diagnosis::{Report, Verdict};
use fdi_core::identify::observer::Identified;
use fdi_core::likelihood::verdict::TaughtFinding;
use fdi_core::likelihood::{Finding, LikelihoodReport, Magnitude, Readiness};
use fdi_core::supervisor::{Mode, Trip};
use fdi_core::{KnownInputs, RawSample, Reading, Sample, Tick};

/// FNV-1a over words of 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// The hash so far.
    pub fn value(self) -> u64 {
        self.0
    }

    /// Hashes a word.
    pub fn word(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3);
    }

    /// Hashes a number by its bits. All NaNs count as one: neither Rust nor IEEE 754 says which an operation gives.
    pub fn number(&mut self, x: f32) {
        self.word(if x.is_nan() { f32::NAN.to_bits() } else { x.to_bits() });
    }

    /// Hashes each number of a list.
    pub fn numbers(&mut self, numbers: &[f32]) {
        for &x in numbers {
            self.number(x);
        }
    }

    /// Hashes a value that may be missing, so that a missing one differs from any that is there.
    pub fn option<T>(&mut self, value: Option<T>, take: impl FnOnce(&mut Self, T)) {
        self.word(u32::from(value.is_some()));
        if let Some(value) = value {
            take(self, value);
        }
    }

    /// All of the first half of a tick.
    pub fn tick(&mut self, tick: &Tick) {
        let Tick {
            index,
            sample,
            setpoint,
            pid,
            prbs,
            drive,
            mode,
            // Where it has come so far shows in what it drives.
            tuning: _,
            learn,
            blocked,
            virtual_t1,
            forget,
            // It is said of an alarm, and shows in what is advice.
            shelve: _,
            known,
        } = *tick;
        self.word(index);
        self.sample(sample);
        self.numbers(&[setpoint.0, pid.0, prbs.0, drive.0]);
        self.mode(mode);
        self.word(u32::from(learn));
        self.word(u32::from(forget));
        self.option(blocked, |d, blocker| d.word(blocker as u32));
        self.option(virtual_t1, |d, celsius| d.number(celsius.0));
        // A board knows of no heater beside.
        let KnownInputs { supply, supply_lost, fan, beside: _ } = known;
        self.option(supply, Self::number);
        self.word(supply_lost);
        self.option(fan, |d, level| d.number(level.0));
    }

    /// All of the second half of a tick.
    pub fn report(&mut self, report: &Report) {
        let Report {
            tick,
            y1,
            y2,
            ms1,
            ms2,
            features,
            features_filtered,
            residuals,
            residuals_filtered,
            filtered,
            raw,
            learned,
            events,
            likelihood,
        } = report;
        self.word(*tick);
        for y in [*y1, *y2] {
            self.option(y, Self::number);
        }
        for model in [ms1, ms2] {
            self.observation(model);
        }
        for numbers in [features, features_filtered, residuals, residuals_filtered] {
            self.option(numbers.as_ref(), |d, n| d.numbers(n));
        }
        for verdict in [filtered, raw] {
            self.option(verdict.as_ref(), Self::verdict);
        }
        self.word(*learned);
        for event in events {
            self.event(event);
        }
        self.likelihood(likelihood);
    }

    /// All that was learnt.
    pub fn baseline(&mut self, baseline: &Baseline) {
        let Baseline { samples, raw, filtered } = baseline;
        self.word(*samples);
        for Normal { mean, sigma } in [raw, filtered] {
            self.numbers(mean);
            self.numbers(sigma);
        }
    }

    fn sample(&mut self, sample: Sample) {
        let Sample { t0, t1, t2 } = sample;
        for Reading { celsius, validity } in [t0, t1, t2] {
            self.number(celsius.0);
            self.word(validity as u32);
        }
    }

    fn mode(&mut self, mode: Mode) {
        match mode {
            Mode::Off => self.word(0),
            Mode::Settle { steady } => self.numbered(1, steady),
            Mode::Learn { accepted } => self.numbered(2, accepted),
            Mode::Monitor => self.word(3),
            Mode::Tune => self.word(5),
            Mode::Tripped(Trip {
                reason,
                tick,
                raw: RawSample { t0, t1, t2, supply },
                sample,
                setpoint,
                limit,
                power,
                needed,
            }) => {
                self.numbered(4, reason as u32);
                self.word(tick);
                self.numbers(&[t0.0, t1.0, t2.0, supply.0, setpoint.0, limit.0, power.0]);
                self.option(needed, |d, needed| d.number(needed.0));
                self.sample(sample);
            }
        }
    }

    fn numbered(&mut self, kind: u32, number: u32) {
        self.word(kind);
        self.word(number);
    }

    fn observation(&mut self, model: &Identified) {
        let Identified {
            prediction,
            static_gain,
            bandwidth,
            held,
            gain_held,
            bandwidth_held,
            diverged,
            resets,
        } = *model;
        for number in [prediction, static_gain, bandwidth] {
            self.option(number, Self::number);
        }
        for flag in [held, gain_held, bandwidth_held, diverged] {
            self.word(u32::from(flag));
        }
        self.word(resets);
    }

    fn verdict(&mut self, verdict: &Verdict) {
        let Verdict { symptoms, fdv, fiv } = verdict;
        for symptom in symptoms {
            self.word(symptom.sign() as u32);
        }
        self.numbered(u32::from(*fdv), u32::from(*fiv));
    }

    fn likelihood(&mut self, report: &LikelihoodReport) {
        let LikelihoodReport {
            readiness,
            alarm,
            advice,
            finding,
            t1_contradicted,
            taught,
            expected,
            virtual_rise,
            air_flow,
            heater_stuck_on,
            restarts,
        } = report;
        match *readiness {
            Readiness::Untrained => self.word(0),
            Readiness::Training => self.word(1),
            Readiness::Refused(why) => self.numbered(2, why as u32),
            Readiness::Armed => self.word(3),
            Readiness::Restarted => self.word(4),
        }
        self.word(u32::from(*alarm));
        self.word(u32::from(*advice));
        self.word(u32::from(*t1_contradicted));
        let size = |d: &mut Self, Magnitude { value, half_width }| d.numbers(&[value, half_width]);
        self.option(finding.as_ref(), |d, finding| {
            let Finding { class, confidence, magnitude, onset } = *finding;
            class.name().bytes().for_each(|letter| d.word(u32::from(letter)));
            d.number(confidence);
            d.option(magnitude, size);
            d.word(onset);
        });
        self.option(*taught, |d, TaughtFinding { name: _, place, confidence, magnitude }| {
            d.word(u32::from(place));
            d.number(confidence);
            size(d, magnitude);
        });
        expected.iter().for_each(|t| self.option(*t, Self::number));
        self.option(*virtual_rise, Self::number);
        self.option(*air_flow, Self::number);
        self.word(u32::from(*heater_stuck_on));
        self.word(*restarts);
    }

    fn event(&mut self, event: &Event) {
        let (kind, fault) = match event {
            Event::Detected(fault) => (0, fault),
            Event::Isolated(fault) => (1, fault),
            Event::Ended(fault) => (2, fault),
        };
        let Fault { detection_number, isolation_number, onset, detected, isolated, last_seen } = *fault;
        self.numbered(kind, u32::from(detection_number));
        self.numbered(u32::from(isolation_number), onset);
        self.numbered(detected, last_seen);
        self.option(isolated, Self::word);
    }
}
