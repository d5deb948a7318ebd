//! What `pt326 live --board` watches and orders, on the unmodified image behind its port.

use std::time::{Duration, Instant};

use fdi_core::schema::{self, Numbers};
use firmware_logic::console::line::LENGTH;
use pt326_host::board::Session;
use pt326_host::board::watch::Watch;
use pt326_lab::names::Names;
use pt326_lab::scene::Order;
use pt326_lab::told::Told;

use crate::live::LiveBoard;

/// A test that waits longer for a word hangs.
const HANGS: Duration = Duration::from_secs(120);

/// All that is told up to what is waited for.
fn until(watch: &mut Watch, what: &str, mut is_it: impl FnMut(&Told) -> bool) -> Vec<Told> {
    let (begin, mut all) = (Instant::now(), Vec::new());
    loop {
        assert!(begin.elapsed() < HANGS, "no {what} in {all:?}");
        let Some(told) = watch.take() else {
            std::thread::yield_now();
            continue;
        };
        let ends = is_it(&told);
        all.push(told);
        if ends {
            return all;
        }
    }
}

fn of(row: &Numbers, name: &str) -> f32 {
    row[schema::field(name).expect("a field")]
}

fn in_mode(mode: f32) -> impl Fn(&Told) -> bool {
    move |told| matches!(told, Told::Row(row) if of(row, "mode") == mode)
}

/// A number of rows that are all in a mode.
fn stays_in_mode(watch: &mut Watch, mode: f32) {
    let mut rows = 0;
    until(watch, "rows", |told| {
        if let Told::Row(row) = told {
            assert_eq!(of(row, "mode"), mode);
            rows += 1;
        }
        rows == 50
    });
}

fn watched(board: &LiveBoard) -> Watch {
    let mut session = Session::open(&board.name).expect("answers");
    session.order("set supervisor.check_before_arming false").expect("takes it");
    drop(session);
    Watch::open(&board.name).expect("watches")
}

#[test]
fn it_is_armed_set_and_stopped_from_afar() {
    let board = LiveBoard::new();
    let mut watch = watched(&board);
    let first = until(&mut watch, "row", in_mode(0.0));
    assert_eq!(first[0], Told::Link(true), "{first:?}");
    watch.order(&Order::Setpoint { celsius: 36.0 }).expect("passed on");
    watch.order(&Order::Arm).expect("passed on");
    let told = until(&mut watch, "heat", |told| {
        in_mode(1.0)(told) && matches!(told, Told::Row(row) if of(row, "drive") > 0.0)
    });
    assert!(told.contains(&Told::Order(Order::Setpoint { celsius: 36.0 })), "{told:?}");
    assert!(told.contains(&Told::Order(Order::Arm)), "{told:?}");
    watch.order(&Order::Stop).expect("sent");
    until(&mut watch, "stop", in_mode(0.0));
    // What the board refuses is told, and what a board has not is refused here.
    watch.order(&Order::Set { name: "pid.kp".into(), value: -1.0 }).expect("passed on");
    let told = until(&mut watch, "refusal", |told| matches!(told, Told::Refused { .. }));
    assert!(format!("{:?}", told.last()).contains("pid.kp"), "{told:?}");
    assert!(watch.order(&Order::Mend).is_err());
}

#[test]
fn a_stop_is_the_last_word_whatever_was_ordered_before_it() {
    let board = LiveBoard::new();
    let mut watch = watched(&board);
    // The first order keeps the conversation busy, so that the second waits for it.
    watch.order(&Order::Setpoint { celsius: 36.0 }).expect("passed on");
    watch.order(&Order::Arm).expect("passed on");
    watch.order(&Order::Stop).expect("sent");
    until(&mut watch, "word of the arming", |told| {
        matches!(told, Told::Refused { .. } | Told::Order(Order::Arm))
    });
    watch.order(&Order::Set { name: "pid.kp".into(), value: 2.5 }).expect("passed on");
    until(&mut watch, "the last order", |told| matches!(told, Told::Order(Order::Set { value: 2.5, .. })));
    stays_in_mode(&mut watch, 0.0);
}

#[test]
fn a_cable_that_is_pulled_out_is_told_at_once_and_the_board_goes_on() {
    let board = LiveBoard::new();
    let mut watch = watched(&board);
    watch.order(&Order::Arm).expect("passed on");
    until(&mut watch, "heat", in_mode(1.0));
    board.desk("unplug");
    until(&mut watch, "word of the port", |told| *told == Told::Link(false));
    let error = format!("{:#}", watch.order(&Order::Stop).expect_err("nobody is there"));
    assert!(error.contains("NOT reached the board"), "{error}");
    assert!(watch.order(&Order::Arm).is_err());
    board.desk("plug");
    let told = until(&mut watch, "row after the gap", in_mode(1.0));
    assert!(told.contains(&Told::Link(true)), "{told:?}");
    let rows = told.iter().filter(|told| matches!(told, Told::Row(_)));
    assert!(rows.count() > 1, "the gap has rows, too");
    watch.order(&Order::Stop).expect("sent");
    until(&mut watch, "stop", in_mode(0.0));
    stays_in_mode(&mut watch, 0.0);
}

#[test]
fn its_console_answers_a_stop_typed_there_waits_for_nothing_and_names_of_a_users_own_are_told() {
    let board = LiveBoard::new();
    let mut watch = watched(&board);
    let type_in = |watch: &mut Watch, line: &str| watch.order(&Order::Console { line: line.into() });
    type_in(&mut watch, "set diagnosis.isolation.4 4 0 +1 0 -1 0 low").expect("passed on");
    let named = Told::Names(Names { rows: vec![(4, "low".into())], taught: Vec::new() });
    let told = until(&mut watch, "names", |told| *told == named);
    let said =
        |told: &Told| matches!(told, Told::Said(text) if text.starts_with("> set diagnosis.isolation.4"));
    assert!(told.iter().any(said), "{told:?}");
    type_in(&mut watch, "set likelihood.taught.1 cap 0 0 0 0 150 -150 0 0 0 0 0").expect("passed on");
    let both = Told::Names(Names { rows: vec![(4, "low".into())], taught: vec!["cap".into()] });
    until(&mut watch, "names of both", |told| *told == both);
    type_in(&mut watch, "arm").expect("passed on");
    until(&mut watch, "heat", in_mode(1.0));
    type_in(&mut watch, " stop it").expect("sent");
    until(&mut watch, "stop", in_mode(0.0));
    assert!(type_in(&mut watch, &"x".repeat(LENGTH + 1)).is_ok());
    let told = until(&mut watch, "refusal", |told| matches!(told, Told::Refused { .. }));
    assert!(format!("{:?}", told.last()).contains(&format!("at most {LENGTH}")), "{told:?}");
}
