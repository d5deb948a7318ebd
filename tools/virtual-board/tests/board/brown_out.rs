//! A supply that sags, fails slowly or fails at once while it heats: off at once, and off when it comes back.

use virtual_board::board::load;
use virtual_board::clock::Cause;
use virtual_board::inject;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, Ps, SECOND, US};

/// BOR_LEV of the option bytes.
const OFF: u32 = 3;
const LEVEL_3: u32 = 0;

/// A heating board with this brown-out level in its option bytes since before it was powered up.
fn heating(brown_out: u32) -> Scene {
    let mut scene = Scene::powered_up(load(None).expect("an image")).expect("powers up");
    scene.board.cpu.touch(|chip, _| chip.flash.options.set_brown_out(brown_out));
    scene.board.power_cycle().expect("comes back");
    scene.board.run_for(SECOND).expect("boots");
    scene.arm().expect("arms");
    scene.board.run_for(5 * SECOND).expect("runs on");
    assert!(scene.board.heater() > 0.05);
    scene.board.resets.clear();
    scene
}

#[track_caller]
fn stays_off(scene: &mut Scene, what: &str) {
    scene.board.run_for(2 * SECOND).expect("runs on");
    assert_eq!((scene.board.heater(), scene.board.contactor()), (0.0, 0.0), "{what}");
    let answer = scene.board.command("arm").expect("answers");
    assert!(answer.contains("ack"), "{what}, armed without `ack`: {answer}");
    scene.board.run_for(SECOND).expect("runs on");
    assert_eq!(scene.board.heater(), 0.0, "{what}");
}

#[test]
fn a_falling_supply_cuts_before_the_chip_gives_up() {
    for brown_out in [OFF, LEVEL_3] {
        let mut scene = heating(brown_out);
        // 2.95 V is below the detector's 3.03 V and above every brown-out level.
        scene.board.supply(2.95, 10 * MS).expect("runs on");
        let off = scene.board.heater_off_since().expect("off");
        // 0.27 of the 0.35 V have gone when the threshold is passed.
        let late = scene.board.now() - off;
        assert!(late >= 10 * MS * 8 / 35 - 50 * US, "off {} us before the end of the ramp", late / US);
        assert_eq!(scene.board.resets, []);
        scene.board.supply(3.3, 10 * MS).expect("runs on");
        stays_off(&mut scene, "the supply is back");
        assert_eq!(scene.board.resets, [], "it ran on all the time");
    }
}

#[test]
fn a_falling_supply_cuts_though_the_control_task_hangs() {
    let mut scene = heating(OFF);
    inject::hang(&mut scene.board, "control").expect("hangs");
    scene.board.supply(2.95, 10 * MS).expect("runs on");
    assert_eq!(scene.board.heater(), 0.0);
}

#[test]
fn a_supply_that_is_low_when_it_is_armed_does_not_heat() {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    scene.board.supply(2.95, 10 * MS).expect("runs on");
    let _ = scene.arm();
    scene.board.run_for(SECOND).expect("runs on");
    let heated: Vec<_> = scene.board.chip().heater_log.iter().filter(|(_, power)| *power > 0.0).collect();
    assert!(heated.is_empty(), "{heated:?}");
}

/// Sags: how low, how long down, how long there, and whether RAM has kept what it held.
const SAGS: [(f64, Ps, Ps, bool); 4] = [
    (1.5, MS, MS, true),
    (1.5, 100 * MS, 10 * MS, false),
    (0.0, 50 * US, SECOND, false),
    (0.0, 500 * MS, 10 * SECOND, false),
];

#[test]
fn a_sag_while_heating_holds_whatever_the_flags_say() {
    for brown_out in [OFF, LEVEL_3] {
        for (volts, fall, low, ram_keeps) in SAGS {
            let mut scene = heating(brown_out);
            if ram_keeps {
                scene.board.cpu.touch(|chip, _| chip.power.ram_holds_above = 0.5);
            }
            scene.board.supply(volts, fall).expect("falls");
            assert_eq!(scene.board.heater(), 0.0);
            scene.board.run_for(low).expect("stands");
            scene.board.supply(3.3, 5 * MS).expect("rises");
            scene.board.run_for(SECOND).expect("restarts");
            // Below the power-on threshold the flags are those of power-on, whatever the brown-out level.
            assert_eq!(scene.board.resets.last().map(|r| r.1), Some(Cause::PowerOn));
            let what = format!("BOR_LEV {brown_out}, {volts} V for {} ms, RAM kept: {ram_keeps}", low / MS);
            stays_off(&mut scene, &what);
        }
    }
}

#[test]
fn a_brown_out_reset_holds() {
    let mut scene = heating(LEVEL_3);
    scene.board.supply(2.5, MS).expect("falls");
    scene.board.supply(3.3, MS).expect("rises");
    scene.board.run_for(SECOND).expect("restarts");
    assert_eq!(scene.board.resets.last().map(|r| r.1), Some(Cause::BrownOut));
    assert!(scene.board.logged("reset cause: brown-out"));
    stays_off(&mut scene, "brown-out");
}
