//! `check` on the image: what a board says of a rig that is wired rightly, and of one that is not.

use pt326_rig::fault::{Fault, Sensor, Verb};
use virtual_board::board::load;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, SECOND};

/// A board at rest, with a contactor, and a rig with these faults.
fn scene(faults: &[Fault]) -> Scene {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    scene.board.cpu.touch(|chip, _| chip.wiring.contactor_fitted = true);
    scene.connect(faults);
    scene
}

/// Types `check` and returns all that the terminal shows until it has ended.
fn check(scene: &mut Scene) -> String {
    let mut said = scene.board.command("check").expect("answers");
    for _ in 0..200 {
        scene.board.run_for(SECOND).expect("runs on");
        said += &scene.board.take_terminal();
        if said.contains("check passed") || said.contains("check failed") {
            return said;
        }
    }
    panic!("no end in 200 s: {said}");
}

#[test]
fn a_right_rig_passes_and_then_arms() {
    let mut scene = scene(&[]);
    assert!(scene.board.command("arm").expect("answers").contains("no `check` has passed"));
    let said = check(&mut scene);
    assert!(said.contains("check passed") && !said.contains("contactor open: none"), "{said}");
    assert!(scene.board.logged("check passed"));
    assert_eq!((scene.board.heater(), scene.board.contactor()), (0.0, 0.0));
    let powers = scene.board.chip().heater_log.iter().map(|(_, power)| *power);
    assert!(powers.fold(0.0, f64::max) <= 0.2, "more than the check may ask for");
    assert_eq!(scene.board.resets, [], "the console checks in with the watchdog all the while");
    assert_eq!(scene.board.command("arm").expect("answers"), "ok");
}

#[test]
fn swapped_thermistors_are_named_and_nothing_arms() {
    let swapped = Fault {
        with: Some(Sensor::T2),
        ..Fault::new(Verb::Swap, Some(Sensor::T1), None, 0.0, f64::INFINITY)
    };
    let mut scene = scene(&[swapped]);
    let said = check(&mut scene);
    assert!(said.contains("T1 and T2 are swapped") && said.contains("check failed: 1 finding"), "{said}");
    assert!(scene.board.command("arm").expect("answers").contains("no `check` has passed"));
}

#[test]
fn without_a_contactor_it_says_so_and_passes() {
    let mut scene = scene(&[]);
    scene.board.cpu.touch(|chip, _| chip.wiring.contactor_fitted = false);
    let said = check(&mut scene);
    assert!(
        said.contains("note: it heats with the contactor open") && said.contains("check passed"),
        "{said}"
    );
}

#[test]
fn an_open_interlock_is_proved_to_hold_the_output_off() {
    let mut scene = scene(&[]);
    scene.board.interlock(false);
    let said = check(&mut scene);
    assert!(said.contains("the interlock is open and holds the output off"), "{said}");
    assert!(scene.board.chip().heater_log.iter().all(|(_, power)| *power == 0.0));
}

#[test]
fn the_button_and_the_interlock_end_a_check_at_once() {
    type Way = fn(&mut Scene);
    let ways: [(&str, Way); 2] =
        [("button", |scene| scene.board.button(true)), ("interlock", |scene| scene.board.interlock(false))];
    for (name, leave) in ways {
        let mut scene = scene(&[]);
        scene.board.command("check").expect("answers");
        scene.board.run_until("a pulse", 60 * SECOND, |board| board.heater() > 0.0).expect("heats");
        leave(&mut scene);
        scene.time_until_off(55 * MS).unwrap_or_else(|e| panic!("{name}: {e}"));
        scene.board.run_for(SECOND).expect("runs on");
        assert!(scene.board.logged("check ended early"), "{name}");
    }
}

#[test]
fn a_timer_whose_break_has_no_effect_is_named_and_nothing_arms() {
    let mut scene = scene(&[]);
    scene.board.cpu.touch(|chip, _| chip.tim1.break_is_dead = true);
    let said = check(&mut scene);
    assert!(said.contains("a break does not disable the output") && said.contains("check failed"), "{said}");
    assert!(scene.board.command("arm").expect("answers").contains("no `check` has passed"));
    assert_eq!((scene.board.heater(), scene.board.contactor()), (0.0, 0.0));
}
