//! The board's two halves and the rig, in one place.

use embassy_futures::block_on;
use fdi_core::control::Controller;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::diagnosis::{Diagnosis, DiagnosisState};
use fdi_core::{AdcCode, Command, Config, Feedback, Mode, RawSample};
use firmware_logic::cadence::Arrival;
use firmware_logic::console::follow::Follow;
use firmware_logic::console::line::is_stop_key;
use firmware_logic::console::{self, ApplyError, Board};
use firmware_logic::control_loop::{ControlLoop, Denial, Heater, Order, TickRecord};
use firmware_logic::history::{Entry, History};
use firmware_logic::interlock::Interlock;
use firmware_logic::self_test::{Ending, Progress};
use firmware_logic::settings::store::SaveError;
use firmware_logic::status::Status;

use super::output::Output;
use super::play::{self, Play};
use crate::experiment::as_written;
use crate::experiment::scenario::Scenario;
use pt326_rig::Rig;

/// A board with a rig on its wires.
pub struct Bench {
    control: ControlLoop,
    diagnosis: Diagnosis,
    state: DiagnosisState,
    rig: Rig,
    heater: Output,
    config: Config,
    status: Status,
    history: History,
    follow: Follow,
    sample_time: f64,
}

impl Bench {
    /// At rest.
    ///
    /// # Errors
    /// A setting is out of bounds.
    pub fn new(config: &Config, scenario: &Scenario, seed: u64) -> anyhow::Result<Self> {
        let diagnosis = Diagnosis::new(config)?;
        let sample_time = as_written(config.sample_time.0);
        Ok(Self {
            control: ControlLoop::new(Controller::new(config)?, config.setpoint, Interlock::default()),
            state: diagnosis.start(),
            diagnosis,
            rig: Rig::new(&scenario.rig, scenario.disturbance, sample_time, seed, &scenario.faults),
            heater: Output::default(),
            config: config.clone(),
            status: Status::default(),
            history: History::default(),
            follow: Follow::default(),
            sample_time,
        })
    }

    /// Ts in s.
    pub fn sample_time(&self) -> f64 {
        self.sample_time
    }

    /// What the console says to a line.
    pub fn answer(&mut self, line: &str) -> String {
        let mut answer = String::new();
        if line.bytes().any(is_stop_key) {
            console::stop(self, &mut answer);
            return answer;
        }
        match Play::parse(line) {
            Ok(Some(play)) => self.play(play),
            Ok(None) => block_on(console::carry_out(line.trim(), self, &mut answer)),
            Err(error) => answer = format!("error: {error:#}\n"),
        }
        if line.trim() == "help" {
            answer += play::HELP;
        }
        answer
    }

    fn play(&mut self, play: Play) {
        match play {
            Play::Wait(seconds) => {
                (0..(seconds / self.sample_time).round() as u64).for_each(|_| self.pass());
            }
            Play::Rig(faults) => faults.into_iter().for_each(|fault| self.rig.inject(fault)),
            Play::Power(defect) => self.heater.suffer(defect),
            Play::Mend => {
                self.rig.clear();
                self.heater.mend();
            }
        }
    }

    /// What a check has told since the last call.
    pub fn news(&mut self) -> String {
        let mut news = String::new();
        self.follow.show(&self.status.check, &self.config, &mut news);
        news
    }

    /// Whether a check is under way.
    pub fn is_checking(&self) -> bool {
        self.status.check.stage.is_some()
    }

    /// How the last check ended.
    pub fn ending(&self) -> Option<Ending> {
        self.status.check.ending
    }

    /// The output stage.
    pub fn output(&self) -> &Output {
        &self.heater
    }

    /// The rig.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// One tick in which nothing is asked for.
    pub fn pass(&mut self) {
        let _ = self.tick(None);
    }

    /// One tick, and what became of the order before it.
    fn tick(&mut self, order: Option<Order>) -> Result<(), Denial> {
        let [t0, t1, t2] = self.rig.sample().map(|code| AdcCode(code as f32));
        let feedback =
            self.status.last.as_ref().map_or_else(Feedback::default, |(_, report)| report.feedback());
        let raw = RawSample { t0, t1, t2 };
        let record = self.control.tick(raw, Arrival::default(), order, feedback, &mut self.heater);
        self.rig.advance(f64::from(self.heater.given().0));
        let report = self.diagnosis.step(&mut self.state, &record.tick, record.applied);
        self.note_trip(&record);
        report.events.iter().for_each(|event| self.history.event(*event));
        self.status.health.jitter.count(&record.arrival);
        if let Some(news) = record.news {
            self.status.check.note(news);
        }
        let result = record.outcome.map_or(Ok(()), |outcome| outcome.result);
        self.status.last = Some((record, report));
        result
    }

    fn note_trip(&mut self, record: &TickRecord) {
        let tripped = |mode: &Mode| matches!(mode, Mode::Tripped(_));
        let was_tripped = self.status.last.as_ref().is_some_and(|(before, _)| tripped(&before.tick.mode));
        if let (Mode::Tripped(trip), false) = (record.tick.mode, was_tripped) {
            self.history.push(Entry::Trip(trip));
        }
    }
}

impl Board for Bench {
    async fn command(&mut self, command: Command) -> Result<(), Denial> {
        self.tick(Some(Order::Command(command)))
    }

    async fn check(&mut self) -> Result<(), Denial> {
        self.tick(Some(Order::Check))
    }

    fn progress(&self) -> Progress {
        self.status.check.clone()
    }

    fn stop(&mut self) {
        self.heater.disable();
        let _ = self.tick(Some(Order::Command(Command::Stop)));
    }

    fn status(&self) -> Status {
        self.status.clone()
    }

    fn config(&self) -> Config {
        self.config.clone()
    }

    async fn apply(&mut self, config: &Config) -> Result<(), ApplyError> {
        let controller = Controller::new(config)?;
        let diagnosis = Diagnosis::new(config)?;
        self.tick(Some(Order::Retune(controller)))?;
        self.diagnosis = diagnosis;
        self.config = config.clone();
        Ok(())
    }

    /// There is no flash here: settings live as long as the console. That a running heater forbids it is the same.
    async fn save(&mut self) -> Result<(), SaveError> {
        if self.heater.is_enabled() || self.is_checking() { Err(SaveError::Heating) } else { Ok(()) }
    }

    /// Nor are there option bytes.
    fn set_brown_out_level(&mut self) -> Result<(), SaveError> {
        if self.heater.is_enabled() || self.is_checking() { Err(SaveError::Heating) } else { Ok(()) }
    }

    fn baseline(&self) -> Option<Baseline> {
        self.diagnosis.baseline(&self.state).copied()
    }

    fn fault(&self, index: usize) -> Option<Entry> {
        self.history.get(index).copied()
    }
}
