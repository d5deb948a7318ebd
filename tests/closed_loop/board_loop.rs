//! The control loop of the board and the instrument in process are the same thing: same codes, same orders, same bits.

use fdi_core::control::Controller;
use fdi_core::diagnosis::Diagnosis;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::{Command, Config, Feedback, RawSample, Report, Tick};
use firmware_logic::cadence::Arrival;
use firmware_logic::control_loop::{ControlLoop, Order, TickRecord};
use firmware_logic::diagnosis_loop::DiagnosisLoop;
use firmware_logic::interlock::Interlock;
use firmware_logic::settings::commissioning::Commissioning;
use firmware_logic::settings::stored::Stored;
use pt326::commands::console::OutputStage;
use pt326_host::experiment::scenario::Scenario;
use pt326_host::experiment::{Backend, run, run_on};
use pt326_rig::fault::{Fault, Verb};

/// The two halves as the firmware runs them: orders wait for the next tick, what was learnt comes back one tick later.
struct BoardLoop {
    control: ControlLoop,
    diagnosis: DiagnosisLoop,
    output: OutputStage,
    order: Option<Order>,
    feedback: Feedback,
    record: Option<TickRecord>,
}

impl BoardLoop {
    fn new(config: &Config) -> Self {
        let controller = Controller::new(config).expect("valid");
        let diagnosis = Diagnosis::new(config).expect("valid");
        let settings = Stored { config: config.clone(), baseline: None };
        Self {
            control: ControlLoop::new(controller, config.setpoint, Interlock::default()),
            diagnosis: DiagnosisLoop::new(diagnosis, settings),
            output: OutputStage::default(),
            order: None,
            feedback: Feedback::default(),
            record: None,
        }
    }
}

impl Backend for BoardLoop {
    fn control(&mut self, raw: RawSample) -> Tick {
        let order = self.order.take();
        let record = self.control.tick(raw, Arrival::default(), order, self.feedback, &mut self.output);
        let tick = record.tick;
        self.record = Some(record);
        tick
    }

    fn diagnose(&mut self, _tick: &Tick) -> Report {
        let record = self.record.take().expect("control came first");
        let report = self.diagnosis.step(record, |_| {}).clone();
        self.feedback = self.diagnosis.feedback();
        report
    }

    fn command(&mut self, command: Command) -> Result<(), String> {
        self.order = Some(Order::Command(command));
        Ok(())
    }

    fn baseline(&self) -> Option<Baseline> {
        self.diagnosis.baseline().copied()
    }
}

/// What became of a rig with a heater of so many times its power, which was commissioned before or is now.
fn learnt_with(power: f64, commissioned: Option<Commissioning>) -> (Commissioning, f32) {
    let config = Config::default();
    let mut unchecked = config.clone();
    unchecked.supervisor.check_before_arming = false;
    let mut board = BoardLoop::new(&unchecked);
    board.diagnosis.commissioned(commissioned);
    let faults = vec![Fault::new(Verb::HeaterPower, None, Some(power), 0.0, 1e5)];
    let scenario = Scenario { duration: 450.0, faults, ..Scenario::default() };
    run_on(&mut board, &config, &scenario, 1);
    let since = board.diagnosis.status().commissioned.and_then(|since| since.change).expect("trained");
    (*board.diagnosis.commissioning().expect("commissioned"), since.rise)
}

/// The first models that are accepted are those of the commissioning; after a restart with less heat, which is learnt as it is, the loss
/// is said.
#[test]
fn what_was_lost_since_the_commissioning_is_said_after_a_restart() {
    let (commissioning, change) = learnt_with(1.0, None);
    assert_eq!((commissioning.number, change), (1, 0.0));
    let (after, change) = learnt_with(0.88, Some(commissioning));
    assert_eq!(after, commissioning, "it stays");
    assert!((change + 0.12).abs() < 0.01, "{change}");
}

#[test]
fn the_papers_experiment_gives_the_same_bits_on_the_boards_loop() {
    let (config, scenario) = (Config::default(), Scenario::default());
    let here = run(&config, &scenario, 1).expect("valid");
    let mut unchecked = config.clone();
    unchecked.supervisor.check_before_arming = false;
    let board = run_on(&mut BoardLoop::new(&unchecked), &config, &scenario, 1);
    assert_eq!(here.rows.len(), board.rows.len());
    for (here, board) in here.rows.iter().zip(&board.rows) {
        assert_eq!((here.tick, &here.report), (board.tick, &board.report));
    }
    assert!(here.baseline.is_some() && here.baseline == board.baseline);
}
