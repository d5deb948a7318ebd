//! What is kept in flash outlives resets, power cycles and a supply that goes in the middle of a write.

use virtual_board::board::{Board, load};
use virtual_board::clock::Cause;
use virtual_board::flash::Remains;
use virtual_board::scene::Scene;
use virtual_board::time::SECOND;

fn at_rest() -> Scene {
    Scene::at_rest(load(None).expect("an image")).expect("boots")
}

fn say(board: &mut Board, line: &str) -> String {
    board.command(line).expect("answers")
}

#[test]
fn settings_outlive_reset_and_power_cycle() {
    let mut scene = at_rest();
    let board = &mut scene.board;
    assert_eq!(say(board, "set setpoint 31.5"), "setpoint = 31.5 degC");
    assert_eq!(say(board, "set pid.kp 2.25"), "pid.kp = 2.25 %/degC");
    assert_eq!(say(board, "save"), "ok");
    board.reset(Cause::Pin).expect("resets");
    board.run_for(SECOND).expect("restarts");
    assert!(board.logged("settings read from flash"));
    assert_eq!(say(board, "get pid.kp"), "pid.kp = 2.25 %/degC");
    board.power_cycle().expect("comes back");
    board.run_for(SECOND).expect("starts");
    assert_eq!(say(board, "get setpoint"), "setpoint = 31.5 degC");
    assert_eq!(say(board, "defaults"), "ok");
    assert_eq!(say(board, "get pid.kp"), "pid.kp = 2.4 %/degC");
    board.power_cycle().expect("comes back");
    board.run_for(SECOND).expect("starts");
    assert_eq!(say(board, "get pid.kp"), "pid.kp = 2.25 %/degC", "the defaults were not saved");
}

#[test]
fn what_is_not_saved_is_gone() {
    let mut scene = at_rest();
    say(&mut scene.board, "set pid.kp 2.25");
    scene.board.reset(Cause::Pin).expect("resets");
    scene.board.run_for(SECOND).expect("restarts");
    assert_eq!(say(&mut scene.board, "get pid.kp"), "pid.kp = 2.4 %/degC");
}

#[test]
fn nothing_is_saved_while_heating() {
    let mut scene = Scene::heating(load(None).expect("an image")).expect("heats");
    let before = scene.board.chip().flash.operations;
    let answer = say(&mut scene.board, "save");
    assert!(answer.contains("stop"), "{answer}");
    assert_eq!(scene.board.chip().flash.operations, before);
    assert!(scene.board.heater() > 0.0);
}

/// Operations on the flash that saving takes, from a board that has saved `times` before.
fn operations(times: usize) -> u32 {
    let mut scene = at_rest();
    for i in 0..times {
        save(&mut scene.board, i);
    }
    let before = scene.board.chip().flash.operations;
    save(&mut scene.board, times);
    scene.board.chip().flash.operations - before
}

fn kp(i: usize) -> String {
    format!("2.{}", i + 1)
}

fn save(board: &mut Board, i: usize) {
    let kp = kp(i);
    say(board, &format!("set pid.kp {kp}"));
    assert_eq!(say(board, "save"), "ok");
}

/// Starting takes as long as it takes to mend the storage.
fn wait_for_ticks(board: &mut Board) {
    board.log.clear();
    board.run_until("a tick", 20 * SECOND, |board| board.logged("tick 0 ")).expect("starts");
}

/// Cuts the supply during each operation of a save, in three ways; afterwards the settings are the ones before or the
/// new ones, and can be saved again.
fn cut_everywhere(times: usize, step: usize) {
    let operations = operations(times);
    for (i, remains) in (0..operations)
        .step_by(step)
        .chain([operations - 1])
        .flat_map(|i| [Remains::Before, Remains::Half, Remains::After].map(|remains| (i, remains)))
    {
        let mut scene = at_rest();
        let board = &mut scene.board;
        (0..times).for_each(|i| save(board, i));
        board.cpu.touch(|chip, _| chip.flash.cut = Some((chip.flash.operations + i, remains)));
        say(board, &format!("set pid.kp {}", kp(times)));
        board.send(b"save\r");
        board.run_for(10 * SECOND).expect("runs until the cut");
        assert!(board.power_is_cut, "operation {i}");
        board.power_cycle().expect("comes back");
        wait_for_ticks(board);
        let old = times.checked_sub(1).map_or("2.4".into(), kp);
        let now = say(board, "get pid.kp");
        let allowed = [old, kp(times)].map(|kp| format!("pid.kp = {kp} %/degC"));
        assert!(
            allowed.contains(&now),
            "cut at {i} of {operations}, {remains:?}: {now}, expected {allowed:?}"
        );
        save(board, 7);
        board.reset(Cause::Pin).expect("resets");
        wait_for_ticks(board);
        assert_eq!(
            say(board, "get pid.kp"),
            "pid.kp = 2.8 %/degC",
            "cut at {i} of {operations}, {remains:?}"
        );
    }
}

#[test]
fn a_cut_anywhere_in_the_first_save() {
    cut_everywhere(0, 1);
}

#[test]
fn a_cut_anywhere_in_a_later_save() {
    cut_everywhere(2, 5);
}

#[test]
fn saving_never_starves_the_watchdog() {
    for (hz, erase) in [(17_000, 1), (32_000, 2), (47_000, 4)] {
        let mut scene = at_rest();
        scene.board.cpu.touch(|chip, _| {
            chip.watchdog.oscillator = hz;
            chip.flash.erase_time = erase * SECOND;
        });
        scene.board.reset(Cause::Pin).expect("resets");
        scene.board.run_for(SECOND).expect("restarts");
        let resets = scene.board.resets.len();
        // So often that a sector is full and the other one is erased.
        for i in 0..230 {
            assert_eq!(say(&mut scene.board, "save"), "ok", "{hz} Hz, save {i}");
        }
        assert_eq!(scene.board.resets.len(), resets, "{hz} Hz");
        assert_eq!(scene.board.heater(), 0.0);
    }
}
