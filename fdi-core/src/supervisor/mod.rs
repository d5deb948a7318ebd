//! What may heat, what may learn, what has tripped.
//!
//! ```text
//!          Arm                 clock due and steady            enough samples
//!   Off ─────────▶ Settle ───────────────────────▶ Learn ───────────────────▶ Monitor
//!    ▲ ▲             ▲                               │                           │
//!    │ │             └── saturated, out of regulation, unexcited, new set-point ─┘ Relearn
//!    │ └── Stop, from any heating mode
//!    └──── Acknowledge ── Tripped ◀── T1 lost, over-temperature: from any heating mode, in the same tick
//! ```
//!
//! With a baseline from an earlier life (see `restored`), settling ends in Monitor, without Learn and without its clock.
//! A trip latches with its reason and the values seen, and is left only by an acknowledgement after its cause has gone.

mod mode;

pub use mode::{Blocker, Command, Mode, Refusal, Trip, TripReason};

use crate::config::Config;
use crate::diagnosis::baseline::MIN_SAMPLES;
use crate::error::{ConfigError, above, in_range, in_ranges};
use crate::feedback::Feedback;
use crate::sense::{RawSample, Sample, Validity};
use crate::units::{Celsius, Percent, Seconds};

/// Settings of the supervisor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SupervisorConfig {
    /// Learning begins no earlier than this after arming.
    pub learn_start: Seconds,
    /// Learning ends no earlier than this; it takes `learn_end - learn_start` of accepted samples.
    pub learn_end: Seconds,
    /// "In regulation": the low-passed control error is within this share of the set-point.
    pub regulation_band: Percent,
    /// In regulation, unsaturated and excited for so long before learning begins.
    pub regulation_time: Seconds,
    /// Smallest excitation, after saturation, that counts as one.
    pub min_excitation: Percent,
    /// T1 or T2 above this switches the heater off.
    pub over_temperature: Celsius,
    /// T1 without a valid sample for longer than this switches the heater off, whatever the reason.
    pub signal_timeout: Seconds,
    /// Once T1 is named faulty, or breaks, go on with T2 through the models of the parity diagnosis; else what is broken
    /// trips and what reads wrong is only told. Set-point limits and over-temperature hold all the same.
    pub go_on_without_t1: bool,
    /// Air flow surely below this share of normal switches the heater off; 0 never does.
    pub min_air_flow: Percent,
    /// The board refuses to arm until its self-test has passed since power-on. Only its control loop enforces it.
    pub check_before_arming: bool,
    /// Lowest set-point that is accepted.
    pub setpoint_min: Celsius,
    /// Highest set-point that is accepted.
    pub setpoint_max: Celsius,
}

impl Default for SupervisorConfig {
    fn default() -> Self {
        Self {
            learn_start: Seconds(180.0),
            learn_end: Seconds(360.0),
            regulation_band: Percent(5.0),
            regulation_time: Seconds(20.0),
            min_excitation: Percent(0.5),
            over_temperature: Celsius(75.0),
            signal_timeout: Seconds(0.5),
            go_on_without_t1: false,
            min_air_flow: Percent(50.0),
            check_before_arming: true,
            setpoint_min: Celsius(20.0),
            setpoint_max: Celsius(65.0),
        }
    }
}

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
    /// The drive was at a limit on the tick before.
    pub saturated: bool,
    /// The tick before was really excited.
    pub excited: bool,
    /// What the second half of the tick before has found.
    pub feedback: &'a Feedback,
}

/// The temperature that is regulated, where there is one that may be used.
#[derive(Clone, Copy, Debug)]
pub struct Regulated {
    /// T1, or what stands in for it.
    pub value: Option<Celsius>,
    /// It is a stand-in: T1 is known to be wrong.
    pub is_stand_in: bool,
}

/// What the supervisor decided for this tick, besides the mode.
#[derive(Clone, Copy, Debug)]
pub struct Decision {
    /// Whether this sample belongs to the baseline.
    pub learn: bool,
    /// Why it does not, while learning is due.
    pub blocked: Option<Blocker>,
}

/// The validated supervisor.
#[derive(Clone, Copy, Debug)]
pub struct Supervisor {
    learn_start: u32,
    learn_samples: u32,
    steady_ticks: u32,
    lost_ticks: u32,
    regulation_band: f32,
    min_excitation: f32,
    over_temperature: Celsius,
    go_on_without_t1: bool,
    min_air_flow: f32,
    check_before_arming: bool,
    setpoint_min: f32,
    setpoint_max: f32,
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
    /// A baseline from an earlier life is there.
    restored: bool,
}

impl Supervisor {
    /// Builds the supervisor.
    ///
    /// # Errors
    /// The parameter that is out of bounds.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        let c = &config.supervisor;
        in_range("supervisor.learn_start", c.learn_start.0, 0.0, 86400.0)?;
        in_range("supervisor.learn_end", c.learn_end.0, 0.0, 86400.0)?;
        let shortest = c.learn_start.0 + MIN_SAMPLES * config.sample_time.0;
        above("supervisor.learn_end", c.learn_end.0, "supervisor.learn_start + 100 samples", shortest)?;
        in_ranges! {
            "supervisor.regulation_band": c.regulation_band.0, 0.1, 100.0;
            "supervisor.regulation_time": c.regulation_time.0, 0.0, 3600.0;
            "supervisor.min_excitation": c.min_excitation.0, 0.01, 50.0;
            "supervisor.over_temperature": c.over_temperature.0, 30.0, 250.0;
            "supervisor.signal_timeout": c.signal_timeout.0, 0.0, 5.0;
            "supervisor.min_air_flow": c.min_air_flow.0, 0.0, 95.0;
            "supervisor.setpoint_min": c.setpoint_min.0, 0.0, 200.0;
            "supervisor.setpoint_max": c.setpoint_max.0, 0.0, 200.0;
        }?;
        above("supervisor.setpoint_max", c.setpoint_max.0, "supervisor.setpoint_min", c.setpoint_min.0)?;
        above(
            "supervisor.over_temperature",
            c.over_temperature.0,
            "supervisor.setpoint_max",
            c.setpoint_max.0,
        )?;
        in_range("setpoint", config.setpoint.0, c.setpoint_min.0, c.setpoint_max.0)?;
        let ts = config.sample_time;
        let learn_start = c.learn_start.ticks(ts);
        Ok(Self {
            learn_start,
            learn_samples: c.learn_end.ticks(ts).saturating_sub(learn_start),
            steady_ticks: c.regulation_time.ticks(ts),
            lost_ticks: c.signal_timeout.ticks(ts),
            regulation_band: c.regulation_band.0 / 100.0,
            min_excitation: c.min_excitation.0,
            over_temperature: c.over_temperature,
            go_on_without_t1: c.go_on_without_t1,
            min_air_flow: c.min_air_flow.0,
            check_before_arming: c.check_before_arming,
            setpoint_min: c.setpoint_min.0,
            setpoint_max: c.setpoint_max.0,
        })
    }

    /// Smallest excitation that counts as one, in %.
    pub fn min_excitation(&self) -> f32 {
        self.min_excitation
    }

    /// Whether a faulty T1 is stood in for.
    pub fn goes_on_without_t1(&self) -> bool {
        self.go_on_without_t1
    }

    /// Whether a board must have passed its self-test before it arms.
    pub fn checks_before_arming(&self) -> bool {
        self.check_before_arming
    }

    /// What would trip, whatever the mode; as of the last tick.
    pub fn hazard_seen(&self, state: &SupervisorState) -> Option<TripReason> {
        state.hazard
    }

    /// Decides the mode of this tick, before anything is driven.
    pub fn step(&self, state: &mut SupervisorState, now: &Situation) -> Decision {
        state.lost = if now.regulated.value.is_some() { 0 } else { state.lost.saturating_add(1) };
        state.hazard = self.hazard(state, now);
        state.elapsed = if state.mode.is_heating() { state.elapsed.saturating_add(1) } else { 0 };
        let moved = core::mem::replace(&mut state.setpoint, now.setpoint) != now.setpoint;
        let blocker = self.blocker(now, moved);

        let due = state.elapsed > self.learn_start || state.restored;
        match (&mut state.mode, state.hazard) {
            (mode, Some(reason)) if mode.is_heating() => {
                *mode = Mode::Tripped(trip(reason, now, self.over_temperature));
            }
            (mode @ &mut Mode::Settle { steady }, _) => {
                *mode = self.settle(steady, blocker, due, state.restored)
            }
            (mode @ &mut Mode::Learn { accepted }, _) => {
                *mode = self.learn(accepted, now.feedback.learned, blocker)
            }
            _ => {}
        }
        let blocked = match state.mode {
            Mode::Settle { .. } if due => Some(blocker.unwrap_or(Blocker::NotSteady)),
            Mode::Learn { .. } => blocker,
            _ => None,
        };
        Decision { learn: matches!(state.mode, Mode::Learn { .. }) && blocker.is_none(), blocked }
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

    /// What would make heating dangerous.
    fn hazard(&self, state: &SupervisorState, now: &Situation) -> Option<TripReason> {
        let sample = now.sample;
        let hot = |reading: Option<f32>| reading.is_some_and(|t| t > self.over_temperature.0);
        let lost_too_long = state.lost > self.lost_ticks;
        let flow = now.feedback.air_flow.filter(|flow| flow.0 < self.min_air_flow);
        if state.mode.is_heating() && flow.is_some() {
            return Some(TripReason::AirFlowLost);
        }
        if state.mode.is_heating() && now.feedback.heater_stuck_on {
            return Some(TripReason::HeaterStuckOn);
        }
        if now.regulated.is_stand_in {
            return match now.regulated.value {
                None if lost_too_long => Some(TripReason::T1Lost),
                stand_in if hot(stand_in.map(|t| t.0)) => Some(TripReason::T1OverTemperature),
                _ if hot(sample.t2.good()) => Some(TripReason::T2OverTemperature),
                _ => None,
            };
        }
        match sample.t1.validity {
            Validity::Open => Some(TripReason::T1Open),
            Validity::Short => Some(TripReason::T1Short),
            Validity::OutOfRange => Some(TripReason::T1OutOfRange),
            Validity::Stuck if lost_too_long => Some(TripReason::T1Stuck),
            Validity::Missing | Validity::Spike | Validity::Rate if lost_too_long => Some(TripReason::T1Lost),
            _ if hot(sample.t1.good()) => Some(TripReason::T1OverTemperature),
            _ if hot(sample.t2.good()) => Some(TripReason::T2OverTemperature),
            _ => None,
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
        let (min, max) = (self.setpoint_min, self.setpoint_max);
        if wanted.0 >= min && wanted.0 <= max {
            Ok(wanted)
        } else {
            Err(Refusal::SetPoint { wanted: wanted.0, min, max })
        }
    }

    /// Hears that the diagnosis has a baseline from an earlier life.
    pub fn restored(&self, state: &mut SupervisorState) {
        state.restored = true;
    }

    /// Carries out a command on the mode.
    ///
    /// # Errors
    /// Why it is refused; nothing has changed then.
    pub fn command(&self, state: &mut SupervisorState, command: Command) -> Result<(), Refusal> {
        state.mode = match (command, state.mode, state.hazard) {
            (Command::Arm, Mode::Off, None) => Mode::Settle { steady: 0 },
            (Command::Acknowledge, Mode::Tripped(_), None) => Mode::Off,
            (Command::Arm, Mode::Off, Some(reason))
            | (Command::Acknowledge, Mode::Tripped(_), Some(reason)) => {
                return Err(Refusal::CausePersists(reason));
            }
            (Command::Relearn, Mode::Settle { .. } | Mode::Learn { .. } | Mode::Monitor, _) => {
                state.restored = false;
                Mode::Settle { steady: 0 }
            }
            (Command::Stop, Mode::Tripped(trip), _) => Mode::Tripped(trip),
            (Command::Stop, ..) => Mode::Off,
            (Command::SetPoint(_) | Command::Excite(_), mode, _) => mode,
            (Command::Arm | Command::Acknowledge | Command::Relearn, mode, _) => {
                return Err(Refusal::NotInMode(mode.name()));
            }
        };
        Ok(())
    }
}

/// The record of a trip. Out of line: it is long, and made once.
#[cold]
fn trip(reason: TripReason, now: &Situation, limit: Celsius) -> Trip {
    Trip { reason, tick: now.tick, raw: now.raw, sample: *now.sample, setpoint: now.setpoint, limit }
}
