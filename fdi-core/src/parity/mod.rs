//! The parity diagnosis: a second opinion beside the paper's signatures, faster, surer, and for more faults.
//!
//! Two models are trained while nothing is wrong and then frozen: power -> y1 and y1 -> y2. Run as simulations they give
//! three residuals, each blind to one place: y1 against the power (T2), y2 against the power (T1), y2 against y1 (the
//! process). Whitened, they feed cumulative sum charts; a bank of matched filters says which fault explains them best.
//!
//! ```text
//!  untrained --learning--> training --gate--> armed --chart--> alarm --bank--> named --quiet again--> armed
//!                              ^--refused--|      (a relearning, or a stop, leads back to untrained)
//! ```
//!
//! Both models are driven by the power that was really applied, so the controller hides nothing. Sources: docs/diagnosis.md.

mod alarm;
mod bank;
mod chart;
mod config;
mod fit;
mod heat;
mod hypothesis;
mod model;
mod noise;
mod sensors;
mod training;
pub mod verdict;
mod watch;
mod weakness;
mod whitening;

use crate::config::Config;
use crate::control::Tick;
use crate::error::ConfigError;
use crate::supervisor::Mode;
use alarm::Rules;
use bank::Filters;
use chart::Chart;
pub use config::ParityConfig;
use fit::Fit;
use heat::Heat;
use sensors::Sensors;
use training::{Trainer, Training};
pub use verdict::{Arming, Channel, Distrust, FaultClass, Finding, Magnitude, ParityReport};
use watch::{Watch, WatchState};
use weakness::Weakness;

/// The validated parity diagnosis.
#[derive(Clone, Copy, Debug)]
pub struct Parity {
    trainer: Trainer,
    watch: Watch,
}

/// The memory of the [`Parity`] diagnosis.
#[derive(Clone, Copy, Debug, Default)]
pub struct ParityState {
    phase: Phase,
    sensors: Sensors,
    /// Why the last training was not accepted.
    refused: Option<Distrust>,
    was_learning: bool,
}

#[derive(Clone, Copy, Debug, Default)]
enum Phase {
    #[default]
    Untrained,
    Training(Training),
    Watching(WatchState),
}

const _: () = assert!(size_of::<ParityState>() <= 4096, "more than the board has for it");

impl Parity {
    /// Builds the diagnosis.
    ///
    /// # Errors
    /// The parameter of `parity` that is out of bounds.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        let c = &config.parity;
        c.validate()?;
        let ts = config.sample_time;
        let rules = Rules { margin: c.margin, power_margin: c.power_margin, sample_time: ts.0 };
        Ok(Self {
            trainer: Trainer {
                fit: Fit::new(&config.identification)?,
                fit_samples: c.fit_time.ticks(ts),
                check_samples: c.check_time.ticks(ts),
            },
            watch: Watch {
                fast: Chart { slack: c.fast_slack, limit: c.fast_limit },
                slow: Chart { slack: c.slow_slack, limit: c.slow_limit },
                weakness: Weakness::new(c.model_uncertainty, ts.0),
                filters: Filters::new(ts.0),
                heat: Heat::new(ts.0),
                rules,
                mean_share: (ts.0 / c.mean_time.0).min(1.0),
                tolerated_sag: c.tolerated_sag,
                sample_time: ts.0,
            },
        })
    }

    /// Diagnoses one tick: `y` are the rises of T1 and T2 over the room in degC where valid, `applied` is what drives
    /// the heater from this tick to the next, %. `undisturbed` says that the paper's signatures see no fault.
    pub fn step(
        &self,
        state: &mut ParityState,
        tick: &Tick,
        y: [Option<f32>; 2],
        applied: f32,
        undisturbed: bool,
    ) -> ParityReport {
        self.follow_mode(state, tick.mode);
        let by_models = self.run(state, tick, y, applied, undisturbed);
        let by_sensors = state.sensors.step(&tick.sample, tick.index);
        let watching = match &state.phase {
            Phase::Watching(watch) if tick.mode == Mode::Monitor => Some(watch),
            _ => None,
        };
        let finding = by_sensors.or(by_models.flatten());
        // A heater that gives more than it is asked for looks like too little air.
        let by_heater = finding.is_some_and(|f| f.class == FaultClass::HeaterPower);
        ParityReport {
            arming: state.arming(),
            alarm: by_models.is_some() || by_sensors.is_some(),
            finding,
            stand_in: watching.filter(|_| y[1].is_some()).and_then(WatchState::stand_in),
            air_flow: watching.filter(|_| !by_heater).and_then(|watch| watch.heat().air_flow()),
            heater_stuck_on: watching.is_some_and(|watch| watch.heat().heater_stuck_on()),
        }
    }

    /// Training starts afresh whenever learning does; what was trained is of no use once the heater has been off.
    fn follow_mode(&self, state: &mut ParityState, mode: Mode) {
        let learning = matches!(mode, Mode::Learn { .. });
        if (learning && !state.was_learning) || !mode.is_heating() {
            state.phase = Phase::Untrained;
            state.refused = None;
        }
        state.was_learning = learning;
    }

    /// An alarm of the models, with what it is where that is known.
    fn run(
        &self,
        state: &mut ParityState,
        tick: &Tick,
        y: [Option<f32>; 2],
        u: f32,
        undisturbed: bool,
    ) -> Option<Option<Finding>> {
        // With a baseline of an earlier life there is no learning; then training takes place while monitoring.
        let quiet = tick.mode == Mode::Monitor && tick.prbs.0 != 0.0 && undisturbed;
        let fit_to_learn = tick.learn || quiet;
        if fit_to_learn && matches!(state.phase, Phase::Untrained) {
            state.phase = Phase::Training(self.trainer.start());
        }
        match &mut state.phase {
            Phase::Untrained => {}
            Phase::Training(training) => match self.trainer.step(training, y, u, fit_to_learn) {
                Ok(None) => {}
                Ok(Some(trained)) => {
                    state.refused = None;
                    state.phase = Phase::Watching(self.watch.start(trained, tick.index));
                }
                Err(why) => {
                    state.refused = Some(why);
                    state.phase = Phase::Untrained;
                }
            },
            Phase::Watching(watch) if tick.mode == Mode::Monitor => {
                return self.watch.step(watch, tick.index, y, tick.sample.t0.good(), u);
            }
            Phase::Watching(watch) => watch.idle(y[0], u),
        }
        None
    }
}

impl ParityState {
    fn arming(&self) -> Arming {
        match (&self.phase, self.refused) {
            (Phase::Watching(_), _) => Arming::Armed,
            (_, Some(why)) => Arming::Refused(why),
            (Phase::Training(_), None) => Arming::Training,
            (Phase::Untrained, None) => Arming::Untrained,
        }
    }
}
