//! The first half of a tick: from codes to the drive, as short as it can be so that the drive leaves early.

pub mod pid;
pub mod prbs;

use crate::config::Config;
use crate::error::ConfigError;
use crate::filter::{LowPass, LowPassState};
use crate::sense::{RawSample, Sample, Sensing, SensingState};
use crate::supervisor::{Blocker, Command, Mode, Refusal, Situation, Supervisor, SupervisorState};
use crate::units::{Celsius, Percent};
use pid::{Pid, PidState};
use prbs::{Prbs, PrbsState};

/// Cut-off in rad/s of the mean control error by which "in regulation" is judged; the excitation itself must not count.
const REGULATION_CUTOFF: f32 = 0.6;

/// All that the first half of a tick decided; the input of the second half.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tick {
    /// Number of the tick since the instrument was built.
    pub index: u32,
    /// What the thermistors read.
    pub sample: Sample,
    /// Temperature wanted at T1.
    pub setpoint: Celsius,
    /// Output of the PID.
    pub pid: Percent,
    /// Excitation added to it; what is really excited is `drive - pid`.
    pub prbs: Percent,
    /// What the heater is to be driven with until the next tick, saturated; 0 whenever heating is not allowed.
    pub drive: Percent,
    /// Mode of the supervisor.
    pub mode: Mode,
    /// Whether this sample belongs to the baseline.
    pub learn: bool,
    /// Why it does not, while learning is due.
    pub blocked: Option<Blocker>,
}

/// The validated first half of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Controller {
    sensing: Sensing,
    supervisor: Supervisor,
    pid: Pid,
    prbs: Prbs,
    error_filter: LowPass,
}

/// The memory of the [`Controller`].
#[derive(Clone, Copy, Debug)]
pub struct ControllerState {
    index: u32,
    sensing: SensingState,
    supervisor: SupervisorState,
    pid: PidState,
    prbs: PrbsState,
    error_filter: LowPassState<1>,
    setpoint: Celsius,
    excite: bool,
    /// Samples learnt so far, as the second half reported them.
    learned: u32,
    /// What the tick before did: its excitation after saturation, and whether the sum was cut.
    excitation: Percent,
    saturated: bool,
}

impl Controller {
    /// Builds the first half.
    ///
    /// # Errors
    /// The parameter that is out of bounds.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        Ok(Self {
            sensing: Sensing::new(config)?,
            supervisor: Supervisor::new(config)?,
            pid: Pid::new(&config.pid, config.sample_time)?,
            prbs: Prbs::new(&config.prbs)?,
            error_filter: LowPass::new(REGULATION_CUTOFF, config.sample_time),
        })
    }

    /// A controller that is off, with the set-point of the configuration.
    pub fn start(&self, setpoint: Celsius) -> ControllerState {
        ControllerState {
            index: 0,
            sensing: SensingState::default(),
            supervisor: SupervisorState::default(),
            pid: PidState::default(),
            prbs: self.prbs.start(),
            error_filter: None,
            setpoint,
            excite: true,
            learned: 0,
            excitation: Percent(0.0),
            saturated: false,
        }
    }

    /// Takes in one sample and decides the drive.
    pub fn step(&self, state: &mut ControllerState, raw: RawSample) -> Tick {
        let excited = state.excitation.0.abs() >= self.supervisor.min_excitation();
        let sample = self.sensing.step(&mut state.sensing, raw, excited);
        let error = self.mean_error(state, &sample);
        let situation = Situation {
            tick: state.index,
            raw,
            sample: &sample,
            mean_error: error,
            setpoint: state.setpoint,
            saturated: state.saturated,
            excited,
            learned: state.learned,
        };
        let decision = self.supervisor.step(&mut state.supervisor, &situation);
        let (pid, prbs, drive) = self.drive(state, &sample);
        let tick = Tick {
            index: state.index,
            sample,
            setpoint: state.setpoint,
            pid,
            prbs,
            drive,
            mode: *self.supervisor.mode(&state.supervisor),
            learn: decision.learn,
            blocked: decision.blocked,
        };
        state.index = state.index.wrapping_add(1);
        tick
    }

    /// PID and excitation where the mode allows heat, else everything at rest.
    fn drive(&self, state: &mut ControllerState, sample: &Sample) -> (Percent, Percent, Percent) {
        if !self.supervisor.mode(&state.supervisor).is_heating() {
            state.pid = PidState::default();
            state.error_filter = None;
            state.excitation = Percent(0.0);
            state.saturated = false;
            return Default::default();
        }
        let pid = match sample.t1.good() {
            Some(t1) => self.pid.step(&mut state.pid, state.setpoint, Celsius(t1)),
            None => self.pid.hold(&mut state.pid),
        };
        let prbs = self.prbs.step(&mut state.prbs);
        let prbs = if state.excite { prbs } else { Percent(0.0) };
        let drive = self.pid.saturate(pid, prbs);
        state.excitation = Percent(drive.0 - pid.0);
        state.saturated = drive.0 != pid.0 + prbs.0 || self.pid.at_limit(pid);
        (pid, prbs, drive)
    }

    /// Low-passed control error; on an invalid T1 the last one.
    fn mean_error(&self, state: &mut ControllerState, sample: &Sample) -> Option<f32> {
        match sample.t1.good() {
            Some(t1) => Some(self.error_filter.step(&mut state.error_filter, &[state.setpoint.0 - t1])[0]),
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
            other => self.supervisor.command(&mut state.supervisor, other),
        }
    }

    /// Hears that the second half has a baseline from an earlier life: no need to learn one.
    pub fn restored(&self, state: &mut ControllerState) {
        self.supervisor.restored(&mut state.supervisor);
    }

    /// Hears from the second half how many samples the baseline has.
    pub fn heard(&self, state: &mut ControllerState, learned: u32) {
        state.learned = learned;
    }
}
