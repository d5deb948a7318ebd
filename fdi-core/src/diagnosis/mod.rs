//! The second half of a tick: identify, form residuals, compare them with what is normal, name the fault.

pub mod answer;
pub mod baseline;
pub mod config;
pub mod event;
pub mod residual;
pub mod signature;
pub mod teach;

use crate::config::Config;
use crate::error::ConfigError;
use crate::feedback::Feedback;
use crate::filter::{LowPass, LowPassState};
use crate::identify::observer::{Identified, Observer, ObserverState};
use crate::known::KnownInputs;
use crate::likelihood::added::Added;
use crate::likelihood::inputs::Inputs;
use crate::likelihood::interacting::{Found, Interacting};
use crate::likelihood::model::Model;
use crate::likelihood::start::Start;
use crate::likelihood::taught::Changed;
use crate::likelihood::{
    Channel, Commissioned, FaultClass, Fitted, Likelihood, LikelihoodReport, LikelihoodState, RejectReason,
    SinceCommissioning,
};
use crate::observation::{Observation, Phase};
use crate::units::Percent;
use answer::{Answers, Standing};
use baseline::{Baseline, Learner};
use event::{EventRules, EventState, Events};
use residual::{FIRST_DECISIVE, RESIDUALS, features};
use signature::{Symptoms, symptoms};

/// The validated diagnosis.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    ms1: Observer,
    ms2: Observer,
    low_pass: LowPass,
    sigma_factor: f32,
    detection: Answers,
    isolation: Answers,
    events: EventRules,
    likelihood: Likelihood,
}

/// The memory of the [`Diagnosis`].
#[derive(Clone, Debug)]
pub struct DiagnosisState {
    ms1: ObserverState,
    ms2: ObserverState,
    filters: LowPassState<RESIDUALS>,
    phase: Phase,
    learner: Learner,
    baseline: Option<Baseline>,
    /// Of the low-passed residuals and of the raw ones.
    standing: [Vectors; 2],
    events: EventState,
    pub(crate) likelihood: LikelihoodState,
}

/// What the tables remember of one form of the residuals.
#[derive(Clone, Copy, Debug, Default)]
struct Vectors {
    fdv: Standing,
    fiv: Standing,
}

/// The fault vectors of one form of the residuals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Verdict {
    /// Symptoms in the order of [`residual::DECISIVE`].
    pub symptoms: Symptoms,
    /// Fault detection vector.
    pub fdv: u8,
    /// Fault isolation vector.
    pub fiv: u8,
}

/// All that the diagnosis says on a tick. `None` means "not defined yet, or not on this sample".
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Report {
    /// Number of the tick.
    pub tick: u32,
    /// y1 = T1 - T0 in degC.
    pub y1: Option<f32>,
    /// y2 = T2 - T0 in degC.
    pub y2: Option<f32>,
    /// Model of y1 against the power.
    pub ms1: Identified,
    /// Model of y2 against the power.
    pub ms2: Identified,
    /// What the residuals are made of, in the order of [`residual::ALL`], before any nominal value is subtracted.
    pub features: Option<[f32; RESIDUALS]>,
    /// The same, low-passed.
    pub features_filtered: Option<[f32; RESIDUALS]>,
    /// Residuals in the order of [`residual::ALL`]: features minus their nominal mean (ry1 and ry2 as they are).
    pub residuals: Option<[f32; RESIDUALS]>,
    /// The same, low-passed.
    pub residuals_filtered: Option<[f32; RESIDUALS]>,
    /// Verdict on the low-passed residuals.
    pub filtered: Option<Verdict>,
    /// Verdict on the raw residuals.
    pub raw: Option<Verdict>,
    /// Samples that the baseline has been learnt from so far.
    pub learned: u32,
    /// What happened, by the filtered verdict.
    pub events: Events,
    /// The second opinion.
    pub likelihood: LikelihoodReport,
}

impl Report {
    /// What of it the first half of the next tick needs.
    pub fn feedback(&self) -> Feedback {
        let finding = self.likelihood.finding.filter(|finding| finding.is_sure());
        Feedback {
            learned: self.learned,
            virtual_rise: self.likelihood.virtual_rise,
            t1_faulty: finding.is_some_and(|f| f.class.sensor() == Some(Channel::T1)),
            t1_contradicted: self.likelihood.t1_contradicted,
            heater_faulty: finding.is_some_and(|f| f.class == FaultClass::HeaterPower),
            air_flow: self.likelihood.air_flow.map(Percent),
            heater_stuck_on: self.likelihood.heater_stuck_on,
            settings_damaged: false,
        }
    }
}

impl Diagnosis {
    /// Builds the diagnosis.
    ///
    /// # Errors
    /// The parameter of `identification`, `diagnosis` or `likelihood` that is out of bounds.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        let (c, ts) = (&config.diagnosis, config.sample_time);
        config.validate_general()?;
        c.validate()?;
        let identification = &config.identification;
        Ok(Self {
            ms1: Observer::new(identification, Some(identification.bandwidth), ts)?,
            ms2: Observer::new(identification, None, ts)?,
            low_pass: LowPass::new(c.filter_cutoff, ts),
            sigma_factor: c.sigma_factor,
            detection: Answers::new(&c.detection, c.clear_time.ticks(ts)),
            isolation: Answers::new(&c.isolation, c.clear_time.ticks(ts)),
            events: EventRules {
                onset_window: c.onset_window.ticks(ts),
                clear_ticks: c.clear_time.ticks(ts),
            },
            likelihood: Likelihood::new(&config.likelihood, config.tuning, identification, ts)?,
        })
    }

    /// The same for a rig that lacks some inputs.
    pub fn with(mut self, inputs: Inputs) -> Self {
        self.likelihood = self.likelihood.with(inputs);
        self
    }

    /// Another recording of the same rig begins with this power, %.
    pub fn resume(&self, state: &mut DiagnosisState, power: f32, known: &KnownInputs) {
        self.likelihood.resume(&mut state.likelihood, power, known);
    }

    /// Is armed with a model that was fitted elsewhere; see [`Likelihood::take`].
    pub(crate) fn take(&self, state: &mut DiagnosisState, fitted: &Fitted) -> Result<(), RejectReason> {
        self.likelihood.take(&mut state.likelihood, fitted)
    }

    /// What has to be found of a rig that was just resumed, and that it has been: see [`Likelihood::start`].
    pub(crate) fn start_of_rig(&self, state: &DiagnosisState, same_room: bool) -> Option<Start> {
        self.likelihood.start(&state.likelihood, same_room)
    }

    /// The same, as found.
    pub(crate) fn settle(&self, state: &mut DiagnosisState, start: &Start) {
        self.likelihood.settle(&mut state.likelihood, start);
    }

    /// See [`Likelihood::left_by_alarm`].
    pub(crate) fn left_by_alarm(&self, state: &DiagnosisState) -> Option<Option<f32>> {
        self.likelihood.left_by_alarm(&state.likelihood)
    }

    /// See [`Likelihood::start_anew`].
    pub(crate) fn start_anew(&self, state: &DiagnosisState) -> Option<Start> {
        self.likelihood.start_anew(&state.likelihood)
    }

    /// See [`Likelihood::end_by`].
    pub(crate) fn end_by(&self, state: &mut DiagnosisState, start: &Start) {
        self.likelihood.end_by(&mut state.likelihood, start);
    }

    /// The highest confidence of a name.
    pub(crate) fn certain(&self) -> f32 {
        self.likelihood.certain()
    }

    /// See [`Likelihood::before_an_end`].
    pub(crate) fn before_an_end(&self, state: &DiagnosisState, added: &mut Added) {
        self.likelihood.before_an_end(&state.likelihood, added);
    }

    /// See [`Likelihood::follow_added`].
    pub(crate) fn follow_added(&self, state: &DiagnosisState, added: &mut Added) {
        self.likelihood.follow_added(&state.likelihood, added);
    }

    /// See [`Likelihood::catch_up`].
    pub(crate) fn catch_up(&self, state: &mut DiagnosisState, added: &mut Added, all: [f32; 3]) {
        self.likelihood.catch_up(&mut state.likelihood, added, all);
    }

    /// See [`Likelihood::interacting`].
    pub(crate) fn interacting(&self, state: &DiagnosisState) -> Option<Interacting> {
        self.likelihood.interacting(&state.likelihood)
    }

    /// See [`Likelihood::ask`].
    pub(crate) fn ask(
        &self,
        state: &DiagnosisState,
        bank: &mut Interacting,
        added: &Added,
        e1: Option<f32>,
    ) -> Found {
        self.likelihood.ask(&state.likelihood, bank, added, e1)
    }

    /// See [`Likelihood::end_as_found`].
    pub(crate) fn end_as_found(
        &self,
        state: &mut DiagnosisState,
        bank: &Interacting,
        added: &mut Added,
        apart: [f32; 3],
    ) {
        self.likelihood.end_as_found(&mut state.likelihood, bank, added, apart);
    }

    /// The model in force; none before one was learnt.
    pub fn model(&self, state: &DiagnosisState) -> Option<Model> {
        self.likelihood.model(&state.likelihood)
    }

    /// A diagnosis that has seen nothing.
    pub fn start(&self) -> DiagnosisState {
        DiagnosisState {
            ms1: self.ms1.start(),
            ms2: self.ms2.start(),
            filters: None,
            phase: Phase::Off,
            learner: Learner::default(),
            baseline: None,
            standing: Default::default(),
            events: EventState::default(),
            likelihood: LikelihoodState::default(),
        }
    }

    /// Diagnoses one tick.
    pub fn step(&self, state: &mut DiagnosisState, seen: &Observation) -> Report {
        let applied = seen.power.0;
        let heating = seen.phase.is_heated();
        let [y1, y2] = seen.rises();
        let ms1 = self.ms1.step(&mut state.ms1, y1.filter(|_| heating), applied);
        let ms2 = self.ms2.step(&mut state.ms2, y2.filter(|_| heating), applied);
        let raw = if heating { features(y1, y2, applied, &ms1, &ms2) } else { None };
        let filtered = raw.as_ref().map(|raw| self.low_pass.step(&mut state.filters, raw));
        self.follow_phase(state, seen.phase);
        if seen.learn
            && let (Some(raw), Some(filtered)) = (&raw, &filtered)
        {
            state.learner.push(raw, filtered);
        }
        let normal = state.baseline.as_ref().filter(|_| seen.phase == Phase::Watched);
        let [of_filtered, of_raw] = &mut state.standing;
        let judge = |standing: &mut Vectors, features: &Option<_>, normal: Option<&_>| {
            Some(self.judge(standing, features.as_ref()?, normal?))
        };
        let subtract = |features: &Option<_>| Some(subtract(features.as_ref()?, &normal?.raw.mean));
        let verdict = judge(of_filtered, &filtered, normal.map(|normal| &normal.filtered));
        let undisturbed = verdict.is_none_or(|verdict| verdict.fdv == 0);
        Report {
            tick: seen.index,
            y1,
            y2,
            ms1,
            ms2,
            features: raw,
            features_filtered: filtered,
            residuals: subtract(&raw),
            residuals_filtered: subtract(&filtered),
            filtered: verdict,
            raw: judge(of_raw, &raw, normal.map(|normal| &normal.raw)),
            learned: state.learner.count(),
            events: match &verdict {
                Some(v) => self.events.step(&mut state.events, seen.index, &v.symptoms, v.fdv, v.fiv),
                None => Events::new(),
            },
            likelihood: self.likelihood.step(&mut state.likelihood, seen, undisturbed),
        }
    }

    /// Learning starts afresh whenever it is entered; the baseline stands once monitoring begins.
    fn follow_phase(&self, state: &mut DiagnosisState, phase: Phase) {
        let before = core::mem::replace(&mut state.phase, phase);
        if before == phase {
            return;
        }
        match phase {
            Phase::Learning => {
                state.learner = Learner::default();
                state.baseline = None;
            }
            Phase::Watched => {
                if before == Phase::Learning {
                    state.baseline = Some(state.learner.baseline());
                }
                state.events = EventState::default();
                state.standing = Default::default();
            }
            Phase::Off | Phase::Heated | Phase::Tripped => {}
        }
    }

    fn judge(
        &self,
        standing: &mut Vectors,
        features: &[f32; RESIDUALS],
        normal: &baseline::Normal,
    ) -> Verdict {
        let symptoms = symptoms(features, normal, self.sigma_factor);
        let fdv = self.detection.step(&mut standing.fdv, &symptoms);
        Verdict { symptoms, fdv, fiv: self.isolation.step(&mut standing.fiv, &symptoms) }
    }

    /// Restores what was learnt in an earlier run; it has been checked with [`Baseline::validate`].
    pub fn restore(&self, state: &mut DiagnosisState, baseline: &Baseline) {
        state.baseline = Some(*baseline);
    }

    /// What the alarm under way has changed; see [`LikelihoodState::changed`].
    pub fn changed(&self, state: &DiagnosisState) -> Option<Changed> {
        state.likelihood.changed()
    }

    /// The models in force, as they are kept at a commissioning.
    pub fn trained(&self, state: &DiagnosisState) -> Option<Commissioned> {
        self.likelihood.trained(&state.likelihood)
    }

    /// Takes over what was trained when the rig was commissioned; it has been checked with [`Commissioned::validate`].
    pub fn commission(&self, state: &mut DiagnosisState, commissioned: Option<Commissioned>) {
        self.likelihood.commission(&mut state.likelihood, commissioned);
    }

    /// What has become of the rig since it was commissioned; None where it was not, or nothing is trained now.
    pub fn since_commissioning(&self, state: &DiagnosisState) -> Option<SinceCommissioning> {
        self.likelihood.since_commissioning(&state.likelihood)
    }

    /// What was learnt, once monitoring has begun.
    pub fn baseline<'a>(&self, state: &'a DiagnosisState) -> Option<&'a Baseline> {
        state.baseline.as_ref()
    }
}

/// Residuals: features minus nominal means. Those that are only shown are residuals as they are.
fn subtract(features: &[f32; RESIDUALS], mean: &[f32; RESIDUALS]) -> [f32; RESIDUALS] {
    core::array::from_fn(|i| if i < FIRST_DECISIVE { features[i] } else { features[i] - mean[i] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::likelihood::{FaultClass, Finding};

    /// A name that only lasts is told. It neither takes T1 from the loop nor keeps a loss of air from tripping.
    #[test]
    fn what_is_not_sure_is_not_acted_on() {
        let faulty = |class, confidence| {
            let finding = Some(Finding { class, confidence, magnitude: None, onset: 0 });
            let likelihood = LikelihoodReport { finding, ..LikelihoodReport::default() };
            let feedback = Report { likelihood, ..Report::default() }.feedback();
            [feedback.t1_faulty, feedback.heater_faulty]
        };
        assert_eq!(faulty(FaultClass::T1Offset, 0.96), [true, false]);
        assert_eq!(faulty(FaultClass::HeaterPower, 0.96), [false, true]);
        assert_eq!(
            [FaultClass::T1Offset, FaultClass::HeaterPower].map(|class| faulty(class, 0.6)),
            [[false; 2]; 2]
        );
    }
}
