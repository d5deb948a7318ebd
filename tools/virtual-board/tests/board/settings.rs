//! What is kept in flash outlives resets, power cycles and a supply that goes in the middle of a write.

use std::sync::LazyLock;

use pt326_rig::fault::{Fault, Sensor, Verb};
use virtual_board::board::{Board, load};
use virtual_board::clock::Cause;
use virtual_board::flash::Remains;
use virtual_board::scene::{Scene, WAIVE_CHECK};
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

fn kp(i: usize) -> String {
    format!("2.{}", i % 9 + 1)
}

fn save(board: &mut Board, i: usize) {
    let kp = kp(i);
    say(board, &format!("set pid.kp {kp}"));
    assert_eq!(say(board, "save"), "ok");
}

/// What is in flash after so many saves.
fn saved(times: usize) -> Vec<u8> {
    let mut scene = at_rest();
    (0..times).for_each(|i| save(&mut scene.board, i));
    scene.board.chip().flash.content.clone()
}

/// A board with this in its flash.
fn with_flash(content: &[u8]) -> Scene {
    let mut scene = Scene::powered_up(load(None).expect("an image")).expect("powers up");
    scene.board.cpu.touch(|chip, _| chip.flash.content.copy_from_slice(content));
    wait_for_ticks(&mut scene.board);
    scene
}

/// Starting takes as long as it takes to mend the storage.
fn wait_for_ticks(board: &mut Board) {
    board.log.clear();
    board.run_until("a tick", 20 * SECOND, |board| board.logged("tick 0 ")).expect("starts");
}

/// Cuts the supply at operations of the save after so many others, in three ways; afterwards the settings are the ones
/// before or the new ones, and can be saved again. Each `step`th operation is cut, each erasing and the last. Returns how many
/// erased. It is one board that is powered up again for each cut, since the emulator keeps the code that it has translated.
fn cut_everywhere(times: usize, step: usize) -> usize {
    let content = saved(times);
    let mut scene = with_flash(&content);
    let board = &mut scene.board;
    save(board, times);
    let flash = &board.chip().flash;
    let (operations, erased) = (flash.operations, flash.erased.clone());
    let erasing = erased.len();
    let places = (0..operations).step_by(step).chain(erased).chain([operations - 1]);
    for (i, remains) in
        places.flat_map(|i| [Remains::Before, Remains::Half, Remains::After].map(|remains| (i, remains)))
    {
        let place = format!("cut at {i} of {operations}, {remains:?}");
        board.cpu.touch(|chip, _| chip.flash.content.copy_from_slice(&content));
        board.power_cycle().expect("powers up");
        wait_for_ticks(board);
        board.cpu.touch(|chip, _| chip.flash.cut = Some((chip.flash.operations + i, remains)));
        say(board, &format!("set pid.kp {}", kp(times)));
        board.send(b"save\r");
        board.run_until(&place, 10 * SECOND, |board| board.power_is_cut).expect("runs until the cut");
        board.power_cycle().expect("comes back");
        wait_for_ticks(board);
        let old = times.checked_sub(1).map_or("2.4".into(), kp);
        let now = say(board, "get pid.kp");
        let allowed = [old, kp(times)].map(|kp| format!("pid.kp = {kp} %/degC"));
        assert!(allowed.contains(&now), "{place}: {now}, expected {allowed:?}");
        save(board, 7);
        board.reset(Cause::Pin).expect("resets");
        wait_for_ticks(board);
        assert_eq!(say(board, "get pid.kp"), "pid.kp = 2.8 %/degC", "{place}");
    }
    erasing
}

#[test]
fn a_cut_anywhere_in_the_first_save() {
    cut_everywhere(0, 1);
}

#[test]
fn a_cut_anywhere_in_a_later_save() {
    cut_everywhere(2, 5);
}

/// Saves that fill a sector: the next one moves on to the other sector and erases this one.
static FULL: LazyLock<usize> = LazyLock::new(|| {
    let mut scene = at_rest();
    let erases = |i: &usize| {
        save(&mut scene.board, *i);
        !scene.board.chip().flash.erased.is_empty()
    };
    (0..1000).find(erases).expect("a sector has an end")
});

#[test]
fn a_cut_anywhere_while_the_sectors_change() {
    assert!(cut_everywhere(*FULL, 15) > 0, "the sectors have not changed");
}

#[test]
fn saving_never_starves_the_watchdog() {
    for (hz, slow) in [(17_000, false), (32_000, true), (47_000, true)] {
        let mut scene = at_rest();
        scene.board.cpu.touch(|chip, _| {
            chip.watchdog.oscillator = hz;
            chip.flash.slow = slow;
        });
        scene.board.reset(Cause::Pin).expect("resets");
        scene.board.run_for(SECOND).expect("restarts");
        let resets = scene.board.resets.len();
        for i in 0..*FULL + 10 {
            assert_eq!(say(&mut scene.board, "save"), "ok", "{hz} Hz, save {i}");
        }
        assert_eq!(scene.board.chip().flash.erased.len(), 1, "the sectors have changed");
        assert_eq!(scene.board.resets.len(), resets, "{hz} Hz");
        assert_eq!(scene.board.heater(), 0.0);
    }
}

/// What the set-point needed acts from the first second on: full power without an answer is too much long before it is no response.
#[test]
fn what_was_learnt_and_saved_trips_after_a_reset_as_before_it() {
    let mut scene = Scene::heating(load(None).expect("an image")).expect("heats");
    scene.board.run_for(400 * SECOND).expect("learns");
    assert!(say(&mut scene.board, "status").starts_with("mode monitor"));
    assert_eq!(say(&mut scene.board, "stop"), "stopped");
    assert_eq!(say(&mut scene.board, "save"), "ok");
    scene.board.reset(Cause::Pin).expect("resets");
    scene.board.run_for(SECOND).expect("restarts");
    say(&mut scene.board, WAIVE_CHECK);
    let out = |sensor| Fault::new(Verb::Detach, Some(sensor), Some(1.0), 0.0, f64::INFINITY);
    scene.connect(&[out(Sensor::T1), out(Sensor::T2)]);
    assert!(say(&mut scene.board, "arm").starts_with("ok"));
    scene.board.run_for(20 * SECOND).expect("runs on");
    assert_eq!(scene.board.heater(), 0.0);
    let faults = say(&mut scene.board, "faults");
    assert!(faults.contains("far more power than was learnt"), "{faults}");
}
