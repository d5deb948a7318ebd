//! The first half of a tick: from codes to the drive, as short as it can be so that the drive leaves early.

pub mod pid;
pub mod prbs;
mod tick;

use crate::config::{Config, Limits};
use crate::diagnosis::baseline::Baseline;
use crate::error::ConfigError;
use crate::feedback::Feedback;
use crate::filter::{LowPass, LowPassState};
use crate::known::KnownInputs;
use crate::sense::supply::{Supply, SupplyState};
use crate::sense::{RawSample, Sample, Sensing, SensingState, Validity};
use crate::supervisor::account::HARMLESS;
use crate::supervisor::{
    Command, FASTEST_FAN, Mode, Refusal, Regulated, Situation, Supervisor, SupervisorState, TripReason,
};
use crate::tune::{Powers, Standing, Tuning, Unclear};
use crate::units::{Celsius, Percent, Seconds};
use pid::{Pid, PidState};
use prbs::{Prbs, PrbsState};
pub use tick::Tick;

/// The validated first half of a tick. Of two that the same settings gave, one that differs has been damaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    sensing: Sensing,
    supply: Supply,
    supervisor: Supervisor,
    pid: Pid,
    prbs: Prbs,
    /// By its mean control error "in regulation" is judged: as slow as the residuals are filtered, for the excitation must not count.
    error_filter: LowPass,
    plant: Plant,
    sample_time: Seconds,
    output_max: Percent,
    limits: Limits,
}

/// What the settings say of the rig before anything is learnt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plant {
    /// Ticks that an answer takes; trips by the models take their time from it.
    pub answer_ticks: u32,
    /// Typical gain, degC per %.
    pub gain: f32,
}

/// The memory of the [`Controller`].
#[derive(Clone, Copy, Debug)]
pub struct ControllerState {
    index: u32,
    sensing: SensingState,
    supply: SupplyState,
    /// Level of the fan as announced.
    fan: Option<Percent>,
    supervisor: SupervisorState,
    pid: PidState,
    prbs: PrbsState,
    error_filter: LowPassState<1>,
    setpoint: Celsius,
    excite: bool,
    /// What the second half said last.
    feedback: Feedback,
    /// The virtual T1 was regulated on the tick before.
    was_virtual: bool,
    /// What the tick before did: what the PID asked for, its excitation after saturation, both together, and whether the sum was cut.
    asked: Percent,
    excitation: Percent,
    driven: Percent,
    saturated: bool,
    tuning: Option<Tuning>,
}

/// What is driven until the next tick.
#[derive(Default)]
struct Drive {
    pid: Percent,
    prbs: Percent,
    sum: Percent,
    tuning: Option<Standing>,
}

impl Controller {
    /// Builds the first half.
    ///
    /// # Errors
    /// The parameter that is out of bounds.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        config.validate_general()?;
        config.diagnosis.validate()?;
        let ts = config.sample_time;
        let controller = Self {
            sensing: Sensing::new(&config.sensors, &config.plausibility, ts)?,
            supply: Supply::new(&config.supply)?,
            supervisor: Supervisor::new(
                &config.supervisor,
                config.pid.output_max,
                &config.identification,
                ts,
            )?,
            pid: Pid::new(&config.pid, ts)?,
            prbs: Prbs::new(&config.prbs)?,
            error_filter: LowPass::new(config.diagnosis.filter_cutoff, ts),
            plant: Plant {
                answer_ticks: config.identification.answer_time.ticks(ts),
                gain: config.identification.y_scale.0 / config.identification.u_scale.0,
            },
            sample_time: ts,
            output_max: config.pid.output_max,
            limits: Limits::of(config),
        };
        config.validate_limits()?;
        Ok(controller)
    }

    /// A controller that is off, with the set-point of the configuration.
    pub fn start(&self, setpoint: Celsius) -> ControllerState {
        ControllerState {
            index: 0,
            sensing: SensingState::default(),
            supply: SupplyState::default(),
            fan: None,
            supervisor: SupervisorState::default(),
            pid: PidState::default(),
            prbs: self.prbs.start(),
            error_filter: None,
            setpoint,
            excite: true,
            feedback: Feedback::default(),
            was_virtual: false,
            asked: Percent(0.0),
            excitation: Percent(0.0),
            driven: Percent(0.0),
            saturated: false,
            tuning: None,
        }
    }

    /// Whether a board must have passed its self-test before it arms.
    pub fn checks_before_arming(&self) -> bool {
        self.supervisor.checks_before_arming()
    }

    /// What the settings say of the rig.
    pub fn plant(&self) -> Plant {
        self.plant
    }

    /// The mode.
    pub fn mode<'a>(&self, state: &'a ControllerState) -> &'a Mode {
        self.supervisor.mode(&state.supervisor)
    }

    /// What would trip, whatever the mode; as of the last tick.
    pub fn hazard(&self, state: &ControllerState) -> Option<TripReason> {
        self.supervisor.hazard_seen(&state.supervisor)
    }

    /// One sample, and the drive that follows from it.
    #[must_use = "the heater is to be driven with it"]
    pub fn step(&self, state: &mut ControllerState, raw: RawSample) -> Tick {
        let excited = state.excitation.0.abs() >= self.supervisor.min_excitation();
        // In air that is heated no thermistor stands still, excited or not.
        let moved = excited || state.driven.0 > HARMLESS;
        let sample = self.sensing.step(&mut state.sensing, raw, moved);
        self.supply.step(&mut state.supply, raw.supply);
        let known = KnownInputs {
            supply: state.supply.share(),
            supply_lost: state.supply.lost(),
            fan: state.fan,
            beside: None,
        };
        let regulated = self.regulated(state, &sample);
        let error = self.mean_error(state, regulated.value);
        let situation = Situation {
            tick: state.index,
            raw,
            sample: &sample,
            regulated,
            mean_error: error,
            setpoint: state.setpoint,
            pid: state.asked,
            drive: state.driven,
            saturated: state.saturated,
            excited,
            known: &known,
            feedback: &state.feedback,
        };
        let decision = self.supervisor.step(&mut state.supervisor, &situation);
        let Drive { pid, prbs, sum: drive, tuning } = self.drive(state, regulated);
        let tick = Tick {
            index: state.index,
            sample,
            virtual_t1: regulated.value.filter(|_| regulated.is_virtual),
            setpoint: state.setpoint,
            pid,
            prbs,
            drive,
            mode: *self.supervisor.mode(&state.supervisor),
            tuning,
            learn: decision.learn,
            blocked: decision.blocked,
            forget: decision.forget,
            shelve: decision.shelve,
            known,
        };
        (state.asked, state.driven) = (pid, drive);
        state.index = state.index.wrapping_add(1);
        tick
    }

    /// Whether a sample between two ticks shows what would trip on the next, so that the power must not wait for it.
    pub fn must_cut(&self, state: &ControllerState, raw: RawSample) -> bool {
        let sample = self.sensing.step(&mut SensingState::default(), raw, false);
        self.supervisor.is_hazardous(&sample, state.was_virtual)
    }

    /// The temperature to regulate: T1, or what stands in for it where T1 is known to be wrong and that is allowed.
    fn regulated(&self, state: &ControllerState, sample: &Sample) -> Regulated {
        // A spike is over on the next tick: the output is held for it.
        let believed =
            matches!(sample.t1.validity, Validity::Good | Validity::Spike) && !state.feedback.t1_faulty;
        let known = state.feedback.virtual_rise.is_some() || state.was_virtual;
        if self.supervisor.goes_on_without_t1() && known && !believed {
            let virtual_t1 =
                sample.t0.good().zip(state.feedback.virtual_rise).map(|(t0, rise)| Celsius(t0 + rise));
            Regulated { value: virtual_t1, is_virtual: true }
        } else {
            Regulated { value: sample.t1.good().map(Celsius), is_virtual: false }
        }
    }

    /// PID and excitation where the mode allows heat, else everything at rest.
    fn drive(&self, state: &mut ControllerState, regulated: Regulated) -> Drive {
        let mode = *self.supervisor.mode(&state.supervisor);
        if mode == Mode::Tune {
            return self.tune(state, regulated);
        }
        if !mode.is_heating() {
            at_rest(state);
            let stopped = state.tuning.take().map(|_| Standing::Over(Err(Unclear::Stopped)));
            return Drive { tuning: stopped, ..Drive::default() };
        }
        let pid = match regulated.value {
            Some(y) => {
                if core::mem::replace(&mut state.was_virtual, regulated.is_virtual) != regulated.is_virtual {
                    self.pid.change_sensor(&mut state.pid, y);
                }
                self.pid.step(&mut state.pid, state.setpoint, y)
            }
            None => self.pid.hold(&mut state.pid),
        };
        let prbs = self.prbs.step(&mut state.prbs);
        let prbs = if state.excite { prbs } else { Percent(0.0) };
        let drive = self.pid.saturate(pid, prbs);
        state.excitation = Percent(drive.0 - pid.0);
        state.saturated = drive.0 != pid.0 + prbs.0 || self.pid.at_limit(pid);
        Drive { pid, prbs, sum: drive, tuning: None }
    }

    /// The power of the experiment. Its end is off, in this very tick.
    fn tune(&self, state: &mut ControllerState, regulated: Regulated) -> Drive {
        let begin = || Tuning::new(Powers::for_gain(self.plant.gain, self.output_max), self.sample_time);
        let tuning = state.tuning.get_or_insert_with(begin);
        let power = tuning.step(regulated.value.filter(|_| !regulated.is_virtual));
        let (standing, excitation) = (tuning.standing(), tuning.excitation());
        if let Standing::Over(_) = standing {
            at_rest(state);
            state.tuning = None;
            self.supervisor.end_tuning(&mut state.supervisor);
        }
        state.excitation = excitation;
        Drive { pid: power, sum: power, tuning: Some(standing), ..Drive::default() }
    }

    /// Low-passed control error; without a temperature the last one.
    fn mean_error(&self, state: &mut ControllerState, regulated: Option<Celsius>) -> Option<f32> {
        match regulated {
            Some(y) => Some(self.error_filter.step(&mut state.error_filter, &[state.setpoint.0 - y.0])[0]),
            None => state.error_filter.map(|e| e[0]),
        }
    }

    /// Carries out a command of the user.
    ///
    /// # Errors
    /// Why it is refused in the present state; nothing has changed then.
    pub fn command(&self, state: &mut ControllerState, command: Command) -> Result<(), Refusal> {
        match command {
            Command::SetPoint(wanted) => {
                state.setpoint = self.supervisor.check_setpoint(wanted)?;
                Ok(())
            }
            Command::Excite(on) => {
                state.excite = on;
                Ok(())
            }
            Command::Fan(level) if (0.0..=FASTEST_FAN).contains(&level.0) => {
                state.fan = Some(level);
                Ok(())
            }
            Command::Fan(level) => Err(Refusal::Fan(level.0)),
            other => self.supervisor.command(&mut state.supervisor, other),
        }
    }

    /// The second half has restored a baseline: no need to learn one.
    pub fn restored(&self, state: &mut ControllerState, baseline: &Baseline) {
        self.supervisor.restored(&mut state.supervisor, baseline);
    }

    /// Puts the settings of `new` in force. An experiment takes none; while the heater is on, none may widen a limit or change what a code
    /// means; where the latter happens at rest, what was learnt of power and temperatures is forgotten.
    ///
    /// # Errors
    /// [`Refusal::NotInMode`], or [`Refusal::WidensLimit`] with the name of the setting; nothing has changed then.
    pub fn retune(&mut self, state: &mut ControllerState, new: Self) -> Result<(), Refusal> {
        if *self.mode(state) == Mode::Tune {
            return Err(Refusal::NotInMode(Mode::Tune.name()));
        }
        if let Some(name) = self.widened(&new)
            && self.mode(state).is_heating()
        {
            return Err(Refusal::WidensLimit(name));
        }
        if self.sensing.recalibrated(&new.sensing).is_some() || self.supply != new.supply {
            self.supervisor.recalibrated(&mut state.supervisor);
        }
        *self = new;
        Ok(())
    }

    /// What `new` widens, or makes mean something else.
    fn widened(&self, new: &Self) -> Option<&'static str> {
        let supply = (self.supply != new.supply).then_some("supply.nominal_voltage");
        self.limits.widened(&new.limits).or(supply).or_else(|| self.sensing.recalibrated(&new.sensing))
    }

    /// Feedback from the second half, for the next step.
    pub fn feed_back(&self, state: &mut ControllerState, feedback: Feedback) {
        state.feedback = feedback;
    }
}

/// Nothing is regulated.
fn at_rest(state: &mut ControllerState) {
    state.pid = PidState::default();
    state.error_filter = None;
    state.excitation = Percent(0.0);
    state.saturated = false;
    state.was_virtual = false;
}
