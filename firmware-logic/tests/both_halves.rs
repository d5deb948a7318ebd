//! Both halves of a tick and the console's way to them, as the board joins them: what is noticed, what is kept, and what is
//! refused while the heater may be on.

#[allow(dead_code, reason = "its cuts of the power are for the store's own tests")]
mod flash;
mod output;

use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use fdi_core::control::Controller;
use fdi_core::diagnosis::Diagnosis;
use fdi_core::diagnosis::baseline::{Baseline, Normal};
use fdi_core::likelihood::{Commissioned, PARAMETERS};
use fdi_core::{AdcCode, Command, Config, ConfigError, Feedback, RawSample, Seconds};
use firmware_logic::cadence::Arrival;
use firmware_logic::console::board::{Chip, ConsoleBoard};
use firmware_logic::console::{ApplyError, Board, BoardError};
use firmware_logic::control_loop::{ControlLoop, Denial, Heater, Order, OrderKind, next_order};
use firmware_logic::diagnosis_loop::DiagnosisLoop;
use firmware_logic::history::Entry;
use firmware_logic::interlock::{Interlock, Lockout};
use firmware_logic::notice::{Level, Notice};
use firmware_logic::reset_cause::Restart;
use firmware_logic::settings::commissioning::Commissioning;
use firmware_logic::settings::store::{SaveError, Store};
use firmware_logic::settings::stored::Stored;
use firmware_logic::status::Status;
use flash::Flash;
use heapless::spsc::Queue;
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
        let feedback =
            self.diagnosis.status().last.as_ref().map_or(Feedback::default(), |(_, r)| r.feedback());
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

#[test]
fn the_mark_stands_before_the_heater_is_on_and_goes_when_it_is_off_and_nothing_is_latched() {
    let mut board = heating();
    assert_eq!(board.chip.stalls, 1, "marked, with the output off");
    now(board.settle());
    assert_eq!(board.chip.stalls, 1, "it heats: the mark stands");
    board.chip.output.open = true;
    board.chip.output.enabled = false; // what the chip does by itself
    board.chip.tick(None).expect("no order");
    now(board.settle());
    assert_eq!(board.chip.stalls, 1, "locked out: the mark stands");
    board.chip.output.open = false;
    now(board.command(Command::Acknowledge)).expect("released");
    now(board.settle());
    assert_eq!(board.chip.stalls, 2);
    now(board.settle());
    assert_eq!(board.chip.stalls, 2, "taken away once");
}

#[test]
fn without_a_mark_nothing_arms() {
    let mut board = at_rest();
    let mut flash = Flash::new();
    flash.cut_at(0);
    board = ConsoleBoard::new(board.chip, Store::new(flash), false);
    assert_eq!(now(board.command(Command::Arm)), Err(Denial::NoMark));
    assert!(!board.chip.output.enabled);
}

#[test]
fn neither_flash_nor_option_bytes_are_written_while_it_may_heat() {
    let mut board = heating();
    assert_eq!(now(board.save()), Err(SaveError::Heating));
    assert_eq!(board.set_brown_out_level(), Err(SaveError::Heating));
    now(board.command(Command::Stop)).expect("always");
    now(board.check()).expect("begins");
    assert!(!board.chip.output.enabled, "it rests first");
    assert_eq!(now(board.save()), Err(SaveError::Heating), "a pulse may come meanwhile");
    assert_eq!(board.set_brown_out_level(), Err(SaveError::Heating));
    now(board.command(Command::Stop)).expect("always");
    while board.status().may_heat() {
        board.chip.tick(None).expect("no order");
    }
    assert_eq!((now(board.save()), board.set_brown_out_level()), (Ok(()), Ok(())));
}

#[test]
fn a_save_waits_for_the_tick_that_knows_of_the_stop() {
    let mut board = heating();
    board.stop();
    assert!(board.status().is_heating() && !board.chip.output.enabled);
    assert_eq!(now(board.save()), Ok(()));
    assert!(!board.status().is_heating());
}

#[test]
fn settings_are_in_force_in_both_halves_or_in_none() {
    let mut board = at_rest();
    let mut config = waived();
    config.sample_time.0 = 9.0;
    assert!(matches!(now(board.apply(&config)), Err(ApplyError::Config(_))));
    config.sample_time.0 = 0.11;
    config.supervisor.over_temperature.0 += 1.0;
    now(board.command(Command::Arm)).expect("arms");
    assert!(matches!(now(board.apply(&config)), Err(ApplyError::Denied(_))), "a limit is widened");
    assert_eq!(board.config(), waived());
    now(board.command(Command::Stop)).expect("always");
    now(board.apply(&config)).expect("at rest it may");
    assert_eq!(board.config(), config);
}

/// The timers have begun with the old one, and what was learnt holds for it alone.
#[test]
fn a_sample_time_is_kept_and_in_force_from_the_next_start_on() {
    let mut board = at_rest();
    let config = Config { sample_time: Seconds(0.2), ..waived() };
    now(board.apply(&config)).expect("a board can keep it");
    assert_eq!((board.config().sample_time, board.sample_time()), (Seconds(0.2), Seconds(0.11)));
    assert_eq!(board.chip.diagnosis.in_force(&config).sample_time, Seconds(0.11));
    assert_eq!(board.chip.diagnosis.to_keep(), Stored { config: config.clone(), baseline: None });
    let learnt = Some(Baseline { samples: 1637, ..Baseline::default() });
    for (sample_time, kept) in [(0.11, learnt), (0.2, None)] {
        let settings = Stored { config: waived(), baseline: learnt };
        let mut diagnosis = DiagnosisLoop::new(Diagnosis::new(&waived()).expect("valid"), settings);
        let config = Config { sample_time: Seconds(sample_time), ..waived() };
        diagnosis.propose(&config).expect("valid");
        let mut control = ControlLoop::new(
            Controller::new(&waived()).expect("valid"),
            config.setpoint,
            Interlock::default(),
        );
        let order = Some(Order::Retune(Controller::new(&diagnosis.in_force(&config)).expect("valid")));
        let raw = RawSample {
            t0: AdcCode(2160.0),
            t1: AdcCode(2160.0),
            t2: AdcCode(2160.0),
            ..RawSample::default()
        };
        let record =
            control.tick(raw, Arrival::default(), order, Feedback::default(), &mut Output::default());
        diagnosis.step(record, |_| {});
        assert_eq!(diagnosis.to_keep().baseline, kept, "{sample_time} s");
        assert_eq!(diagnosis.baseline().copied(), learnt, "in force until then");
    }
}

#[test]
fn an_order_without_an_answer_is_in_force_once_it_was_carried_out() {
    let mut board = at_rest();
    let mut config = waived();
    config.pid.kp += 1.0;
    board.chip.deaf = true;
    assert_eq!(now(board.apply(&config)), Err(ApplyError::Denied(Denial::NoAnswer)));
    assert_eq!(board.config(), waived());
    now(board.chip.pause());
    assert_eq!(
        board.config(),
        config,
        "what `get` shows and `save` keeps is what the control half runs with"
    );
}

#[test]
fn a_lockout_is_told_kept_in_the_history_and_told_when_released() {
    let mut board = heating();
    assert_eq!(
        board.chip.told(),
        ["order 1 arm", "armed without a check", "mode 1 off -> settle", "likelihood 1 in training"],
        "and the record of each tick: training begins with the first heat"
    );
    board.chip.output.open = true;
    board.chip.output.enabled = false;
    board.chip.tick(None).expect("no order");
    assert!(board.chip.notices.contains(&Notice::Lockout { tick: 2, lockout: Some(Lockout::BreakInput) }));
    assert_eq!(
        board.chip.told(),
        [
            "mode 2 settle -> off",
            "lockout 2 the interlock on the break input opened",
            "likelihood 2 not trained"
        ],
        "training ends with the heat"
    );
    assert_eq!(board.fault(0), Some(Entry::Lockout { lockout: Lockout::BreakInput, tick: 2 }));
    let denied = now(board.command(Command::Arm)).expect_err("locked out");
    assert_eq!(board.chip.told(), [format!("denied 3 {denied}")]);
    now(board.command(Command::Acknowledge)).expect("released");
    assert_eq!(board.chip.told(), ["order 4 ack", "released 4"]);
}

#[test]
fn a_trip_and_missed_ticks_are_told_and_kept() {
    let mut board = heating();
    board.chip.told();
    let mut record = board.chip.control.tick(
        RawSample { t0: AdcCode(2160.0), t1: AdcCode(300.0), t2: AdcCode(2160.0), ..RawSample::default() },
        Arrival { due: 0, late_us: 30, missed: 2 },
        None,
        Feedback::default(),
        &mut board.chip.output,
    );
    board.chip.diagnosis.step(record.clone(), |notice| board.chip.notices.push(notice));
    let told = board.chip.told();
    assert!(told[0] == "mode 2 settle -> tripped" && told[1].contains(" s trip: "), "{told:?}");
    assert_eq!(told[2..], ["likelihood 2 not trained", "2 ticks missed before tick 2"]);
    assert!(matches!(board.fault(0), Some(Entry::Trip(_))));
    let jitter = board.status().health.jitter;
    assert_eq!((jitter.ticks, jitter.missed, jitter.worst_us), (3, 2, 30));
    record.missed = true;
    record.tick.index = 3;
    board.chip.diagnosis.step(record, |_| {});
    assert_eq!(
        board.status().health.jitter,
        jitter,
        "a tick that was missed is counted where the next begins"
    );
}

#[test]
fn only_a_baseline_that_can_have_been_learnt_is_restored() {
    let normal = Normal { mean: [0.5; 7], sigma: [0.1; 7] };
    let learnt = Baseline { samples: 1636, raw: normal, filtered: normal };
    assert_eq!(board(Stored { config: waived(), baseline: Some(learnt) }).baseline(), Some(learnt));
    let broken = Baseline { raw: Normal { mean: [f32::NAN; 7], sigma: [0.1; 7] }, ..learnt };
    assert_eq!(board(Stored { config: waived(), baseline: Some(broken) }).baseline(), None);
}

/// What the flash of a board has, by its next start.
fn kept(board: ConsoleBoard<TestChip, Flash>) -> Option<Commissioning> {
    now(Store::new(board.into_flash()).commissioning())
}

#[test]
fn a_commissioning_is_written_once_and_only_while_nothing_heats() {
    let models = Commissioned { parameters: [0.3; PARAMETERS] };
    let commissioning = Commissioning { number: 1, models };
    let mut board = heating();
    let stalls = board.chip.stalls;
    board.chip.change(|diagnosis| diagnosis.commissioned(Some(commissioning)));
    now(board.settle());
    assert_eq!(board.chip.stalls, stalls, "it heats");
    board.chip.notices.clear();
    for ticks in [1, 2] {
        board.chip.tick(None).expect("no order");
        let told = board.chip.notices.iter().filter(|notice| matches!(notice, Notice::Commissioning(_)));
        assert_eq!(told.count(), 1, "told once, {ticks} ticks later");
    }
    assert_eq!(board.chip.notices[0], Notice::Commissioning(Some(commissioning)), "before the tick");
    now(board.command(Command::Stop)).expect("always");
    now(board.settle());
    let written = board.chip.stalls;
    assert!(written > stalls);
    now(board.settle());
    assert_eq!(board.chip.stalls, written, "written once");
    assert!(board.status().to_string().contains("\ncommissioning 1\n"));
    assert_eq!(kept(board), Some(commissioning));
}

#[test]
fn a_commissioning_that_is_cleared_is_gone_at_the_next_start_and_one_untrained_is_none() {
    let mut board = at_rest();
    assert!(!board.commission(), "nothing is trained");
    let models = Commissioned { parameters: [0.3; PARAMETERS] };
    board.chip.change(|diagnosis| diagnosis.commissioned(Some(Commissioning { number: 1, models })));
    now(board.settle());
    board.decommission();
    now(board.settle());
    assert_eq!(kept(board), None);
}

#[test]
fn a_stop_overtakes_and_forgets_what_heats() {
    let mut queue: Queue<Order, 4> = Queue::new();
    let (mut give, mut waiting) = queue.split();
    let mut kinds = |stop, orders: &[Order]| {
        orders.iter().for_each(|order| give.enqueue(order.clone()).expect("room"));
        core::iter::once(next_order(stop, &mut waiting))
            .chain(core::iter::from_fn(|| next_order(false, &mut waiting)).map(Some))
            .map(|order| order.map(|order| order.kind()))
            .collect::<Vec<_>>()
    };
    let (arm, ack) = (Order::Command(Command::Arm), Order::Command(Command::Acknowledge));
    let (armed, acknowledged) = (Some(arm.kind()), Some(ack.kind()));
    let stop = Some(OrderKind::Command(Command::Stop));
    assert_eq!(kinds(false, &[arm.clone(), ack.clone()]), [armed, acknowledged]);
    assert_eq!(kinds(true, &[arm, Order::Check, ack]), [stop, acknowledged]);
    assert_eq!(kinds(true, &[]), [stop]);
    assert_eq!(kinds(false, &[]), [None]);
}

#[test]
fn a_restart_is_refused_while_it_heats_checks_or_is_latched() {
    let restart = |board: &mut ConsoleBoard<TestChip, Flash>| now(Board::restart(board, Restart::Streaming));
    assert_eq!(restart(&mut heating()), Err(BoardError::NotOff));

    let mut checking = at_rest();
    now(checking.check()).expect("begins");
    assert_eq!(restart(&mut checking), Err(BoardError::NotOff));

    let mut cut = heating();
    cut.chip.output.enabled = false; // the interlock opens
    assert_eq!(restart(&mut cut), Err(BoardError::Latched), "it waits for the tick that latches it");
    assert_eq!(cut.chip.restarted, None);
    now(cut.command(Command::Acknowledge)).expect("acknowledged");
    let _ = restart(&mut cut);
    assert_eq!(cut.chip.restarted, Some(Restart::Streaming));
}

/// Models of the simulated rig would be those that the real one is held against later.
#[test]
fn a_board_that_is_simulated_writes_nothing_to_its_flash() {
    let mut board = at_rest();
    board.chip.simulated = true;
    now(board.command(Command::Arm)).expect("arms");
    let models = Commissioned { parameters: [0.3; PARAMETERS] };
    board.chip.change(|diagnosis| diagnosis.commissioned(Some(Commissioning { number: 1, models })));
    now(board.command(Command::Stop)).expect("always");
    now(board.settle());
    assert_eq!(now(board.save()), Err(SaveError::Simulated));
    assert_eq!(board.chip.stalls, 0);
    assert_eq!(kept(board), None);
}
