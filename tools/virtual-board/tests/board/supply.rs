//! The supply fails and comes back: nothing forgets that it heated, and each reason is told by its name.

use virtual_board::board::load;
use virtual_board::clock::Cause;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, SECOND, US};

fn heating() -> Scene {
    Scene::heating(load(None).expect("an image")).expect("heats")
}

/// `arm` is refused for this reason until it is acknowledged.
#[track_caller]
fn held_by(scene: &mut Scene, reason: &str) {
    scene.board.run_for(SECOND).expect("runs on");
    assert_eq!((scene.board.heater(), scene.board.contactor()), (0.0, 0.0));
    let refusal = scene.board.command("arm").expect("answers");
    assert!(refusal.contains(reason), "{refusal}");
    assert_eq!(scene.board.command("ack").expect("answers"), "ok");
    scene.arm().expect("arms after the acknowledgement");
}

/// With the brown-out level of the factory, off, each of these looks like power-on to the chip.
#[test]
fn a_sag_that_looks_like_power_on_is_told_from_it() {
    // RAM keeps what it held, and RAM is noise; down within a time in which no tick, or some, see the sag.
    for (volts, reason) in [(1.0, "the power went"), (0.0, "the power went")] {
        for fall in [20 * US, MS, 500 * MS] {
            let mut scene = heating();
            scene.board.supply(volts, fall).expect("sags");
            scene.board.supply(3.3, MS).expect("comes back");
            assert_eq!(scene.board.resets.last().map(|r| r.1), Some(Cause::PowerOn));
            held_by(&mut scene, reason);
        }
    }
    let mut scene = heating();
    scene.board.cpu.touch(|chip, _| chip.power.ram_holds_above = 1.0);
    scene.board.supply(1.5, MS).expect("sags");
    scene.board.supply(3.3, MS).expect("comes back");
    assert_eq!(scene.board.resets.last().map(|r| r.1), Some(Cause::PowerOn));
    held_by(&mut scene, "2.9 V");
}

/// What cut the last time says nothing of the next.
#[test]
fn a_later_cut_is_told_by_its_own_reason() {
    let mut scene = heating();
    scene.board.supply(2.95, 10 * MS).expect("sags");
    scene.board.supply(3.3, 10 * MS).expect("comes back");
    held_by(&mut scene, "2.9 V");
    scene.board.run_for(SECOND).expect("runs on");
    assert!(scene.board.heater() > 0.0);
    scene.board.interlock(false);
    scene.board.run_for(SECOND).expect("runs on");
    scene.board.interlock(true);
    held_by(&mut scene, "the interlock on the break input opened");
}

#[test]
fn a_power_failure_while_heating_holds_and_one_at_rest_does_not() {
    let mut scene = heating();
    scene.board.power_cycle().expect("comes back");
    held_by(&mut scene, "the power went");
    scene.board.command("stop").expect("answers");
    scene.board.run_for(SECOND).expect("runs on");
    scene.board.power_cycle().expect("comes back");
    scene.board.run_for(SECOND).expect("starts");
    scene.arm().expect("nothing was heating");
}

#[test]
fn a_trip_outlives_the_power_switch() {
    let mut scene = heating();
    scene.wire_sensor(1, 4095);
    scene.board.run_for(SECOND).expect("trips");
    scene.rig.0.borrow_mut().overrides = [None; 3];
    scene.board.power_cycle().expect("comes back");
    held_by(&mut scene, "the power went");
}

#[test]
fn flash_is_never_touched_while_heating() {
    let mut scene = heating();
    let before = scene.board.chip().flash.operations;
    scene.board.command("arm").expect("answers");
    scene.board.run_for(5 * SECOND).expect("runs on");
    assert_eq!(scene.board.chip().flash.operations, before);
    assert!(scene.board.heater() > 0.0);
}

#[test]
fn the_brown_out_level_is_told_and_set() {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    assert!(scene.board.logged("brown-out level off, expected 3 (2.7 V)"));
    scene.arm().expect("arms");
    let refusal = scene.board.command("brownout set").expect("answers");
    assert!(refusal.contains("not while heating"), "{refusal}");
    scene.board.command("stop").expect("answers");
    scene.board.run_for(SECOND).expect("runs on");
    assert_eq!(scene.board.command("brownout set").expect("answers"), "ok");
    assert_eq!(scene.board.chip().flash.options.brown_out(), 0, "level 3 by its code");
    scene.board.power_cycle().expect("comes back");
    scene.board.log.clear();
    scene.board.run_for(SECOND).expect("starts");
    assert!(!scene.board.logged("brown-out level"));
    scene.arm().expect("arms");
    scene.board.supply(2.75, MS).expect("sags");
    scene.board.supply(3.3, MS).expect("comes back");
    assert_eq!(scene.board.resets.last().map(|r| r.1), Some(Cause::BrownOut));
    held_by(&mut scene, "brown-out");
}

#[test]
fn a_brown_out_level_that_the_chip_refuses_is_not_said_to_be_set() {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    scene.board.cpu.touch(|chip, _| chip.flash.options.protected = true);
    let refusal = scene.board.command("brownout set").expect("answers");
    assert!(refusal.starts_with("error"), "{refusal}");
    assert_eq!(scene.board.chip().flash.options.brown_out(), 3, "off by its code");
}

/// More arms than a sector has room for marks: the one that erases takes its time, with the heater off, and no task is
/// missed for it.
#[test]
#[ignore = "four minutes of computing"]
fn marks_fill_a_sector_and_arming_goes_on() {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    let (mut longest, mut arms) = (0, 0);
    while scene.board.chip().flash.erased.is_empty() {
        let begin = scene.board.now();
        scene.arm().unwrap_or_else(|e| panic!("arm {arms}: {e}"));
        longest = longest.max(if scene.board.chip().flash.erased.is_empty() {
            scene.board.now() - begin
        } else {
            0
        });
        scene.board.command("stop").expect("answers");
        scene.board.run_for(250 * MS).expect("runs on");
        arms += 1;
    }
    println!("{arms} arms until a sector was erased, the longest of them {} ms", longest / MS);
    assert_eq!(scene.board.resets, [], "after {arms} arms");
}
