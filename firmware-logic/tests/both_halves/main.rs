//! Both halves of a tick and the console's way to them, as the board joins them: what is noticed, what is kept, and what is
//! refused while the heater may be on.

#[allow(dead_code, reason = "its cuts of the power are for the store's own tests")]
#[path = "../flash/mod.rs"]
mod flash;
#[path = "../output/mod.rs"]
mod output;

mod commissioning;
mod notices;
mod settings;
mod while_it_heats;

use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use fdi_core::control::Controller;
use fdi_core::diagnosis::Diagnosis;
use fdi_core::{AdcCode, Command, Config, ConfigError, RawSample};
use firmware_logic::cadence::Arrival;
use firmware_logic::console::Board;
use firmware_logic::console::board::{Chip, ConsoleBoard};
use firmware_logic::control_loop::{ControlLoop, Denial, Heater, Order};
use firmware_logic::diagnosis_loop::DiagnosisLoop;
use firmware_logic::interlock::Interlock;
use firmware_logic::notice::{Level, Notice};
use firmware_logic::reset_cause::Restart;
use firmware_logic::settings::store::Store;
use firmware_logic::settings::stored::Stored;
use firmware_logic::status::Status;
use flash::Flash;
use output::Output;

/// A chip whose time passes by orders and pauses.
struct TestChip {
    control: ControlLoop,
    diagnosis: DiagnosisLoop,
    output: Output,
    code: f32,
    notices: Vec<Notice>,
    /// Orders get no answer, though they are carried out later.
    deaf: bool,
    late: Option<Order>,
    stalls: usize,
    restarted: Option<Restart>,
    simulated: bool,
}

impl TestChip {
    fn new(settings: Stored) -> Self {
        let config = settings.config.clone();
        let controller = Controller::new(&config).expect("valid");
        let diagnosis = Diagnosis::new(&config).expect("valid");
        Self {
            control: ControlLoop::new(controller, config.setpoint, Interlock::default()),
            diagnosis: DiagnosisLoop::new(diagnosis, settings),
            output: Output::default(),
            code: 2160.0,
            notices: Vec::new(),
            deaf: false,
            late: None,
            stalls: 0,
            restarted: None,
            simulated: false,
        }
    }

    fn tick(&mut self, order: Option<Order>) -> Result<(), Denial> {
        let feedback = self.diagnosis.feedback();
        self.code = if self.code > 2160.0 { 2160.0 } else { 2161.0 }; // a live thermistor is never quite still
        let [t0, t1, t2] = [AdcCode(self.code); 3];
        let raw = RawSample { t0, t1, t2, ..RawSample::default() };
        let record = self.control.tick(raw, Arrival::default(), order, feedback, &mut self.output);
        let result = record.outcome.map_or(Ok(()), |outcome| outcome.result);
        self.diagnosis.step(record, |notice| self.notices.push(notice));
        result
    }

    /// Texts of the notices that are for people, since the last call.
    fn told(&mut self) -> Vec<String> {
        let for_people = self.notices.drain(..).filter(|notice| notice.level() > Level::Debug);
        for_people.map(|notice| notice.text(0.11).to_string()).collect()
    }
}

impl Chip for TestChip {
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
        if self.deaf {
            self.late = Some(order);
            return Err(Denial::NoAnswer);
        }
        self.tick(Some(order))
    }
    fn stop(&mut self) {
        self.output.disable();
        self.late = Some(Order::Command(Command::Stop));
    }
    fn is_output_enabled(&self) -> bool {
        self.output.enabled
    }
    async fn pause(&mut self) {
        let late = self.late.take();
        let _ = self.tick(late);
    }
    fn stalled(&mut self) {
        assert!(!self.output.enabled, "the flash stalled the core while it heats");
        self.stalls += 1;
    }
    fn status(&self) -> Status {
        self.diagnosis.status().clone()
    }
    fn stream(&mut self, _: bool) -> bool {
        true
    }
    fn restart(&mut self, how: Restart) {
        assert!(!self.output.enabled, "started anew while it heats");
        self.restarted = Some(how);
    }
    fn is_simulated(&self) -> bool {
        self.simulated
    }
    fn program_brown_out_level(&mut self) -> bool {
        true
    }
}

fn waived() -> Config {
    let mut config = Config::default();
    config.supervisor.check_before_arming = false;
    config
}

fn board(settings: Stored) -> ConsoleBoard<TestChip, Flash> {
    ConsoleBoard::new(TestChip::new(settings), Store::new(Flash::new()), false)
}

fn at_rest() -> ConsoleBoard<TestChip, Flash> {
    let mut board = board(Stored { config: waived(), baseline: None });
    board.chip.tick(None).expect("no order");
    board
}

fn heating() -> ConsoleBoard<TestChip, Flash> {
    let mut board = at_rest();
    now(board.command(Command::Arm)).expect("arms");
    assert!(board.chip.output.enabled);
    board
}

fn now<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => panic!("nothing here waits"),
    }
}
