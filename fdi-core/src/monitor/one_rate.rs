//! The instrument's second half at one sample time, for a rig under another control.

mod asked;

use super::anew::Anew;
use super::{Observed, Units};
use crate::bounds::{larger, smaller};
use crate::config::Config;
use crate::diagnosis::baseline::Baseline;
use crate::diagnosis::{Diagnosis, DiagnosisState, Report};
use crate::error::{ConfigError, in_range};
use crate::known::KnownInputs;
use crate::likelihood::added::Added;
use crate::likelihood::inputs::Inputs;
use crate::likelihood::model::Model;
use crate::likelihood::start::Start;
use crate::likelihood::{FaultClass, Fitted, LikelihoodState, Readiness, RejectReason};
use crate::observation::{Observation, Phase};
use crate::root::sqrt;
use crate::sense::{Reading, Sample, Validity};
use crate::units::{Celsius, Percent};

/// The diagnosis knows no longer sample times, s: it sees a slower rig as a faster one.
const LONGEST_SAMPLE: f32 = 10.0;

/// The same settings for a rig that is `factor` times as fast.
fn faster(config: &Config, factor: f32) -> Config {
    let mut config = config.clone();
    for time in [
        &mut config.sample_time,
        &mut config.identification.answer_time,
        &mut config.identification.dead_time,
        &mut config.likelihood.fit_time,
        &mut config.likelihood.check_time,
    ] {
        time.0 /= factor;
    }
    config
}

/// For how many samples a thermistor has repeated itself, and between what the model expected of it meanwhile, degC.
#[derive(Clone, Copy, Debug, Default)]
struct Still {
    value: Option<f32>,
    run: u32,
    expected: Option<[f32; 2]>,
}

/// A thermistor is stuck when it has repeated itself for so many samples while it should have moved by so much, degC, and by so many times what the
/// model leaves of it in the mean. Of a room nobody knows how it should have moved.
const REPEATS: u32 = 60;
const SHOULD_MOVE: f32 = 3.0;
const LEFT: f32 = 4.0;

impl Still {
    fn step(&mut self, value: Option<f32>, expected: Option<f32>, left: f32) -> bool {
        if value.is_none() {
            return false;
        }
        if value != self.value {
            *self = Self { value, ..Self::default() };
        }
        self.run = self.run.saturating_add(1);
        let Some(expected) = expected else { return false };
        let [low, high] = self.expected.unwrap_or([expected; 2]);
        let [low, high] = *self.expected.insert([smaller(low, expected), larger(high, expected)]);
        self.run > REPEATS && high - low > larger(SHOULD_MOVE, LEFT * left)
    }
}

/// Over a gap of more than this share of what the rig takes to answer, and of so many samples, nobody knows what it did.
const GAP: f32 = 0.5;
const LEAST_GAP: f32 = 5.0;

/// A diagnosis that only looks on, at one sample time.
#[derive(Clone, Debug)]
pub(super) struct OneRate {
    diagnosis: Diagnosis,
    state: DiagnosisState,
    inputs: Inputs,
    units: Units,
    /// Seconds for each second of the diagnosis, and its own sample time.
    time: f32,
    diagnosis_time: f32,
    index: u32,
    learnt: u32,
    /// What was learnt is not its own.
    given: bool,
    armed: bool,
    was_learning: bool,
    resuming: bool,
    /// The room is that of the learning.
    same_room: bool,
    /// How the rig began, while it is being found.
    start: Option<Start>,
    /// Whether an alarm is over, from whatever state, where T2 is measured.
    anew: Option<Anew>,
    /// What T1 reads beyond the model, degC.
    beyond: Option<f32>,
    /// What the ends of alarms added to the model.
    added: Added,
    /// Samples since the last with a power or a T1.
    gap: u32,
    /// The T1 with which learning began: it stands for a T0 that is missing.
    base: Option<f32>,
    last: [f32; 3],
    still: [Still; 3],
    /// What T0, T1 and T2 should have read on the last tick, degC, and what the model leaves in the mean.
    expected: [Option<f32>; 3],
    left: f32,
    power: f32,
}

impl OneRate {
    /// A monitor that has seen nothing.
    ///
    /// # Errors
    /// The setting, or the unit, that is out of bounds.
    pub(super) fn new(config: &Config, inputs: Inputs, units: Units) -> Result<Self, ConfigError> {
        let time = larger(1.0, config.sample_time.0 / LONGEST_SAMPLE);
        let diagnosis = Diagnosis::new(&faster(config, time))?.with(inputs);
        in_range("units.celsius", units.celsius, 1e-6, 1e6)?;
        in_range("units.full_power", units.full_power, 1e-6, 1e9)?;
        let state = diagnosis.start();
        let (index, learnt, given, armed, was_learning, resuming, base) =
            (0, 0, false, false, false, false, None);
        let (last, power, start, gap) = ([0.0; 3], 0.0, None, 0);
        Ok(Self {
            diagnosis,
            state,
            inputs,
            units,
            time,
            diagnosis_time: config.sample_time.0 / time,
            index,
            learnt,
            given,
            armed,
            was_learning,
            resuming,
            same_room: false,
            start,
            anew: None,
            beyond: None,
            added: Added::default(),
            gap,
            base,
            last,
            still: [Still::default(); 3],
            expected: [None; 3],
            left: 0.0,
            power,
        })
    }

    /// One sample: what is believed of it, and the report on it.
    pub(super) fn step(&mut self, observed: &Observed) -> (Observation, Report) {
        let gone = observed.power.is_none() && observed.t[1].is_none();
        self.resuming |= !gone && self.gap > 0 && self.gap > self.longest_gap();
        self.gap = if gone { self.gap.saturating_add(1) } else { 0 };
        let seen = self.see(observed);
        if !gone && core::mem::take(&mut self.resuming) {
            self.diagnosis.resume(&mut self.state, seen.power.0, &seen.known);
            self.start = self.diagnosis.start_of_rig(&self.state, self.same_room);
            self.added = Added::default();
        }
        if self.asks() {
            self.diagnosis.before_an_end(&self.state, &mut self.added);
        }
        let mut report = self.diagnosis.step(&mut self.state, &seen);
        self.diagnosis.follow_added(&self.state, &mut self.added);
        self.armed = report.likelihood.readiness == Readiness::Armed;
        let beyond = beyond(&seen, &report);
        self.beyond = beyond[0];
        if self.inputs.t2 {
            Anew::look(&mut self.anew, &self.diagnosis, &mut self.state, beyond);
        }
        self.find_start(&seen, &mut report);
        let [_, t1, t2] = report.likelihood.expected;
        self.expected = [None, t1, t2];
        self.to_units(&mut report);
        (self.in_units(seen), report)
    }

    pub(super) fn inputs(&self) -> Inputs {
        self.inputs
    }

    pub(super) fn units(&self) -> Units {
        self.units
    }

    /// The next sample is the first of another recording of the same rig.
    pub(super) fn resume(&mut self) {
        (self.resuming, self.same_room) = (true, false);
    }

    /// Is armed with a model that was fitted elsewhere.
    ///
    /// # Errors
    /// Why it cannot be trusted.
    pub(super) fn take(&mut self, fitted: &Fitted) -> Result<(), RejectReason> {
        self.diagnosis.take(&mut self.state, fitted)?;
        (self.base, self.given, self.armed, self.resuming) = (Some(fitted.base), true, true, true);
        (self.same_room, self.left) = (
            true,
            sqrt(
                fitted.left.iter().map(|([e, _], _)| e * e).sum::<f32>()
                    / larger(1.0, fitted.left.len() as f32),
            ),
        );
        Ok(())
    }

    /// Over so many samples without power and T1 nobody knows what the rig did.
    fn longest_gap(&self) -> u32 {
        self.diagnosis.model(&self.state).map_or(u32::MAX, |model| {
            let answers = (model.heater + model.lag + model.dead_time) / self.diagnosis_time;
            (GAP * answers).max(LEAST_GAP) as u32
        })
    }

    /// What is seen of how the rig began; until it is known nobody knows what to expect.
    fn find_start(&mut self, seen: &Observation, report: &mut Report) {
        let Some(start) = &mut self.start else { return };
        if start.step(beyond(seen, report)) {
            self.diagnosis.settle(&mut self.state, start);
            self.start = None;
        }
        report.likelihood.expected = [None; 3];
    }

    /// What was learnt; its degC and % are those of [`Units`].
    pub(super) fn model(&self) -> Option<Model> {
        let mut model = self.diagnosis.model(&self.state)?;
        let Model { heater, lag, wall, dead_time, lag2, transport, lag_beside, .. } = &mut model;
        for time in [heater, lag, wall, dead_time, lag2, transport, lag_beside] {
            *time *= self.time;
        }
        Some(model)
    }

    /// What the signatures take for normal.
    pub(super) fn baseline(&self) -> Option<&Baseline> {
        self.diagnosis.baseline(&self.state)
    }

    /// The memory of the likelihood diagnosis, for those who ask what it could tell.
    pub(super) fn likelihood(&self) -> &LikelihoodState {
        &self.state.likelihood
    }

    fn see(&mut self, observed: &Observed) -> Observation {
        let percent = |power: Option<f32>| power.map(|u| 100.0 * u / self.units.full_power);
        let [t0, t1, t2] = observed.t.map(|t| t.map(|t| t * self.units.celsius));
        self.power = percent(observed.power).unwrap_or(self.power).clamp(0.0, 100.0);
        let beside = percent(observed.beside).map(Percent);
        let begins = !core::mem::replace(&mut self.was_learning, observed.learn) && observed.learn;
        let anew = begins && self.learnt > 0 && !self.given;
        let learn = observed.learn && (!self.armed || anew || self.given);
        // What began to be learnt with a wild T1 ends with a training that is refused: the next one begins with another.
        let learns = self.state.likelihood.learns() && !anew;
        self.base = if learns { self.base.or(t1) } else { t1.or(self.base) };
        if learn && !learns {
            self.state.likelihood.forget_before_learning();
        }
        let t0 = if self.inputs.t0 { t0 } else { self.base };
        let t2 = if self.inputs.t2 { t2 } else { t1 };
        self.learnt = self.learnt.saturating_add(u32::from(learn));
        let phase = match (learn, self.learnt) {
            (true, _) => Phase::Learning,
            (false, 0) if !self.given => Phase::Heated,
            (false, _) => Phase::Watched,
        };
        let index = self.index;
        self.index = index.saturating_add(1);
        Observation {
            index,
            sample: Sample { t0: self.reading(0, t0), t1: self.reading(1, t1), t2: self.reading(2, t2) },
            power: Percent(self.power),
            phase,
            excited: false,
            learn,
            forget: false,
            shelve: None,
            known: KnownInputs {
                supply: observed.supply,
                supply_lost: 0,
                fan: observed.fan.map(Percent),
                beside,
            },
        }
    }

    fn reading(&mut self, which: usize, t: Option<f32>) -> Reading {
        let measured = [self.inputs.t0, true, self.inputs.t2].get(which) == Some(&true);
        let still = self.still.get_mut(which).filter(|_| measured);
        let expected = self.expected.get(which).copied().flatten().filter(|_| self.armed);
        let stuck = still.is_some_and(|still| still.step(t, expected, self.left));
        let validity = match t {
            Some(_) if stuck => Validity::Stuck,
            Some(_) => Validity::Good,
            None => Validity::Missing,
        };
        if let (Some(last), Some(t)) = (self.last.get_mut(which), t) {
            *last = t;
        }
        Reading { celsius: Celsius(self.last.get(which).copied().unwrap_or(0.0)), validity }
    }

    /// Temperatures in the recording's unit again.
    fn in_units(&self, mut seen: Observation) -> Observation {
        for reading in [&mut seen.sample.t0, &mut seen.sample.t1, &mut seen.sample.t2] {
            reading.celsius.0 /= self.units.celsius;
        }
        seen
    }

    fn to_units(&self, report: &mut Report) {
        let inverse = 1.0 / self.units.celsius;
        for expected in report.likelihood.expected.iter_mut().flatten() {
            *expected *= inverse;
        }
        let finding = report.likelihood.finding.as_mut();
        if let Some(finding) = finding.filter(|finding| finding.class.unit().starts_with("degC"))
            && let Some(magnitude) = &mut finding.magnitude
        {
            let inverse = if finding.class == FaultClass::Drift { inverse / self.time } else { inverse };
            magnitude.value *= inverse;
            magnitude.half_width *= inverse;
        }
    }
}

/// What T1 and T2 read beyond the model, degC.
fn beyond(seen: &Observation, report: &Report) -> [Option<f32>; 2] {
    let [_, t1, t2] = report.likelihood.expected;
    let beyond = |reading: Reading, expected: Option<f32>| Some(reading.good()? - expected?);
    [beyond(seen.sample.t1, t1), beyond(seen.sample.t2, t2)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::likelihood::LikelihoodReport;

    /// A heater of one lag, 0.3 degC a %, with T1 and T2 behind it, and the monitor that looks on.
    struct Watched {
        monitor: OneRate,
        rise: f32,
        k: u32,
    }

    impl Watched {
        fn trained() -> Self {
            let mut config = Config::default();
            (config.likelihood.fit_time.0, config.likelihood.check_time.0) = (40.0, 20.0);
            let monitor =
                OneRate::new(&config, Inputs::ALL, Units::default()).expect("the settings are valid");
            let mut watched = Self { monitor, rise: 12.0, k: 0 };
            let last = (0..800).map(|_| watched.tick(true)).last();
            assert!(last.is_some_and(|last| last.readiness == Readiness::Armed), "{last:?}");
            watched
        }

        fn tick(&mut self, learn: bool) -> LikelihoodReport {
            let random = |k: u32| (k.wrapping_mul(0x9E37_79B9) >> 8) as f32 / (1 << 23) as f32 - 1.0;
            let power = if random(self.k / 4) > 0.0 { 46.0 } else { 34.0 };
            let noise = [1, 2, 3].map(|m| 0.05 * random(self.k.wrapping_mul(7).wrapping_add(m)));
            let t = [22.0 + noise[0], 22.0 + self.rise + noise[1], 22.0 + 0.9 * self.rise + noise[2]];
            self.rise += 0.2 * (0.3 * power - self.rise);
            self.k += 1;
            let observed = Observed { t: t.map(Some), power: Some(power), learn, ..Observed::default() };
            self.monitor.step(&observed).1.likelihood
        }
    }

    /// Within some seconds, whichever number it is: said once and for all, counted, and trained again when somebody says that all is well.
    #[test]
    fn a_memory_that_is_no_number_is_said_and_begins_anew() {
        let trained = Watched::trained();
        let places = { trained.monitor.state.likelihood }.spoil(usize::MAX);
        assert!(places > 10);
        for which in 0..places {
            let mut watched = Watched { monitor: trained.monitor.clone(), ..trained };
            watched.monitor.state.likelihood.spoil(which);
            let said = (0..200).map(|_| watched.tick(false)).find(|said| said.readiness != Readiness::Armed);
            let said = said.unwrap_or_else(|| panic!("place {which}: armed, and blind"));
            assert_eq!(
                (said.readiness, said.restarts, said.alarm),
                (Readiness::Restarted, 1, false),
                "place {which}"
            );
            assert_eq!(
                watched.tick(false).readiness,
                Readiness::Restarted,
                "place {which}: until it is trained"
            );
            let last = (0..800).map(|_| watched.tick(true)).last();
            let armed = last.map(|last| (last.readiness, last.restarts));
            assert_eq!(armed, Some((Readiness::Armed, 1)), "place {which}");
        }
    }
}
