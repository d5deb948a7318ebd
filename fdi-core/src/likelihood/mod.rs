//! The likelihood diagnosis: a second opinion beside the paper's signatures, faster, surer, and for more faults.
//!
//! A model of the rig from physics is trained while nothing is wrong and then frozen. Simulated, fed with the power alone, it gives two
//! residuals, of T1 and of T2. Whitened together, they feed cumulative sum charts; a bank says which fault explains them best, all else being free to
//! have moved a little. A second bank holds a minute against the trained state.
//!
//! ```text
//!  untrained --learning--> training --gate--> armed --chart--> alarm --bank--> named --quiet again--> armed
//!                              ^--refused--|      (a relearning, or a stop, leads back to untrained)
//! ```
//!
//! The model is driven by the power that was really applied, so the controller hides nothing; where the supply is measured, by
//! what the heater makes of it.
//!
//! Sources: training is a recursive prediction error method (L. Ljung, *System Identification*, 2nd ed., 1999, chapter 11) in the form U D U' (G. J.
//! Bierman 1977); the charts are E. S. Page's (Biometrika 41, 1954), their intervals D. Siegmund's (1985); the bank holds generalised likelihood ratios
//! (A. S. Willsky, H. L. Jones, IEEE Trans. AC-21, 1976) against each other as Bayes factors (R. E. Kass, A. E. Raftery, JASA 90, 1995), with
//! consider parameters (S. F. Schmidt 1966) for what may move without being a fault. What is this project's own is told in its docs/diagnosis.md.
//!
//! What it says stands in each [`Report`](crate::Report):
//!
//! ```
//! use fdi_core::likelihood::{Channel, Readiness};
//! use fdi_core::{AdcCode, Config, FaultClass, Instrument, RawSample};
//!
//! let mut instrument = Instrument::new(&Config::default())?;
//! let code = AdcCode(2160.0);
//! let tick = instrument.control(RawSample { t0: code, t1: code, t2: code, ..RawSample::default() });
//! let report = instrument.diagnose(&tick, tick.drive).likelihood;
//! assert_eq!(report.readiness, Readiness::Untrained); // nothing learnt, nothing claimed
//! assert!(report.finding.is_none());
//! // A finding names a class, which says where it is and in which unit its magnitude is.
//! let class = FaultClass::T2Offset;
//! assert_eq!((class.sensor(), class.unit()), (Some(Channel::T2), "degC"));
//! # Ok::<(), fdi_core::ConfigError>(())
//! ```

pub(crate) mod added;
mod alarm;
mod ambient;
pub(crate) mod arbiter;
mod chart;
mod cholesky;
#[doc(hidden)]
pub mod class;
mod commissioned;
#[doc(hidden)]
pub mod config;
mod contact;
mod contradiction;
#[cfg(feature = "tuning")]
#[doc(hidden)]
pub mod described;
mod evidence;
mod explained;
mod finite;
mod given;
mod heat;
mod hypothesis;
mod impulse;
#[doc(hidden)]
pub mod inputs;
pub(crate) mod interacting;
#[doc(hidden)]
pub mod model;
mod normal;
mod onset;
mod posterior;
mod priority;
mod process;
mod readiness;
mod recovery;
#[cfg(test)]
mod reference;
mod regressor;
mod second_heater;
mod sensors;
#[doc(hidden)]
pub mod signatures;
pub(crate) mod start;
mod tangent;
#[doc(hidden)]
pub mod taught;
mod tracker;
mod training;
#[doc(hidden)]
pub mod tuning;
mod usual;
#[doc(hidden)]
pub mod verdict;
mod watch;
mod whitening;
mod work;

use crate::error::ConfigError;
use crate::identify::config::IdentificationConfig;
use crate::known::KnownInputs;
use crate::observation::{Observation, Phase};
use crate::settings::check;
use crate::units::Seconds;
use alarm::Said;
use ambient::{Ambient, AmbientState};
use arbiter::{Evidence, decide};
pub use class::{Channel, FaultClass, Pair};
pub use commissioned::{Commissioned, PARAMETERS, SinceCommissioning};
use config::LikelihoodConfig;
use contact::{Chatter, Contact};
use contradiction::Contradiction;
pub use given::Fitted;
pub use hypothesis::COUNT as HYPOTHESES;
use impulse::ImpulseResponse;
use inputs::Inputs;
pub use model::Model;
use priority::Standing;
pub use process::{Parameter, Parameters};
use sensors::Sensors;
use training::{Cold, Trainer};
pub use tuning::{Tuned, Tuning};
pub use verdict::{Finding, LikelihoodReport, Magnitude, Readiness, RejectReason, TaughtFinding};
use watch::{Input, Watch, WatchState};
use work::Work;

/// The validated likelihood diagnosis.
#[derive(Clone, Debug)]
pub struct Likelihood {
    trainer: Trainer,
    watch: Watch,
    ambient: Ambient,
    response: ImpulseResponse,
    inputs: Inputs,
    /// Ticks after which an alarm is advice.
    stands: u32,
    chatter: Chatter,
    tuning: Tuned,
}

/// The memory of the [`Likelihood`] diagnosis.
#[derive(Clone, Copy, Debug, Default)]
pub struct LikelihoodState {
    work: Work,
    /// What was trained last. It stays, for the heat, until it is replaced or forgotten.
    trained: Option<WatchState>,
    /// It belongs to the last learning, so that faults may be told by it.
    current: bool,
    /// It was fitted elsewhere: no learning replaces it.
    given: bool,
    /// The tick on which it was accepted.
    trained_at: u32,
    /// What was trained when the rig was commissioned.
    commissioned: Option<Commissioned>,
    /// What the models said last.
    said: Said,
    sensors: Sensors,
    ambient: AmbientState,
    contradiction: Contradiction,
    contact: Contact,
    standing: Standing,
    /// What is said while nothing is learnt: why the last training was not accepted, or that it was begun anew.
    otherwise: Readiness,
    restarts: u32,
    was_learning: bool,
    /// Ticks for which the paper's signatures have kept training waiting.
    waited: u32,
    cold: Cold,
}

const _: () = assert!(size_of::<LikelihoodState>() <= 8192, "more than the board has for it");

impl Likelihood {
    /// Builds the diagnosis.
    ///
    /// # Errors
    /// The parameter of `likelihood` or `identification` that is out of bounds.
    pub fn new(
        c: &LikelihoodConfig,
        tuning: Tuned,
        identification: &IdentificationConfig,
        sample_time: Seconds,
    ) -> Result<Self, ConfigError> {
        check(LikelihoodConfig::SETTINGS[0], c)?;
        let (ts, answer_time) = (sample_time, identification.answer_time.0);
        let usual = identification.y_scale.0 / identification.u_scale.0;
        Ok(Self {
            trainer: Trainer::new(
                tuning,
                c.fit_time.ticks(ts),
                c.check_time.ticks(ts),
                answer_time / ts.0,
                usual,
            )?,
            watch: Watch::new(c, tuning, ts.0, answer_time),
            ambient: Ambient::new(tuning, ts.0, answer_time),
            response: ImpulseResponse::new(tuning, ts.0, answer_time),
            inputs: Inputs::ALL,
            stands: Seconds(tuning.alarm.stands).ticks(ts),
            chatter: Chatter {
                taught: c.taught.len(),
                times: tuning.alarm.chatters as u32,
                window: Seconds(tuning.alarm.returns).ticks(ts),
            },
            tuning,
        })
    }

    /// The same for a rig that lacks some inputs. In place of a T2 that is missing T1 is fed, in place of a T0 something that never changes.
    pub fn with(mut self, inputs: Inputs) -> Self {
        self.inputs = inputs;
        self.watch = self.watch.with(inputs);
        self.trainer = self.trainer.with(inputs);
        self
    }

    /// Mean and standard deviation of what each parameter may be, times in ticks.
    pub fn priors(&self) -> [(f32, f32); Parameters::COUNT] {
        self.trainer.priors()
    }

    /// Within which training keeps each parameter, times in ticks.
    pub fn ranges(&self) -> [(f32, f32); Parameters::COUNT] {
        self.trainer.ranges()
    }

    /// Diagnoses one tick. `undisturbed` says that the paper's signatures see no fault.
    pub fn step(
        &self,
        state: &mut LikelihoodState,
        seen: &Observation,
        undisturbed: bool,
    ) -> LikelihoodReport {
        let (sample, known) = (&seen.sample, &seen.known);
        let power = known.effective(seen.power.0);
        let [t0, t1, t2] = [sample.t0, sample.t1, sample.t2].map(|reading| reading.good());
        self.follow_phase(state, seen);
        let contradiction = self.surroundings(state, seen, power);
        let now = Input {
            tick: seen.index,
            y: seen.rises(),
            believed: state.ambient.rises([t1, t2]),
            t0,
            power,
            second_power: known.beside.map_or(0.0, |power| power.0),
            fan: known.fan_share(),
        };
        state.cold.step(&self.tuning, now.y, seen.power.0 <= 0.0);
        self.watch(state, seen, &now);
        self.train(state, seen, &now, [undisturbed, contradiction.is_none()]);
        let evidence = Evidence {
            sensors: state.sensors.step(self.tuning, sample, seen.index),
            said: &state.said,
            contact: state.contact.step(self.chatter, state.work.held(), seen.index),
            response: contradiction,
            room: self.ambient.finding(&state.ambient),
            commissioning: self.worn(state, seen.phase),
        };
        if !state.is_finite(seen.index) {
            return state.begin_anew();
        }
        let finding = decide(&evidence, self.tuning);
        let advice = state.standing.is_advice(&evidence, finding, seen, self.stands);
        LikelihoodReport {
            readiness: state.readiness(),
            restarts: state.restarts,
            alarm: evidence.alarm(),
            advice,
            finding,
            taught: Self::taught(state, seen.phase),
            t1_contradicted: contradiction.is_some_and(|found| found.class.leaves_t1_blind()),
            ..self.heat(state, seen, &now)
        }
    }

    /// Follows the room, and says which thermistors contradict each other; without T0 or T2 there is nothing to hold against each other.
    fn surroundings(&self, state: &mut LikelihoodState, seen: &Observation, power: f32) -> Option<Finding> {
        let readings = [seen.sample.t0, seen.sample.t1, seen.sample.t2];
        let good = readings.map(|reading| reading.good());
        if self.inputs != Inputs::ALL {
            state.ambient.assume(good[0]);
            return None;
        }
        self.ambient.step(&mut state.ambient, seen.index, good, power);
        let read = readings.map(|reading| reading.read());
        state.contradiction.step(&self.response, seen.index, seen.phase.is_heated(), read, power)
    }

    /// The fault of the user's own that an alarm is.
    fn taught(state: &LikelihoodState, phase: Phase) -> Option<TaughtFinding> {
        match &state.work {
            Work::Watching(onset) if state.current && phase == Phase::Watched => onset.taught(),
            _ => None,
        }
    }

    /// Another recording of the same rig begins with these inputs.
    pub fn resume(&self, state: &mut LikelihoodState, power: f32, known: &KnownInputs) {
        if let Some(trained) = &mut state.trained {
            let second_power = known.beside.map_or(0.0, |power| power.0);
            self.watch.resume(trained, known.effective(power), known.fan_share(), second_power);
            state.work.begin_watching();
        }
    }

    /// What was learnt; none before.
    pub fn model(&self, state: &LikelihoodState) -> Option<Model> {
        Some(self.watch.model(state.trained.as_ref()?))
    }

    /// Training starts afresh whenever learning does, and ends with heating. What was trained outlives both, unless the
    /// rig was changed on purpose.
    fn follow_phase(&self, state: &mut LikelihoodState, seen: &Observation) {
        if seen.forget {
            (state.work, state.trained, state.current) = (Work::Nothing, None, false);
        }
        let learning = seen.phase == Phase::Learning;
        let begins = learning && !state.was_learning;
        // What was seen while it heated up belongs to the learning that follows.
        if (begins && state.current) || !seen.phase.is_heated() {
            state.work = Work::Nothing;
            state.contact = Contact::default();
            state.otherwise = Readiness::Untrained;
        }
        state.current &= !begins || state.given;
        state.was_learning = learning;
    }

    /// Not part of `step`, for the stack: training and model lie on it once, on their way to where they stay.
    #[inline(never)]
    fn train(
        &self,
        state: &mut LikelihoodState,
        seen: &Observation,
        now: &Input,
        [undisturbed, agree]: [bool; 2],
    ) {
        if state.current || !seen.phase.is_heated() {
            state.waited = 0;
            return;
        }
        // What differs from a restored baseline for longer than training takes is the rig as it is now; the signatures go on telling of it.
        state.waited =
            if undisturbed { state.waited.saturating_sub(1) } else { state.waited.saturating_add(1) };
        let undisturbed = agree && (undisturbed || state.waited > self.trainer.samples());
        // With a restored baseline there is no learning; then training takes place while monitoring.
        let quiet = seen.phase == Phase::Watched && seen.excited;
        let usual_fan = (now.fan - 1.0).abs() <= self.tuning.range.fan;
        let fit_to_learn = undisturbed && usual_fan && (seen.learn || quiet);
        if seen.phase == Phase::Watched && !fit_to_learn {
            return;
        }
        if !matches!(state.work, Work::Training(_)) {
            state.work = Work::Training(self.trainer.start());
        }
        let Work::Training(training) = &mut state.work else { return };
        // A T0 that is known to be wrong must not be learnt.
        let known_wrong = now.t0.is_some()
            && state.ambient.believed().is_some()
            && !self.ambient.is_followed(&state.ambient, now.t0);
        let y = if known_wrong { now.believed } else { now.y };
        match self.trainer.step(training, &state.cold, y, [now.power, now.second_power], fit_to_learn) {
            Ok(None) => {}
            Ok(Some(trained)) => {
                state.otherwise = Readiness::Untrained;
                state.work = Work::Nothing;
                state.trained = Some(self.watch.start(&trained));
                state.current = true;
                state.trained_at = seen.index;
            }
            Err(why) => {
                state.otherwise = Readiness::Refused(why);
                state.work = Work::Nothing;
            }
        }
    }

    /// What the models say.
    fn watch(&self, state: &mut LikelihoodState, seen: &Observation, now: &Input) {
        let Some(trained) = state.trained.as_mut() else {
            state.said = Said::default();
            return;
        };
        if state.current && seen.phase == Phase::Watched {
            if !matches!(state.work, Work::Watching(_)) {
                state.work.begin_watching();
            }
            if let Work::Watching(onset) = &mut state.work {
                state.said = self.watch.step(trained, onset, now);
            }
            return;
        }
        if matches!(state.work, Work::Watching(_)) {
            state.work = Work::Nothing;
        }
        self.watch.idle(trained, now, seen.phase.is_heated());
        // What is found afterwards is only how the rig cools: what was reported before a trip is what can be said of it.
        if seen.phase != Phase::Tripped {
            state.said = Said::default();
        }
    }

    /// The facts that control and supervision act on.
    fn heat(&self, state: &LikelihoodState, seen: &Observation, now: &Input) -> LikelihoodReport {
        let ambient = state.ambient.believed();
        let Some(trained) = &state.trained else {
            return LikelihoodReport { expected: [ambient, None, None], ..LikelihoodReport::default() };
        };
        let [y1, y2] = trained.expected().map(|rise| ambient.map(|ambient| ambient + rise));
        let monitoring = state.current && seen.phase == Phase::Watched;
        // The virtual T1 is a rise over T0.
        let known = monitoring && now.y[1].is_some() && self.ambient.is_followed(&state.ambient, now.t0);
        LikelihoodReport {
            expected: [ambient, y1, y2],
            virtual_rise: if known { trained.virtual_t1() } else { None },
            air_flow: if seen.phase.is_heated() { trained.air_flow() } else { None },
            heater_stuck_on: trained.heater_stuck_on(),
            ..LikelihoodReport::default()
        }
    }
}
