//! What is noticed is told and kept.

use fdi_core::{AdcCode, Command, Feedback, RawSample};
use firmware_logic::cadence::Arrival;
use firmware_logic::console::{Board, carry_out};
use firmware_logic::history::Entry;
use firmware_logic::interlock::Lockout;
use firmware_logic::log_line::LogLine;
use firmware_logic::notice::Notice;
use firmware_logic::settings::store::Origin;
use firmware_logic::settings::stored::{MAX_BYTES, Stored};

use crate::{heating, now};

#[test]
fn a_lockout_is_told_kept_in_the_history_and_told_when_released() {
    let mut board = heating();
    assert_eq!(
        board.chip.told(),
        [
            "order 1 arm",
            "armed without a check",
            "wider than the default: supervisor.check_before_arming = false",
            "mode 1 off -> settle",
            "likelihood 1 in training"
        ],
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

/// In the log at each arming, in a form that is read again, and in `status`.
#[test]
fn limits_wider_than_the_default_are_told_at_each_arming() {
    let mut board = heating();
    now(board.command(Command::Stop)).expect("stops");
    let mut config = board.config();
    config.supervisor.signal_timeout.0 = 2.0;
    config.supervisor.max_disagreement.0 = 4.0; // narrower
    now(board.apply(&config)).expect("at rest");
    board.chip.told();
    now(board.command(Command::Arm)).expect("arms");
    let told = board.chip.told();
    let limits: Vec<_> = told.iter().filter_map(|line| LogLine::find(line).expect("whole")).collect();
    let wider = |name, value| LogLine::Wider { name, value };
    assert!(limits.contains(&wider("supervisor.signal_timeout", "2 s")), "{told:?}");
    assert!(limits.contains(&wider("supervisor.check_before_arming", "false")), "{told:?}");
    assert_eq!(limits.iter().filter(|line| matches!(line, LogLine::Wider { .. })).count(), 2);
    let mut said = String::new();
    now(carry_out("status", &mut board, &mut said));
    assert!(said.contains("\nwider than the default: supervisor.signal_timeout = 2 s\n"), "{said}");
}

/// What an older release saved with a limit wider than it may be now is not taken over, and the reason names it.
#[test]
fn a_saved_limit_that_is_out_of_bounds_by_now_is_told() {
    let mut saved = Stored::default();
    saved.config.supervisor.cooling_time.0 = 100.0;
    let mut buffer = [0; MAX_BYTES];
    let error = Stored::decode(saved.encode(&mut buffer).expect("room")).expect_err("wider than allowed");
    assert_eq!(
        Origin::Fallback(error).to_string(),
        "DEFAULTS, since the saved record is invalid: supervisor.cooling_time is 100, expected at most 64: 32 times identification.answer_time (2)"
    );
}
