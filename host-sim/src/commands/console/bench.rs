//! The board's two halves and the rig, in one place.

use embassy_futures::block_on;
use fdi_core::control::Controller;
use fdi_core::diagnosis::Diagnosis;
use fdi_core::{Command, Config, ConfigError};
use firmware_logic::cadence::Arrival;
use firmware_logic::console;
use firmware_logic::console::board::{Chip, ConsoleBoard};
use firmware_logic::console::follow::Follow;
use firmware_logic::console::line::is_stop_key;
use firmware_logic::control_loop::{ControlLoop, Denial, Heater, Order};
use firmware_logic::diagnosis_loop::DiagnosisLoop;
use firmware_logic::interlock::Interlock;
use firmware_logic::notice::Notice;
use firmware_logic::reset_cause::Restart;
use firmware_logic::self_test::Ending;
use firmware_logic::settings::store::Store;
use firmware_logic::settings::stored::Stored;
use firmware_logic::status::Status;

use super::flash::Flash;
use super::output_stage::OutputStage;
use super::play::{self, Play};
use pt326_host::experiment::scenario::Scenario;
use pt326_host::experiment::{as_written, sample};
use pt326_rig::Rig;

/// A board with a rig on its wires.
pub struct Bench {
    board: ConsoleBoard<SimulatedChip, Flash>,
    follow: Follow,
}

/// Everything of it but console and flash.
struct SimulatedChip {
    control: ControlLoop,
    diagnosis: DiagnosisLoop,
    rig: Rig,
    heater: OutputStage,
    sample_time: f64,
    /// What happens to the rig is the scenario's: the user has broken nothing yet.
    is_scenario: bool,
    /// Lines of its log that nobody has read.
    log: String,
}

impl Bench {
    /// At rest.
    ///
    /// # Errors
    /// A setting is out of bounds.
    pub fn new(config: &Config, scenario: &Scenario, seed: u64) -> anyhow::Result<Self> {
        let sample_time = as_written(config.sample_time.0);
        let settings = Stored { config: config.clone(), baseline: None };
        let chip = SimulatedChip {
            control: ControlLoop::new(Controller::new(config)?, config.setpoint, Interlock::default()),
            diagnosis: DiagnosisLoop::new(Diagnosis::new(config)?, settings),
            rig: Rig::new(&scenario.rig, scenario.disturbance, sample_time, seed, &scenario.faults),
            heater: OutputStage::default(),
            sample_time,
            is_scenario: true,
            log: String::new(),
        };
        let board = ConsoleBoard::new(chip, Store::new(Flash::default()), false);
        Ok(Self { board, follow: Follow::default() })
    }

    /// Ts in s.
    pub fn sample_time(&self) -> f64 {
        self.board.chip.sample_time
    }

    /// What the console says to a line.
    pub fn answer(&mut self, line: &str) -> String {
        let mut answer = String::new();
        if line.bytes().any(is_stop_key) {
            console::stop(&mut self.board, &mut answer);
            return answer;
        }
        match Play::parse(line) {
            Ok(Some(play)) => self.play(play),
            Ok(None) => block_on(console::carry_out(line.trim(), &mut self.board, &mut answer)),
            Err(error) => answer = format!("error: {error:#}\n"),
        }
        if line.trim() == "help" {
            answer += play::HELP;
        }
        answer
    }

    fn play(&mut self, play: Play) {
        let chip = &mut self.board.chip;
        // The user's faults stand in place of the scenario's, also of those to come.
        if !matches!(play, Play::Wait(_)) && std::mem::take(&mut chip.is_scenario) {
            chip.rig.clear();
        }
        match play {
            Play::Wait(seconds) => {
                (0..(seconds / chip.sample_time).round() as u64).for_each(|_| self.pass());
            }
            Play::Rig(faults) => faults.into_iter().for_each(|fault| chip.rig.inject(fault)),
            Play::Power(defect) => chip.heater.break_with(defect),
            Play::Mend => {
                chip.rig.clear();
                chip.heater.mend();
            }
        }
    }

    /// What the board has told of itself since the last call: lines of its log, and how a check goes on.
    pub fn news(&mut self) -> String {
        let mut news = std::mem::take(&mut self.board.chip.log);
        if self.follow.is_news(&self.board) {
            self.follow.show(&self.board, &mut news);
        }
        news
    }

    /// Whether a check is under way.
    pub fn is_checking(&self) -> bool {
        self.status().check.stage.is_some()
    }

    /// How the last check ended.
    pub fn ending(&self) -> Option<Ending> {
        self.status().check.ending
    }

    fn status(&self) -> &Status {
        self.board.chip.diagnosis.status()
    }

    /// The output stage.
    pub fn output(&self) -> &OutputStage {
        &self.board.chip.heater
    }

    /// The rig.
    pub fn rig(&self) -> &Rig {
        &self.board.chip.rig
    }

    /// One tick in which nothing is asked for.
    pub fn pass(&mut self) {
        let _ = self.board.chip.tick(None);
        block_on(self.board.settle());
    }
}

impl SimulatedChip {
    /// One tick, and what became of the order before it.
    fn tick(&mut self, order: Option<Order>) -> Result<(), Denial> {
        // Who announces a level of the fan has set it.
        if let Some(Order::Command(Command::Fan(level))) = order {
            self.rig.set_fan(f64::from(level.0) / 100.0);
        }
        let feedback = self.diagnosis.feedback();
        let raw = sample(&mut self.rig);
        let record = self.control.tick(raw, Arrival::default(), order, feedback, &mut self.heater);
        self.rig.advance(f64::from(self.heater.given().0));
        let result = record.outcome.map_or(Ok(()), |outcome| outcome.result);
        let seconds = f64::from(record.tick.index) * self.sample_time;
        let (log, sample_time) = (&mut self.log, self.sample_time as f32);
        self.diagnosis.step(record, |notice| {
            if is_shown(&notice) {
                *log += &format!("{seconds:.1} s: {}\n", notice.text(sample_time));
            }
        });
        result
    }
}

/// Whether it is worth a line here: the console says itself what became of an order, and how a check goes on.
fn is_shown(notice: &Notice) -> bool {
    !matches!(
        notice,
        Notice::Tick(_)
            | Notice::Order { .. }
            | Notice::Denied { .. }
            | Notice::Unchecked
            | Notice::Check(_)
            | Notice::Tuning(_)
    )
}

impl Chip for SimulatedChip {
    fn diagnosis<R>(&self, look: impl FnOnce(&DiagnosisLoop) -> R) -> R {
        look(&self.diagnosis)
    }

    fn change<R>(&mut self, change: impl FnOnce(&mut DiagnosisLoop) -> R) -> R {
        change(&mut self.diagnosis)
    }

    fn propose(&mut self, config: &Config) -> Result<Controller, ConfigError> {
        self.diagnosis.propose(config)
    }

    async fn order(&mut self, order: Order) -> Result<(), Denial> {
        self.tick(Some(order))
    }

    fn stop(&mut self) {
        self.heater.disable();
        let _ = self.tick(Some(Order::Command(Command::Stop)));
    }

    fn is_output_enabled(&self) -> bool {
        self.heater.is_enabled()
    }

    async fn pause(&mut self) {
        let _ = self.tick(None);
    }

    /// Nothing stalls here.
    fn stalled(&mut self) {}

    fn status(&self) -> Status {
        self.diagnosis.status().clone()
    }

    fn stream(&mut self, _: bool) -> bool {
        false
    }

    fn restart(&mut self, _: Restart) {}

    fn is_simulated(&self) -> bool {
        false
    }

    /// There are no option bytes here.
    fn program_brown_out_level(&mut self) -> bool {
        true
    }
}
