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
//! use fdi_core::config::IdentificationConfig;
//! use fdi_core::{Percent, Seconds, SupervisorConfig};
//!
//! let (config, plant) = (SupervisorConfig::default(), IdentificationConfig::default());
//! let supervisor = Supervisor::new(&config, Percent(100.0), &plant, Seconds(0.11))?;
//! let mut state = SupervisorState::default();
//! assert_eq!(supervisor.mode(&state), &Mode::Off);
//! supervisor.command(&mut state, Command::Arm).expect("nothing speaks against it");
//! assert!(matches!(supervisor.mode(&state), Mode::Settle { .. }));
//! assert!(supervisor.command(&mut state, Command::Acknowledge).is_err()); // nothing has tripped
//! # Ok::<(), fdi_core::ConfigError>(())
//! ```

pub(crate) mod account;
pub mod config;
mod hazard;
mod mode;
#[cfg(test)]
mod tests;

pub use mode::{Blocker, Command, FASTEST_FAN, LONGEST_SHELVING, Mode, Refusal, Trip, TripReason};

use crate::bounds::{larger, smaller};
use crate::diagnosis::baseline::Baseline;
use crate::error::ConfigError;
use crate::feedback::Feedback;
use crate::identify::config::IdentificationConfig;
use crate::known::KnownInputs;
use crate::observation::Shelving;
use crate::sense::{RawSample, Sample};
use crate::units::{Celsius, Percent, Seconds};
use account::{Account, AccountState, LONGEST_ANSWER, SETTLED};
use config::SupervisorConfig;

/// So many samples behind, the baseline is not merely late: the models need fewer to settle.
const UNIDENTIFIED: u32 = 300;

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
    account: Account,
    named_ticks: u32,
    learn_start: u32,
    learn_samples: u32,
    steady_ticks: u32,
    lost_ticks: u32,
    regulation_band: f32,
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
    account: AccountState,
    /// Ticks in a row on which T1 was named out of the tube or standing still, without models; saturates.
    named: u32,
}

impl Supervisor {
    /// Builds the supervisor; `output_max` is the power that the controller can ask for, `plant` what is declared of the rig.
    ///
    /// # Errors
    /// The parameter that is out of bounds.
    pub fn new(
        c: &SupervisorConfig,
        output_max: Percent,
        plant: &IdentificationConfig,
        sample_time: Seconds,
    ) -> Result<Self, ConfigError> {
        c.validate(sample_time)?;
        Ok(Self::of(c, output_max, plant, sample_time))
    }

    /// From what has been checked.
    fn of(c: &SupervisorConfig, output_max: Percent, plant: &IdentificationConfig, ts: Seconds) -> Self {
        let learn_start = c.learn_start.ticks(ts);
        Self {
            config: *c,
            sample_time: ts,
            account: Account::new(c, plant, output_max, ts),
            named_ticks: Seconds(smaller(SETTLED * plant.answer_time.0, LONGEST_ANSWER)).ticks(ts),
            learn_start,
            learn_samples: c.learn_end.ticks(ts).saturating_sub(learn_start),
            steady_ticks: c.regulation_time.ticks(ts),
            lost_ticks: c.signal_timeout.ticks(ts),
            regulation_band: c.regulation_band.0 / 100.0,
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
        match state.mode {
            Mode::Learn { accepted: 1 } => state.account.begin(),
            Mode::Monitor => state.account.end(),
            _ => {}
        }
        if learn {
            state.account.push(now);
        }
    }

    /// The experiment is over: off, unless it has tripped.
    pub(crate) fn end_tuning(&self, state: &mut SupervisorState) {
        if state.mode == Mode::Tune {
            state.mode = Mode::Off;
            // An order before the next tick begins from here.
            state.elapsed = 0;
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
        state.account.restore(baseline);
    }

    /// The thermistors mean other temperatures from now on: what was learnt of power and heat is to be learnt anew.
    pub(crate) fn recalibrated(&self, state: &mut SupervisorState) {
        state.forget = true;
        state.account = AccountState::default();
    }

    /// Carries out a command on the mode.
    ///
    /// # Errors
    /// Why it is refused; nothing has changed then.
    pub fn command(&self, state: &mut SupervisorState, command: Command) -> Result<(), Refusal> {
        state.mode = match (command, state.mode, state.hazard) {
            (Command::Arm | Command::Tune, Mode::Off, None) if !state.account.is_consistent() => {
                return Err(Refusal::NotAtRest(state.account.readings.map(|t| t.unwrap_or(f32::NAN))));
            }
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
                state.account.forget();
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
            (Command::Gain(gain), mode, _) => {
                state.account.checked = larger(gain, 0.0);
                mode
            }
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
