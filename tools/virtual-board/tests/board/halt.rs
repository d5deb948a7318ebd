//! A debugger that halts the core while it heats: the core can do nothing, so the hardware must.

use virtual_board::board::{Board, load};
use virtual_board::clock::Cause;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, Ps, SECOND, US};
use virtual_board::wiring::Pull;

fn heating() -> Scene {
    Scene::heating(load(None).expect("an image")).expect("heats")
}

#[test]
fn a_halted_core_does_not_heat() {
    for pull in [Pull::Down, Pull::Up] {
        let mut scene = heating();
        scene.board.cpu.touch(|chip, _| (chip.wiring.heater, chip.wiring.contactor) = (pull, pull));
        scene.board.cpu.touch(|chip, now| chip.halt(true, now));
        assert_eq!((scene.board.heater(), scene.board.contactor()), (0.0, 0.0), "at once");
        let halted = scene.board.now();
        scene.board.run_for(20 * SECOND).expect("stands");
        assert!(scene.board.heater_off_since().is_some_and(|off| off <= halted), "for as long as it takes");
        assert_eq!(scene.board.contactor(), 0.0);
    }
}

/// A tick and its sample: the guard looks at each.
const ONE_TICK: Ps = 112 * MS;

#[test]
fn a_resumed_core_does_not_heat_until_it_is_acknowledged() {
    // Within a tick, over a few, beyond the deadline watchdog, beyond the watchdog's deadline.
    for (halt, limit) in [
        (MS, ONE_TICK),
        (50 * MS, ONE_TICK),
        (120 * MS, 10 * US),
        (300 * MS, 10 * US),
        (2 * SECOND, 10 * US),
        (60 * SECOND, 10 * US),
    ] {
        let mut scene = heating();
        scene.board.halt(halt).expect("stands");
        let resumed = scene.board.now();
        scene.board.run_for(3 * SECOND).expect("runs on");
        let off = scene.board.heater_off_since().expect("off");
        let late = off.saturating_sub(resumed);
        assert!(late <= limit, "halted for {} ms: off {} us after the resume", halt / MS, late / US);
        assert_eq!(scene.board.contactor(), 0.0);
        assert_eq!(scene.board.resets, [], "halted for {} ms", halt / MS);
        let answer = scene.board.command("arm").expect("answers");
        assert!(answer.contains("ack"), "halted for {} ms, armed without `ack`: {answer}", halt / MS);
    }
}

#[test]
fn what_another_program_froze_is_not_frozen_here() {
    const APB1_FZ: u32 = 0xE004_2008;
    let mut scene = heating();
    // The debug unit keeps this over a reset.
    scene.board.cpu.touch(|chip, now| chip.write(APB1_FZ, 4, 0xF, now)).expect("modelled");
    scene.board.reset(Cause::Pin).expect("resets");
    scene.board.run_for(SECOND).expect("restarts");
    scene.arm().expect("arms");
    scene.board.run_for(5 * SECOND).expect("runs on");
    assert!(scene.board.heater() > 0.0);
    scene.board.halt(2 * SECOND).expect("stands");
    scene.time_until_off(10 * US).expect("off");
}

/// While nothing heats a halt is no fault; its ticks are samples that are missing, so that the time of the core goes on.
#[test]
fn the_ticks_of_a_halt_are_told_to_the_core() {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    let ticks = |board: &Board| board.log.iter().filter(|line| line.tick().is_some()).count();
    let before = ticks(&scene.board);
    scene.board.run_until("a tick", SECOND, |board| ticks(board) > before).expect("runs on");
    scene.board.log.clear();
    // The fourth tick is late, the three before it are missed.
    scene.board.halt(450 * MS).expect("stands");
    scene.board.run_for(SECOND).expect("runs on");
    let missed: Vec<_> = scene.board.log.iter().filter_map(|line| line.tick()).map(|r| r.missed()).collect();
    assert_eq!(missed.iter().filter(|missed| **missed).count(), 3, "{missed:?}");
    let numbers: Vec<_> = scene.board.log.iter().filter_map(|line| line.tick()).map(|r| r.tick()).collect();
    assert!(numbers.windows(2).all(|pair| pair[1] == pair[0] + 1), "{numbers:?}");
}
