//! What may heat, what may learn, what has tripped.
//!
//! ```text
//!          Arm                 clock due and steady            enough samples
//!   Off ─────────▶ Settle ───────────────────────▶ Learn ───────────────────▶ Monitor
//!    ▲ ▲             ▲                               │                           │
//!    │ │             └── saturated, out of regulation, unexcited, new set-point ─┘ Relearn
//!    │ └── Stop, from any heating mode                 Off ── Tune ──▶ Tune ──▶ Off, by itself
//!    └──── Acknowledge ── Tripped ◀── a hazard: from any heating mode, in the same tick
//!                                 ◀── a heater that is stuck on: from Off as well
//! ```
//!
//! With a restored baseline (see `restored`), settling ends in Monitor, without Learn and without its clock.
//! A trip latches with its reason and the values seen, and is left only by an acknowledgement after its cause has gone.
//!
//! ```
//! use fdi_core::supervisor::{Command, Mode, Supervisor, SupervisorState};
//! use fdi_core::{Percent, Seconds, SupervisorConfig};
//!
//! let supervisor = Supervisor::new(&SupervisorConfig::default(), Percent(100.0), Seconds(2.0), Seconds(0.11))?;
//! let mut state = SupervisorState::default();
//! assert_eq!(supervisor.mode(&state), &Mode::Off);
//! supervisor.command(&mut state, Command::Arm).expect("nothing speaks against it");
//! assert!(matches!(supervisor.mode(&state), Mode::Settle { .. }));
//! assert!(supervisor.command(&mut state, Command::Acknowledge).is_err()); // nothing has tripped
//! # Ok::<(), fdi_core::ConfigError>(())
//! ```

pub mod config;
mod disagreement;
pub(crate) mod effect;
mod hazard;
mod mode;
mod operation;
mod response;
#[cfg(test)]
mod tests;
mod unasked;

pub use mode::{Blocker, Command, FASTEST_FAN, LONGEST_SHELVING, Mode, Refusal, Trip, TripReason};

use crate::bounds::smaller;
use crate::diagnosis::baseline::Baseline;
use crate::error::ConfigError;
use crate::feedback::Feedback;
use crate::filter::LowPass;
use crate::known::KnownInputs;
use crate::observation::Shelving;
use crate::sense::{RawSample, Sample};
use crate::units::{Celsius, Percent, Seconds};
use config::SupervisorConfig;
use disagreement::{Disagreement, DisagreementState};
use effect::{Effect, EffectState};
use operation::Operation;
use response::{Response, ResponseState};
use unasked::{Unasked, UnaskedState};

/// So many samples behind, the baseline is not merely late: the models need fewer to settle.
const UNIDENTIFIED: u32 = 300;
/// The power is averaged over this share of `response_time` before it is judged.
const POWER_TIME: f32 = 0.125;

/// T1 may be named out of the tube, or standing still, for so many answer times before that trips, and for so many s.
const NAMED: f32 = 4.0;
const LONGEST_NAMED: f32 = 300.0;

/// What the supervisor looks at.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// Number of the tick.
    pub tick: u32,
    /// Codes as they came.
    pub raw: RawSample,
    /// The readings.
    pub sample: &'a Sample,
    /// The temperature that is regulated.
    pub regulated: Regulated,
    /// Low-passed control error in degC, if known.
    pub mean_error: Option<f32>,
    /// The temperature wanted.
    pub setpoint: Celsius,
    /// What the PID asked for on the tick before: the drive without the excitation.
    pub pid: Percent,
    /// The drive of the tick before.
    pub drive: Percent,
    /// The drive was at a limit on the tick before.
    pub saturated: bool,
    /// The tick before was really excited.
    pub excited: bool,
    /// What is known of the rig's other inputs.
    pub known: &'a KnownInputs,
    /// What the second half of the tick before has found.
    pub feedback: &'a Feedback,
}

/// The temperature that is regulated, where there is one that may be used.
#[derive(Clone, Copy, Debug)]
pub struct Regulated {
    /// T1, or the virtual T1.
    pub value: Option<Celsius>,
    /// It is the virtual T1: T1 itself is known to be wrong.
    pub is_virtual: bool,
}

/// What the supervisor decided for this tick, besides the mode.
#[derive(Clone, Copy, Debug)]
pub struct Decision {
    /// Whether this sample belongs to the baseline.
    pub learn: bool,
    /// Why it does not, while learning is due.
    pub blocked: Option<Blocker>,
    /// What was learnt before is to be forgotten.
    pub forget: bool,
    /// What the diagnosis tells is to be advice.
    pub shelve: Option<Shelving>,
}

/// The validated supervisor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supervisor {
    config: SupervisorConfig,
    sample_time: Seconds,
    response: Response,
    disagreement: Disagreement,
    unasked: Unasked,
    effect: Effect,
    named_ticks: u32,
    learn_start: u32,
    learn_samples: u32,
    steady_ticks: u32,
    lost_ticks: u32,
    regulation_band: f32,
    /// Averages the power.
    power: LowPass,
}

/// The memory of the [`Supervisor`].
#[derive(Clone, Copy, Debug, Default)]
pub struct SupervisorState {
    mode: Mode,
    /// Ticks since arming; saturates.
    elapsed: u32,
    /// Ticks in a row without a temperature to regulate; saturates.
    lost: u32,
    setpoint: Celsius,
    /// What would trip now, whatever the mode.
    hazard: Option<TripReason>,
    /// A baseline was restored.
    restored: bool,
    /// What was learnt is to be forgotten, from the next tick on.
    forget: bool,
    /// What the diagnosis tells is to be advice, from the next tick on.
    shelve: Option<Shelving>,
    /// Power asked for up to now, without the excitation, averaged, %.
    power: f32,
    operation: Operation,
    response: ResponseState,
    disagreement: DisagreementState,
    unasked: UnaskedState,
    effect: EffectState,
    /// Ticks in a row on which T1 was named out of the tube or standing still, without models; saturates.
    named: u32,
}

impl Supervisor {
    /// Builds the supervisor; `output_max` is the power that the controller can ask for, `answer_time` how long the rig takes to answer.
    ///
    /// # Errors
    /// The parameter that is out of bounds.
    pub fn new(
        c: &SupervisorConfig,
        output_max: Percent,
        answer_time: Seconds,
        sample_time: Seconds,
    ) -> Result<Self, ConfigError> {
        c.validate(sample_time)?;
        Ok(Self::of(c, output_max, answer_time, sample_time))
    }

    /// From what has been checked.
    fn of(c: &SupervisorConfig, output_max: Percent, answer_time: Seconds, ts: Seconds) -> Self {
        let learn_start = c.learn_start.ticks(ts);
        Self {
            config: *c,
            sample_time: ts,
            response: Response::new(c, output_max, ts),
            disagreement: Disagreement::new(c, ts),
            unasked: Unasked::new(c, ts),
            effect: Effect::new(answer_time, ts),
            named_ticks: Seconds(smaller(NAMED * answer_time.0, LONGEST_NAMED)).ticks(ts),
            learn_start,
            learn_samples: c.learn_end.ticks(ts).saturating_sub(learn_start),
            steady_ticks: c.regulation_time.ticks(ts),
            lost_ticks: c.signal_timeout.ticks(ts),
            regulation_band: c.regulation_band.0 / 100.0,
            power: LowPass::euler(POWER_TIME * c.response_time.0, ts.0),
        }
    }

    /// Smallest excitation that counts as one, in %.
    pub fn min_excitation(&self) -> f32 {
        self.config.min_excitation.0
    }

    /// Whether the virtual T1 is regulated where T1 is faulty.
    pub fn goes_on_without_t1(&self) -> bool {
        self.config.go_on_without_t1
    }

    /// Whether a board must have passed its self-test before it arms.
    pub fn checks_before_arming(&self) -> bool {
        self.config.check_before_arming
    }

    /// What would trip, whatever the mode; as of the last tick.
    pub fn hazard_seen(&self, state: &SupervisorState) -> Option<TripReason> {
        state.hazard
    }

    /// Decides the mode of this tick, before anything is driven.
    pub fn step(&self, state: &mut SupervisorState, now: &Situation) -> Decision {
        state.hazard = self.hazard(state, now);
        state.elapsed = if state.mode.is_heating() { state.elapsed.saturating_add(1) } else { 0 };
        let moved = core::mem::replace(&mut state.setpoint, now.setpoint) != now.setpoint;
        let blocker = self.blocker(now, moved);

        let due = state.elapsed > self.learn_start || state.restored;
        match (state.mode, state.hazard) {
            (Mode::Tripped(_), _) => {}
            (mode, Some(reason)) if mode.is_heating() || reason == TripReason::HeaterStuckOn => {
                state.mode = Mode::Tripped(self.trip(reason, state, now));
            }
            (Mode::Settle { steady }, _) => state.mode = self.settle(steady, blocker, due, state.restored),
            (Mode::Learn { accepted }, _) => {
                state.mode = self.learn(accepted, now.feedback.learned, blocker);
            }
            _ => {}
        }
        let blocked = match state.mode {
            Mode::Settle { .. } if due => Some(blocker.unwrap_or(Blocker::NotSteady)),
            Mode::Learn { accepted } => blocker.or(self.unidentified(accepted, now.feedback.learned)),
            _ => None,
        };
        let learn = matches!(state.mode, Mode::Learn { .. }) && blocker.is_none();
        self.learn_operation(state, now, learn);
        Decision { learn, blocked, forget: core::mem::take(&mut state.forget), shelve: state.shelve.take() }
    }

    /// Learns what power and temperatures go together, beside the diagnosis and from the same samples.
    fn learn_operation(&self, state: &mut SupervisorState, now: &Situation, learn: bool) {
        // An instrument that is armed before its first tick has that one only.
        if !state.mode.is_heating() || state.operation.knows_no_ambient() {
            state.operation.follow_ambient(now, self.sample_time);
        }
        match state.mode {
            Mode::Learn { accepted: 1 } => state.operation.begin(),
            Mode::Monitor => {
                state.operation.end();
                state.operation.follow_heated_room(now, state.power, self.sample_time);
            }
            _ => {}
        }
        if learn {
            state.operation.push(now);
        }
    }

    /// The experiment is over: off, unless it has tripped.
    pub(crate) fn end_tuning(&self, state: &mut SupervisorState) {
        if state.mode == Mode::Tune {
            state.mode = Mode::Off;
            // An order before the next tick begins from here.
            (state.elapsed, state.response, state.disagreement) = Default::default();
        }
    }

    /// The mode as last decided.
    pub fn mode<'a>(&self, state: &'a SupervisorState) -> &'a Mode {
        &state.mode
    }

    fn settle(&self, steady: u32, blocker: Option<Blocker>, due: bool, restored: bool) -> Mode {
        match blocker {
            None if restored && steady >= self.steady_ticks => Mode::Monitor,
            None if due && steady >= self.steady_ticks => Mode::Learn { accepted: 1 },
            None => Mode::Settle { steady: steady.saturating_add(1) },
            Some(Blocker::InvalidSample) => Mode::Settle { steady },
            Some(_) => Mode::Settle { steady: 0 },
        }
    }

    /// The baseline stays behind the samples that were fit for it: then the models give nothing to learn.
    fn unidentified(&self, accepted: u32, learned: u32) -> Option<Blocker> {
        (accepted > learned.saturating_add(UNIDENTIFIED)).then_some(Blocker::NotIdentified)
    }

    /// A missing sample is skipped; anything else that disturbs the rig makes what was learnt doubtful.
    fn learn(&self, accepted: u32, learned: u32, blocker: Option<Blocker>) -> Mode {
        let enough = accepted.min(learned) >= self.learn_samples;
        match blocker {
            None | Some(Blocker::InvalidSample) if enough => Mode::Monitor,
            None => Mode::Learn { accepted: accepted.saturating_add(1) },
            Some(Blocker::InvalidSample) => Mode::Learn { accepted },
            Some(_) => Mode::Settle { steady: 0 },
        }
    }

    /// What keeps this sample out of the baseline.
    fn blocker(&self, now: &Situation, setpoint_moved: bool) -> Option<Blocker> {
        let band = self.regulation_band * now.setpoint.0;
        let regulated = !setpoint_moved && now.mean_error.is_some_and(|e| e.abs() < band);
        if now.saturated {
            Some(Blocker::Saturated)
        } else if !regulated {
            Some(Blocker::OutOfRegulation)
        } else if !now.excited {
            Some(Blocker::Unexcited)
        } else if !now.sample.is_good() {
            Some(Blocker::InvalidSample)
        } else {
            None
        }
    }

    /// Checks a set-point.
    ///
    /// # Errors
    /// [`Refusal::SetPoint`] with the limits.
    pub fn check_setpoint(&self, wanted: Celsius) -> Result<Celsius, Refusal> {
        let (min, max) = (self.config.setpoint_min.0, self.config.setpoint_max.0);
        if wanted.0 >= min && wanted.0 <= max {
            Ok(wanted)
        } else {
            Err(Refusal::SetPoint { wanted: wanted.0, min, max })
        }
    }

    /// The diagnosis has restored a baseline.
    pub fn restored(&self, state: &mut SupervisorState, baseline: &Baseline) {
        state.restored = true;
        state.operation.restore(baseline);
    }

    /// The thermistors mean other temperatures from now on: what was learnt of power and heat is to be learnt anew.
    pub(crate) fn recalibrated(&self, state: &mut SupervisorState) {
        state.forget = true;
        (state.operation, state.unasked) = Default::default();
    }

    /// Carries out a command on the mode.
    ///
    /// # Errors
    /// Why it is refused; nothing has changed then.
    pub fn command(&self, state: &mut SupervisorState, command: Command) -> Result<(), Refusal> {
        state.mode = match (command, state.mode, state.hazard) {
            (Command::Arm, Mode::Off, None) => Mode::Settle { steady: 0 },
            (Command::Tune, Mode::Off, None) => Mode::Tune,
            (Command::Acknowledge, Mode::Tripped(_), None) => Mode::Off,
            (Command::Arm | Command::Tune, Mode::Off, Some(reason))
            | (Command::Acknowledge, Mode::Tripped(_), Some(reason)) => {
                return Err(Refusal::CausePersists(reason));
            }
            (
                Command::Relearn,
                mode @ (Mode::Off | Mode::Settle { .. } | Mode::Learn { .. } | Mode::Monitor),
                _,
            ) => {
                state.restored = false;
                state.forget = true;
                state.operation.forget();
                if mode.is_heating() { Mode::Settle { steady: 0 } } else { mode }
            }
            (Command::Acknowledge, Mode::Monitor, _) => {
                state.shelve = Some(Shelving::UntilItEnds);
                Mode::Monitor
            }
            (Command::Shelve(time), Mode::Monitor, _) => {
                if !(0.0..=LONGEST_SHELVING.0).contains(&time.0) {
                    return Err(Refusal::Shelving(time.0));
                }
                state.shelve = Some(Shelving::For(time.ticks(self.sample_time)));
                Mode::Monitor
            }
            (Command::Stop, Mode::Tripped(trip), _) => Mode::Tripped(trip),
            (Command::Stop, ..) => Mode::Off,
            (Command::SetPoint(_) | Command::Excite(_) | Command::Fan(_), mode, _) => mode,
            (
                Command::Arm | Command::Tune | Command::Acknowledge | Command::Relearn | Command::Shelve(_),
                mode,
                _,
            ) => {
                return Err(Refusal::NotInMode(mode.name()));
            }
        };
        Ok(())
    }
}
