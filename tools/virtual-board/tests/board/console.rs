//! The serial port: what a person types is done or refused with a reason, and nothing that comes in touches the control
//! tick.

use firmware_logic::console::line::is_stop_key;
use firmware_logic::console::request::COMMANDS;
use virtual_board::board::{Board, load};
use virtual_board::scene::{Scene, WAIVE_CHECK};
use virtual_board::time::{MS, SECOND};

fn at_rest() -> Scene {
    Scene::at_rest(load(None).expect("an image")).expect("boots")
}

#[test]
fn every_command_answers() {
    let mut scene = at_rest();
    let board = &mut scene.board;
    let mut say = |line: &str| board.command(line).expect("answers");
    let help = say("help");
    assert!(COMMANDS.iter().all(|(name, ..)| help.contains(name)), "{help}");
    assert!(say("status").contains("mode off"));
    assert!(say("get").contains("pid.kp = 2.4 %/degC") && say("get").lines().count() > 30);
    assert_eq!(say("set pid.kp 2"), "pid.kp = 2 %/degC");
    assert_eq!(say("defaults"), "ok");
    assert_eq!(say("baseline"), "nothing learnt yet");
    assert_eq!(say("faults"), "none");
    assert!(say("ack").starts_with("error: "));
    assert!(say("arm").contains("no `check` has passed since the start"));
    assert!(say("check").starts_with("ok") && say("status").contains("check under way"));
    assert_eq!(say("stop"), "stopped");
    say(WAIVE_CHECK);
    assert!(say("arm").ends_with("ok, armed without a check")); // what the check leaves may be told first
    assert!(say("baseline learn").contains("ok"));
    assert_eq!(say("stop"), "stopped");
    assert_eq!(say("save"), "ok");
}

#[test]
fn errors_name_what_was_wrong() {
    let mut scene = at_rest();
    let mut say = |line: &str| scene.board.command(line).expect("answers");
    assert!(say("amr").contains("amr"));
    assert!(say("set pid.kq 1").contains("pid.kq"));
    assert!(say("set pid.kp x").contains('x'));
    assert!(say("set pid.kp -1").contains("pid.kp"));
    assert!(say(&"arm ".repeat(40)).contains("too long"));
}

/// Lateness and outputs of the control half, tick by tick.
fn ticks(board: &Board) -> Vec<(u32, u32, u32, bool)> {
    let records = board.log.iter().filter_map(|line| line.tick());
    records.map(|r| (r.tick(), r.late_us(), r.applied().0.to_bits(), r.missed())).collect()
}

/// Bytes at full speed for a time: every value but the stop keys, line ends included, and near-commands.
fn garbage(seconds: usize) -> Vec<u8> {
    let mut state = 7u32;
    let noise = std::iter::repeat_with(move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    });
    noise.filter(|byte| !is_stop_key(*byte)).take(11_520 * seconds).collect()
}

#[test]
fn a_flood_of_garbage_changes_no_control_tick() {
    let image = load(None).expect("an image");
    let mut quiet = Scene::heating(image.clone()).expect("heats");
    let mut flooded = Scene::heating(image).expect("heats");
    flooded.board.send(&garbage(20));
    quiet.board.run_for(22 * SECOND).expect("runs on");
    flooded.board.run_for(22 * SECOND).expect("runs on");
    let (quiet, told) = (ticks(&quiet.board), ticks(&flooded.board));
    assert_eq!(quiet.len(), told.len());
    let worst = told.iter().map(|tick| tick.1).max().unwrap_or(0);
    assert!(worst <= 5, "a tick was {worst} us late");
    for (a, b) in quiet.iter().zip(&told) {
        assert_eq!((a.0, a.2, a.3), (b.0, b.2, b.3), "tick {}", a.0);
    }
    assert_eq!(flooded.board.resets, []);
    flooded.board.command("").expect("the console still answers");
    assert!(flooded.board.command("status").expect("answers").contains("mode settle"));
}

#[test]
fn garbage_never_arms() {
    let mut scene = at_rest();
    scene.board.send(&garbage(20));
    scene.board.run_for(22 * SECOND).expect("runs on");
    assert_eq!(scene.board.chip().heater_log.len(), 1);
    assert_eq!(scene.board.resets, []);
}

#[test]
fn a_line_held_low_is_no_trouble() {
    let mut scene = at_rest();
    scene.board.send(&vec![0; 11_520]);
    scene.board.run_for(1500 * MS).expect("runs on");
    scene.board.command("").expect("answers");
    assert!(scene.board.command("status").expect("answers").contains("mode off"));
}

#[test]
fn an_order_that_nobody_carries_out_is_answered() {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    scene.board.cpu.touch(|chip, _| chip.scs.nvic.enable(84, false)); // the control task's executor
    scene.board.take_terminal();
    scene.board.send(b"ack\r");
    scene.board.run_for(500 * MS).expect("runs on");
    let answer = scene.board.take_terminal();
    assert!(answer.contains("not carried out"), "{answer}");
    assert_eq!(scene.board.resets, [], "before the watchdog bites");
}

#[test]
fn no_line_is_torn_however_many_came_before() {
    let mut scene = at_rest();
    for i in 0..100 {
        // 7 and 13 bytes: many places of both meet the end of a ring of 256.
        assert_eq!(scene.board.command("faults").expect("answers"), "none", "line {i}");
        let answer = scene.board.command("get setpoint").expect("answers");
        assert!(answer.starts_with("setpoint = "), "line {i}: {answer}");
    }
}
