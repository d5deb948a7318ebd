//! A bit of the memory flips while it heats: in a limit that runs, or in the settings that are kept beside the diagnosis.

use virtual_board::board::load;
use virtual_board::clock::Cause;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, SECOND};

/// `supervisor.over_temperature` in degC, and a bit that makes 91 of it: within its bounds.
const LIMIT: f32 = 75.0;
const BIT: u32 = 1 << 21;

fn heating() -> Scene {
    Scene::heating(load(None).expect("an image")).expect("heats")
}

/// Where these limits stand in a part of the memory; copies that nobody reads any more among them.
fn places(scene: &Scene, symbol: &str) -> Vec<u32> {
    let mut symbols = scene.board.image.symbols.iter();
    let part = symbols.find(|s| s.name == symbol).expect("the image has it");
    let words = (part.address..part.address + part.size).step_by(4);
    words.filter(|at| scene.board.cpu.word(*at).expect("memory") == LIMIT.to_bits()).collect()
}

/// Flips the bit in each place, and says how many of them have locked it out. In the others the limit holds as before.
/// `saved` is what a `save` says then.
fn lock_out(symbol: &str, within: u64, saved: &str) -> usize {
    let mut locked_out = 0;
    for place in places(&heating(), symbol) {
        let mut scene = heating();
        scene.board.cpu.set_word(place, LIMIT.to_bits() ^ BIT).expect("memory");
        scene.board.run_for(within).expect("runs on");
        if scene.board.heater() > 0.0 {
            scene.wire_sensor(2, 400); // 85 degC at T2
            scene.board.run_for(112 * MS).expect("runs on");
            assert_eq!((scene.board.heater(), scene.board.contactor()), (0.0, 0.0), "{place:#x}");
            continue;
        }
        locked_out += 1;
        assert_eq!(scene.board.contactor(), 0.0);
        let changed = "settings in memory have changed by themselves";
        for order in ["ack", "arm", "set pid.kp 2"] {
            let said = scene.board.command(order).expect("answers");
            assert!(said.contains(changed), "{order}: {said}");
        }
        let said = scene.board.command("save").expect("answers");
        assert!(said.contains(saved), "{said}");
        assert!(scene.board.logged(changed));
        assert_eq!(scene.board.heater(), 0.0);

        scene.board.reset(Cause::Pin).expect("resets");
        scene.board.run_for(SECOND).expect("starts");
        assert!(
            scene.board.command("status").expect("answers").contains(changed),
            "still to be acknowledged"
        );
        assert_eq!(scene.board.command("ack").expect("answers"), "ok");
    }
    locked_out
}

/// The limit in the rules and in the list that new settings are held against; and what all that is held against.
/// What is kept is what was set, and may be saved.
#[test]
fn a_running_limit_that_changes_by_itself_cuts_and_locks_out_until_a_reset() {
    assert_eq!(lock_out("firmware::tasks::control::control::POOL", 112 * MS, "ok"), 2 * 2);
}

/// What is kept is put in force with the next setting, and saved.
#[test]
fn a_kept_setting_that_changes_by_itself_locks_out_within_a_second() {
    assert_eq!(lock_out("firmware::start::share::SHARED", 1300 * MS, "damaged"), 1);
}
