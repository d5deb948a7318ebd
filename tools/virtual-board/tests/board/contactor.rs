//! The contactor in series with the heater: closed by `arm`, open whenever the heater's output is off.

use virtual_board::board::load;
use virtual_board::clock::Cause;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, SECOND};

#[test]
fn closed_by_arm_and_opened_by_stop() {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    assert_eq!(scene.board.chip().contactor_log, [(0, 0.0)], "never closed before it is armed");
    scene.arm().expect("arms");
    scene.board.run_for(SECOND).expect("runs on");
    assert_eq!(scene.board.contactor(), 1.0);
    scene.board.command("stop").expect("answers");
    scene.board.run_for(SECOND).expect("runs on");
    let log = &scene.board.chip().contactor_log;
    assert_eq!(log.iter().map(|(_, level)| *level).collect::<Vec<_>>(), [0.0, 1.0, 0.0], "no edge more");
}

#[test]
fn it_opens_in_the_moment_in_which_the_heater_goes_off() {
    type Cut = fn(&mut Scene);
    let ways: [(&str, Cut); 3] = [
        ("interlock", |scene| scene.board.interlock(false)),
        ("clock", |scene| scene.board.cpu.touch(|chip, now| chip.fail_external_clock(now))),
        ("reset", |scene| scene.board.reset(Cause::Pin).expect("resets")),
    ];
    for (name, cut) in ways {
        let mut scene = Scene::heating(load(None).expect("an image")).expect("heats");
        cut(&mut scene);
        assert_eq!((scene.board.heater(), scene.board.contactor()), (0.0, 0.0), "{name}");
    }
}

#[test]
fn a_power_stage_that_has_failed_on_is_switched_off() {
    let mut scene = Scene::heating(load(None).expect("an image")).expect("heats");
    scene.board.cpu.touch(|chip, _| {
        chip.wiring.contactor_fitted = true;
        chip.wiring.stage_shorted = true;
    });
    assert_eq!(scene.board.chip().power_at_rig(), 1.0);
    scene.wire_sensor(1, 4095);
    scene.board.run_for(112 * MS).expect("trips");
    assert_eq!(scene.board.chip().power_at_rig(), 0.0);
}

/// Runs on with a contact in the stream of air, in the interlock's chain: it opens at half of the flow, and is looked at each ms.
fn run_with_air_contact(scene: &mut Scene, time: u64) {
    for _ in 0..time / MS {
        let flow = scene.rig.0.borrow_mut().rig().expect("a rig").flow();
        scene.board.interlock(flow >= 0.5);
        scene.board.run_for(MS).expect("runs on");
    }
}

#[test]
fn an_air_flow_contact_switches_off_when_the_fan_stops() {
    let mut scene = Scene::heating(load(None).expect("an image")).expect("heats");
    run_with_air_contact(&mut scene, SECOND);
    assert!(scene.board.heater() > 0.0, "air flows");
    scene.rig.0.borrow_mut().rig().expect("a rig").set_fan(0.0);
    let stopped = scene.board.now();
    run_with_air_contact(&mut scene, SECOND);
    let off = scene.board.heater_off_since().expect("off");
    assert!(off - stopped <= 200 * MS, "{} ms", (off - stopped) / MS);
    // It is latched, and neither arms nor passes a check while the air stands.
    scene.board.command("ack").expect("answers");
    for (order, said) in [("arm", "the interlock on the break input is open"), ("check", "ok")] {
        let answer = scene.board.command(order).expect("answers");
        assert!(answer.contains(said), "{order}: {answer}");
    }
    run_with_air_contact(&mut scene, SECOND);
    assert!(scene.board.logged("interlock"), "the check says that it is open");
    scene.board.command("stop").expect("answers");
    scene.rig.0.borrow_mut().rig().expect("a rig").set_fan(1.0);
    run_with_air_contact(&mut scene, SECOND);
    assert_eq!(scene.board.heater(), 0.0);
    assert!(scene.board.command("arm").expect("answers").starts_with("ok"));
}
