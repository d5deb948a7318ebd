//! The console against a board that obeys the control loop's own rules.

use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::diagnosis::signature::Signature;
use fdi_core::likelihood::Channel;
use fdi_core::likelihood::Magnitude;
use fdi_core::likelihood::taught::{EFFECTS, Response};
use fdi_core::name::Name;
use fdi_core::tune::Standing;
use fdi_core::{Celsius, Command, Config, FaultClass, Finding, Instrument, Mode, RawSample, Seconds};
use firmware_logic::calibration::{Calibration, Still};
use firmware_logic::console::{ANSWER, ApplyError, Board, BoardError, Console, line};
use firmware_logic::control_loop::{Denial, TickRecord};
use firmware_logic::history::Entry;
use firmware_logic::interlock::Lockout;
use firmware_logic::reset_cause::Restart;
use firmware_logic::self_test::{CheckFinding, Ending, News, Progress, Stage};
use firmware_logic::settings::store::SaveError;
use firmware_logic::settings::stored::check;
use firmware_logic::status::Status;
use firmware_logic::teaching::Teaching;
use firmware_logic::tuning::Tuner;
use proptest::prelude::*;

/// Remembers what it was asked.
#[derive(Debug, Default)]
struct Mock {
    asked: Vec<String>,
    config: Config,
    held: Option<Lockout>,
    heating: bool,
    progress: Progress,
    trained: bool,
    calibration: Calibration,
    tuning: Option<Standing>,
    tuner: Tuner,
    teaching: Teaching,
    status: Status,
}

impl Board for Mock {
    async fn command(&mut self, command: Command) -> Result<(), Denial> {
        self.asked.push(format!("{command:?}"));
        match (command, self.held) {
            (Command::Arm, Some(lockout)) => Err(Denial::LockedOut(lockout)),
            (Command::Arm, None) => {
                self.heating = true;
                Ok(())
            }
            _ => Ok(()),
        }
    }
    async fn check(&mut self) -> Result<(), Denial> {
        self.asked.push("check".into());
        self.progress.note(News::Stage(Stage::Rest));
        Ok(())
    }
    fn progress(&self) -> Progress {
        self.progress.clone()
    }
    fn stop(&mut self) {
        self.asked.push("stop".into());
        self.heating = false;
    }
    fn status(&self) -> Status {
        self.status.clone()
    }
    fn sample_time(&self) -> Seconds {
        Config::default().sample_time
    }
    fn config(&self) -> Config {
        self.config.clone()
    }
    async fn apply(&mut self, config: &Config) -> Result<(), ApplyError> {
        check(config)?;
        self.config = config.clone();
        Ok(())
    }
    async fn save(&mut self) -> Result<(), SaveError> {
        if self.heating { Err(SaveError::Heating) } else { Ok(()) }
    }
    fn set_brown_out_level(&mut self) -> Result<(), SaveError> {
        self.asked.push("brownout".into());
        if self.heating { Err(SaveError::Heating) } else { Ok(()) }
    }
    fn commission(&mut self) -> bool {
        self.asked.push("commission".into());
        self.trained
    }
    fn decommission(&mut self) {
        self.asked.push("decommission".into());
    }
    fn still(&self) -> Still {
        Still::default()
    }
    fn calibration(&mut self) -> &mut Calibration {
        &mut self.calibration
    }
    fn tuning(&self) -> Option<Standing> {
        self.tuning
    }
    fn tuner(&mut self) -> &mut Tuner {
        &mut self.tuner
    }
    fn teach<R>(&mut self, change: impl FnOnce(&mut Teaching) -> R) -> R {
        change(&mut self.teaching)
    }
    async fn pause(&mut self) {}
    fn stream(&mut self, on: bool) -> Result<(), BoardError> {
        self.asked.push(format!("stream {on}"));
        Ok(())
    }
    async fn restart(&mut self, _: Restart) -> Result<(), BoardError> {
        if self.heating { Err(BoardError::NotOff) } else { Err(BoardError::NoBoard) }
    }
    fn baseline(&self) -> Option<Baseline> {
        Some(Baseline { samples: 1637, ..Baseline::default() })
    }
    fn fault(&self, index: usize) -> Option<Entry> {
        (index < 2).then_some(Entry::Lockout { lockout: Lockout::BreakInput, tick: 100 * (index as u32 + 1) })
    }
}

fn now<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => panic!("the mock never waits"),
    }
}

/// Types bytes and returns all that the terminal shows.
fn type_in(board: &mut Mock, bytes: &[u8]) -> String {
    let (mut console, mut shown) = (Console::default(), String::new());
    for &byte in bytes {
        now(console.push(byte, board, &mut shown));
    }
    shown
}

/// The answer to one line, without its echo and the prompt.
fn answer(board: &mut Mock, line: &str) -> String {
    let shown = type_in(board, format!("{line}\r").as_bytes());
    let echo = format!("{line}\n");
    let answer = shown.strip_prefix(&echo).unwrap_or_else(|| panic!("no echo of {line:?} in {shown:?}"));
    answer.strip_suffix("> ").expect("a prompt").to_owned()
}

#[test]
fn commissions_what_is_trained_and_announces_the_fan() {
    let mut board = Mock::default();
    assert!(answer(&mut board, "commission").starts_with("error: no models are trained yet"));
    board.trained = true;
    assert_eq!(answer(&mut board, "commission"), "ok, kept once the heater is off\n");
    assert_eq!(answer(&mut board, "commission clear"), "ok\n");
    assert_eq!(answer(&mut board, "fan 80"), "ok\n");
    assert!(answer(&mut board, "fan slow").starts_with("error: fan: \"slow\" given, expected a number"));
    assert_eq!(board.asked, ["commission", "commission", "decommission", "Fan(Percent(80.0))"]);
}

#[test]
fn arms_stops_and_acknowledges() {
    let mut board = Mock { held: Some(Lockout::BreakInput), ..Mock::default() };
    let refused = answer(&mut board, "arm");
    assert_eq!(refused, "error: locked out: the interlock on the break input opened; expected `ack` first\n");
    assert_eq!(answer(&mut board, "ack"), "ok\n");
    assert_eq!(answer(&mut board, "stop"), "stopped\n");
    assert_eq!(board.asked, ["Arm", "Acknowledge", "stop"]);
}

/// The board monitors, and tells this class, or nothing.
fn told(class: Option<FaultClass>) -> Mock {
    sized(class, Some(Magnitude { value: 1.5, half_width: 0.2 }))
}

fn sized(class: Option<FaultClass>, magnitude: Option<Magnitude>) -> Mock {
    let mut instrument = Instrument::new(&Config::default()).expect("the defaults are valid");
    let mut tick = instrument.control(RawSample::default());
    let mut report = instrument.diagnose(&tick, tick.drive);
    tick.mode = Mode::Monitor;
    report.likelihood.alarm = class.is_some();
    report.likelihood.finding = class.map(|class| Finding { class, confidence: 0.9, magnitude, onset: 0 });
    let record = TickRecord::new(RawSample::default(), tick, tick.drive);
    Mock { status: Status { last: Some((record, report)), ..Status::default() }, ..Mock::default() }
}

#[test]
fn an_alarm_is_acknowledged_shelved_or_accepted() {
    let mut board = told(Some(FaultClass::T2Offset));
    assert_eq!(answer(&mut board, "ack"), "ok\n");
    assert_eq!(answer(&mut board, "shelve 30"), "ok\n");
    assert!(answer(&mut board, "accept").starts_with("ok, learning it as normal"));
    assert!(
        answer(&mut board, "shelve long").starts_with("error: shelve: \"long\" given, expected a number")
    );
    assert_eq!(board.asked, ["Acknowledge", "Shelve(Seconds(1800.0))", "Relearn"]);
}

#[test]
fn what_may_trip_is_neither_shelved_nor_accepted_and_where_nothing_stands_nothing_is_done() {
    let mut board = told(Some(FaultClass::T1Detached));
    let mut calm = told(None);
    // A heater that gives always the same has no size.
    let mut constant = sized(Some(FaultClass::HeaterPower), None);
    for line in ["accept", "shelve 30"] {
        assert!(answer(&mut board, line).starts_with("error: what is named may trip"), "{line}");
        assert!(answer(&mut constant, line).starts_with("error: what is named may trip"), "{line}");
    }
    // Whether the air is lost, a trip, is held against what was learnt.
    let mut air = told(Some(FaultClass::AirFlow));
    assert!(answer(&mut air, "accept").starts_with("error: what is named may trip"));
    assert_eq!(answer(&mut air, "shelve 30"), "ok\n");
    for line in ["ack", "accept", "shelve 30"] {
        assert!(answer(&mut calm, line).starts_with("error: no"), "{line}");
    }
    assert_eq!([&board, &constant, &calm].map(|board| board.asked.len()), [0; 3]);
    assert_eq!(answer(&mut calm, "shelve 0"), "ok\n", "it can always be taken off the shelf");
}

/// While it is off or still learns, nothing stands, whatever was named last.
#[test]
fn nothing_is_accepted_but_while_it_monitors() {
    for mode in [Mode::Off, Mode::Settle { steady: 3 }, Mode::Learn { accepted: 40 }] {
        let mut board = told(Some(FaultClass::T2Offset));
        board.status.last.as_mut().expect("a tick").0.tick.mode = mode;
        assert!(answer(&mut board, "accept").starts_with("error: nothing is named"), "{mode:?}");
        assert!(board.asked.is_empty(), "{mode:?}");
    }
}

#[test]
fn settings_are_checked_by_the_core_before_they_count() {
    let mut board = Mock::default();
    assert_eq!(answer(&mut board, "set pid.kp 3.5"), "pid.kp = 3.5 %/degC\n");
    assert_eq!(answer(&mut board, "get pid.k"), "pid.kp = 3.5 %/degC\n");
    let row = "diagnosis.isolation.2 = 2 +1 x -1 0 -1\n";
    assert_eq!(answer(&mut board, "get diagnosis.isolation.2"), row);
    assert_eq!(answer(&mut board, "set pid.kp -1"), "error: pid.kp is -1, expected 0 to 1000\n");
    assert_eq!(
        answer(&mut board, "set sample_time 0.02"),
        "error: sample_time is 0.02, expected 0.05 to 5\n"
    );
    assert_eq!(
        answer(&mut board, "set sample_time 0.2"),
        "sample_time = 0.2 s\nsample_time is in force from the next start on, once saved\n"
    );
    assert_eq!(board.config.pid.kp, 3.5);
    assert_eq!(answer(&mut board, "get nothing"), "error: no setting \"nothing\", see `get`\n");
    assert_eq!(answer(&mut board, "defaults"), "ok\n");
    assert_eq!(board.config, Config::default());
}

#[test]
fn a_new_set_point_also_reaches_the_running_loop() {
    let mut board = Mock::default();
    assert_eq!(answer(&mut board, "set setpoint 40"), "setpoint = 40 degC\n");
    assert_eq!(board.asked, ["SetPoint(Celsius(40.0))"]);
    assert_eq!(answer(&mut board, "defaults"), "ok\n");
    assert_eq!(board.asked.pop().as_deref(), Some("SetPoint(Celsius(35.0))"));
    assert_eq!(answer(&mut board, "set setpoint 99"), "error: setpoint is 99, expected 20 to 65\n");
    assert_eq!(board.asked.len(), 1, "what is refused reaches nothing");
}

#[test]
fn nothing_is_saved_while_heating() {
    let mut board = Mock::default();
    assert_eq!(answer(&mut board, "save"), "ok\n");
    answer(&mut board, "arm");
    assert_eq!(answer(&mut board, "save"), "error: not while heating, expected `stop` first\n");
}

#[test]
fn the_longest_answers_fit() {
    let mut board = Mock::default();
    let name: Name = "twelve-bytes".parse().expect("a name");
    let pattern = "+1 -1 +1 -1 +1".parse().expect("a pattern");
    for rows in [&mut board.config.diagnosis.detection, &mut board.config.diagnosis.isolation] {
        while rows.push(Signature { number: 100, pattern, name }).is_ok() {}
    }
    let taught = &mut board.config.likelihood.taught;
    while taught.push(Response { name, effects: [i16::MIN; EFFECTS] }).is_ok() {}
    for line in ["get", "help", "faults", "baseline", "status"] {
        let answer = answer(&mut board, line);
        assert!(!answer.is_empty() && answer.len() < ANSWER - 100, "{line}: {} bytes", answer.len());
    }
    assert!(answer(&mut board, "get").contains("supervisor.over_temperature = 75 degC\n"));
    assert_eq!(answer(&mut board, "faults").lines().count(), 2);
}

#[test]
fn typing_is_shown_and_can_be_corrected() {
    let mut board = Mock::default();
    assert_eq!(type_in(&mut board, b"ar\x7frm\n"), "ar\x08 \x08rm\nok, armed without a check\n> ");
    assert_eq!(board.asked, ["Arm"]);
}

#[test]
fn a_stop_key_stops_at_once_and_the_line_it_came_in_does_nothing() {
    for key in [0x03, 0x1B, b'!'] {
        let mut board = Mock { heating: true, ..Mock::default() };
        let shown = type_in(&mut board, &[b'a', b'r', key]);
        assert_eq!(board.asked, ["stop"], "before any line end");
        assert!(shown.ends_with("forgotten\n> "), "{shown:?}");
        type_in(&mut board, b"m\n");
        assert_eq!(board.asked, ["stop"], "\"m\" is no command");
    }
}

#[test]
fn a_check_is_followed_while_it_is_under_way() {
    let (mut board, mut console, mut shown) = (Mock::default(), Console::default(), String::new());
    assert!(answer(&mut board, "check").starts_with("ok"));
    let mut follow = |board: &Mock, console: &mut Console| {
        shown.clear();
        console.follow(board, &mut shown);
        shown.clone()
    };
    assert_eq!(follow(&board, &mut console), "\ncheck: thermistors at rest\n> ");
    assert_eq!(follow(&board, &mut console), "", "nothing new");
    board.config.sensors.t2.offset = Celsius(0.5);
    board.progress.note(News::Found(CheckFinding::Offset(Channel::T2, 1.25)));
    board.progress.note(News::Found(CheckFinding::Unheated));
    let told = follow(&board, &mut console);
    assert!(
        told.contains("T2 reads 1.25 degC from") && told.contains("`set sensors.t2.offset -0.75`"),
        "{told}"
    );
    assert!(told.contains("\nno thermistor answers"), "{told}");
    board.progress.note(News::Ended(Ending::Failed(1)));
    assert_eq!(follow(&board, &mut console), "\ncheck failed: 1 finding\n> ");
    board.progress.note(News::Stage(Stage::Rest));
    assert_eq!(board.progress.findings, [], "another check begins with nothing");
    assert_eq!(follow(&board, &mut console), "\ncheck: thermistors at rest\n> ");
}

#[test]
fn over_long_lines_do_nothing_at_all() {
    let mut board = Mock::default();
    let long = format!("set pid.kp 1{}\n", " ".repeat(line::LENGTH));
    let shown = type_in(&mut board, long.as_bytes());
    assert!(shown.ends_with(" \nerror: line too long, expected at most 120 characters\n> "), "{shown:?}");
    assert_eq!(board.config, Config::default());
}

proptest! {
    /// Garbage at full speed: no panic, no heat, and the next line works.
    #[test]
    fn garbage_never_heats(garbage in proptest::collection::vec(any::<u8>(), 0..300)) {
        prop_assume!(!String::from_utf8_lossy(&garbage).contains("arm"));
        let mut board = Mock::default();
        let stops = 1 + garbage.iter().filter(|byte| line::is_stop_key(**byte)).count();
        let mut bytes = garbage;
        bytes.extend(b"\nstop\n");
        let shown = type_in(&mut board, &bytes);
        prop_assert!(!board.heating);
        prop_assert!(shown.ends_with("stop\nstopped\n> "), "{:?}", shown);
        prop_assert_eq!(board.asked, vec!["stop"; stops]);
    }

    /// Words of the console in any order: settings stay valid whatever is typed.
    #[test]
    fn settings_stay_valid(lines in proptest::collection::vec("(set|get|defaults|save) (setpoint|pid.kp|prbs.bits|diagnosis.isolation.1|supervisor.over_temperature) [-0-9.e+x ]{0,12}", 1..20)) {
        let mut board = Mock::default();
        for line in lines {
            type_in(&mut board, format!("{line}\n").as_bytes());
            prop_assert_eq!(check(&board.config), Ok(()));
        }
    }
}
