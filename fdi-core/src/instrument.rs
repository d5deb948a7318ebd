//! The instrument: all that happens between reading the ADC and setting the PWM, in two halves.

use core::fmt;

use crate::config::Config;
use crate::control::{Controller, ControllerState, Tick};
use crate::diagnosis::baseline::Baseline;
use crate::diagnosis::{Diagnosis, DiagnosisState, Report};
use crate::error::ConfigError;
use crate::likelihood::{Commissioned, LikelihoodState, SinceCommissioning};
use crate::sense::RawSample;
use crate::supervisor::{Command, Refusal};
use crate::units::Percent;

/// One instrument: tuning and state of both halves.
///
/// Each tick, call [`control`](Self::control), drive the heater with what it returns, then call
/// [`diagnose`](Self::diagnose). Neither can fail or panic, whatever the codes are.
///
/// ```
/// use fdi_core::{AdcCode, Command, Config, Instrument, RawSample};
///
/// let mut instrument = Instrument::new(&Config::default())?;
/// instrument.command(Command::Arm).expect("a new instrument is off");
/// let room = AdcCode(2160.0);
/// let tick = instrument.control(RawSample { t0: room, t1: room, t2: room, ..RawSample::default() });
/// assert!(tick.drive.0 > 0.0); // it is cold: heat
/// let report = instrument.diagnose(&tick, tick.drive);
/// assert!(report.filtered.is_none()); // nothing learnt yet, so nothing claimed
/// # Ok::<(), fdi_core::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Instrument {
    controller: Controller,
    diagnosis: Diagnosis,
    control_state: ControllerState,
    diagnosis_state: DiagnosisState,
}

/// Why new settings were not taken over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RetuneError {
    /// One is out of bounds.
    Config(ConfigError),
    /// They are not to be put in force now.
    Refused(Refusal),
}

impl From<ConfigError> for RetuneError {
    fn from(error: ConfigError) -> Self {
        Self::Config(error)
    }
}

impl From<Refusal> for RetuneError {
    fn from(refusal: Refusal) -> Self {
        Self::Refused(refusal)
    }
}

impl fmt::Display for RetuneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Config(error) => error.fmt(f),
            Self::Refused(refusal) => refusal.fmt(f),
        }
    }
}

impl core::error::Error for RetuneError {}

impl Instrument {
    /// Builds an instrument that is off.
    ///
    /// # Errors
    /// The first parameter that is out of bounds.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        let controller = Controller::new(config)?;
        let diagnosis = Diagnosis::new(config)?;
        config.validate_times()?;
        let control_state = controller.start(config.setpoint);
        let diagnosis_state = diagnosis.start();
        Ok(Self { controller, diagnosis, control_state, diagnosis_state })
    }

    /// First half of a tick: takes in the codes, says what to drive the heater with until the next tick.
    #[must_use = "the heater is to be driven with it"]
    pub fn control(&mut self, raw: RawSample) -> Tick {
        self.controller.step(&mut self.control_state, raw)
    }

    /// Second half: identifies and diagnoses. `applied` is what the heater really gets until the next tick, which is
    /// the drive of `tick` unless something else has cut it.
    pub fn diagnose(&mut self, tick: &Tick, applied: Percent) -> Report {
        let report = self.diagnosis.step(&mut self.diagnosis_state, &tick.observation(applied));
        self.controller.feed_back(&mut self.control_state, report.feedback());
        report
    }

    /// Carries out a command, effective from the next tick.
    ///
    /// # Errors
    /// Why it is refused; nothing has changed then.
    pub fn command(&mut self, command: Command) -> Result<(), Refusal> {
        self.controller.command(&mut self.control_state, command)
    }

    /// Takes over new settings without a bump: the state stays, the set-point of `config` is not applied (use
    /// [`Command::SetPoint`]). What was learnt under other settings stays too ([`Command::Relearn`] renews it), but for the
    /// models where a thermistor is calibrated anew.
    ///
    /// # Errors
    /// The first parameter that is out of bounds, or that widens a limit while the heater is on; nothing has changed
    /// then.
    pub fn retune(&mut self, config: &Config) -> Result<(), RetuneError> {
        let controller = Controller::new(config)?;
        let diagnosis = Diagnosis::new(config)?;
        config.validate_times()?;
        self.controller.retune(&mut self.control_state, controller)?;
        self.diagnosis = diagnosis;
        Ok(())
    }

    /// Restores a baseline that was learnt in an earlier run: once in regulation, monitoring begins without learning.
    /// [`Command::Relearn`] puts it aside.
    ///
    /// # Errors
    /// What cannot have been learnt; nothing has changed then.
    pub fn restore(&mut self, baseline: &Baseline) -> Result<(), ConfigError> {
        baseline.validate()?;
        self.diagnosis.restore(&mut self.diagnosis_state, baseline);
        self.controller.restored(&mut self.control_state, baseline);
        Ok(())
    }

    /// The models in force, to be kept as those of the commissioning.
    pub fn trained(&self) -> Option<Commissioned> {
        self.diagnosis.trained(&self.diagnosis_state)
    }

    /// Restores the models of the commissioning, which what is trained later is held against; `None` forgets them.
    ///
    /// # Errors
    /// They cannot have been trained; nothing has changed then.
    pub fn commission(&mut self, commissioned: Option<Commissioned>) -> Result<(), ConfigError> {
        commissioned.as_ref().map_or(Ok(()), Commissioned::validate)?;
        self.diagnosis.commission(&mut self.diagnosis_state, commissioned);
        Ok(())
    }

    /// What has become of the rig since it was commissioned; None where it was not, or nothing is trained now.
    pub fn since_commissioning(&self) -> Option<SinceCommissioning> {
        self.diagnosis.since_commissioning(&self.diagnosis_state)
    }

    /// What was learnt, once monitoring has begun.
    pub fn baseline(&self) -> Option<&Baseline> {
        self.diagnosis.baseline(&self.diagnosis_state)
    }

    /// The memory of the likelihood diagnosis, for those who ask what it could tell.
    pub fn likelihood(&self) -> &LikelihoodState {
        &self.diagnosis_state.likelihood
    }
}
