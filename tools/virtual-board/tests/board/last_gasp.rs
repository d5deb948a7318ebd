//! When the program dies, cutting the heater comes first: before a word is said, and not by the reset that follows.

use virtual_board::board::{Board, load};
use virtual_board::clock::Cause;
use virtual_board::inject;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, Ps, SECOND, US};

fn heating() -> Scene {
    Scene::heating(load(None).expect("an image")).expect("heats")
}

/// Breaks a heating board; how long until it is off, and how long from then until the reset.
fn dies(break_it: impl FnOnce(&mut Board)) -> (Ps, Ps) {
    let mut scene = heating();
    break_it(&mut scene.board);
    let broken = scene.board.now();
    scene.board.run_for(500 * MS).expect("restarts");
    let off = scene.board.heater_off_since().expect("off");
    let reset = scene.board.resets.last().expect("a reset").0;
    (off - broken, reset.saturating_sub(off))
}

#[track_caller]
fn cuts_first(what: &str, break_it: impl FnOnce(&mut Board)) {
    let (off, reset) = dies(break_it);
    assert!(off <= 5 * US, "{what}: off after {} ns", off / 1000);
    assert!(reset > 0, "{what}: it was the reset that cut");
}

#[test]
fn a_panic_cuts_before_it_says_why() {
    cuts_first("panic", |board| inject::panic(board, "diagnosis").expect("panics"));
}

#[test]
fn a_hard_fault_cuts_before_it_says_why() {
    cuts_first("HardFault", |board| inject::run_wild(board, "diagnosis").expect("faults"));
}

#[test]
fn a_stray_interrupt_cuts_before_it_says_which() {
    /// Of the DMA's second controller, which nothing here uses.
    const NOBODYS: u16 = 60;
    let mut scene = heating();
    scene.board.cpu.touch(|chip, _| {
        chip.scs.nvic.enable(NOBODYS, true);
        chip.scs.nvic.pend(16 + NOBODYS);
    });
    let begin = scene.board.now();
    scene.board.run_for(SECOND).expect("restarts");
    let off = scene.board.heater_off_since().expect("off");
    assert!(off - begin <= 5 * US, "off after {} ns", (off - begin) / 1000);
    assert!(scene.board.resets.last().is_some_and(|(at, cause)| *at > off && *cause == Cause::Software));
    assert!(scene.board.logged("interrupt 60"), "says which");
}

#[test]
fn a_stack_overflow_corrupts_nothing() {
    for task in ["console", "control"] {
        let mut scene = heating();
        let board = &mut scene.board;
        let tasks = board.image.address("firmware::link::TASKS").expect("where tasks check in");
        inject::overflow_stack(board, task).expect(task);
        let before = board.cpu.bytes(tasks, 20).expect("RAM");
        board.cpu.watch(board.image.address("HardFault").expect("the handler")).expect("watches");
        let hit = board.run_to(board.now() + MS).expect("runs on");
        assert!(hit.is_some(), "{task}: no fault");
        assert_eq!(board.cpu.bytes(tasks, 20).expect("RAM"), before, "{task}");
    }
}

#[test]
fn each_start_sees_its_own_reset_flags() {
    let mut scene = heating();
    for (cause, told) in
        [(Cause::Watchdog, "watchdog"), (Cause::Pin, "reset pin"), (Cause::Software, "software reset")]
    {
        scene.board.log.clear();
        scene.board.reset(cause).expect("resets");
        scene.board.run_for(SECOND).expect("restarts");
        assert!(scene.board.logged(&format!("reset cause: {told}")), "{told}");
    }
}

#[test]
fn a_fault_reset_is_held_over_further_resets() {
    let mut scene = heating();
    for cause in [Cause::Watchdog, Cause::Pin, Cause::Pin] {
        scene.board.reset(cause).expect("resets");
        // Before the first tick, too.
        scene.board.run_for(30 * MS).expect("starts");
        scene.board.reset(Cause::Pin).expect("resets");
        scene.board.run_for(SECOND).expect("restarts");
        let answer = scene.board.command("arm").expect("answers");
        assert!(answer.contains("ack"), "{cause:?}: armed without `ack`: {answer}");
    }
}

/// What the words that outlive a reset begin with, and a panic among them.
const MAGIC: u32 = 0x5054_3201;
const PANIC: u32 = 1;

#[test]
fn ram_full_of_noise_is_believed_in_nothing() {
    for magic in [None, Some(MAGIC)] {
        let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
        let retained = scene.board.image.address("firmware::hardware::retained::MEMORY").expect("the words");
        for i in 0..64 {
            let noise = 0x9E37_79B9u32.wrapping_mul(i + 1);
            scene.board.cpu.set_word(retained + 4 * i, noise).expect("RAM");
        }
        if let Some(magic) = magic {
            scene.board.cpu.set_word(retained, magic).expect("RAM");
            scene.board.cpu.set_word(retained + 4, PANIC).expect("RAM");
        }
        scene.board.log.clear();
        scene.board.reset(Cause::Pin).expect("resets");
        scene.board.run_for(SECOND).expect("restarts");
        assert!(scene.board.logged("reset cause: reset pin"), "{magic:?}");
        assert!(!scene.board.logged("crash record"), "{magic:?}");
        scene.arm().expect("nothing holds it");
    }
}

#[test]
fn the_tick_is_110_ms_by_the_crystal() {
    let mut scene = heating();
    let count = |board: &Board| board.chip().tim5.count(board.now());
    let before = count(&scene.board);
    scene.board.run_for(10 * SECOND).expect("runs on");
    let steps = count(&scene.board).wrapping_sub(before);
    assert!((9_999_999..=10_000_001).contains(&steps), "{steps} us counted in 10 s");
}
