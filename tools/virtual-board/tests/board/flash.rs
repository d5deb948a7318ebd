//! Erasing a sector: as fast as the supply allows, nothing stale is read afterwards, and the log's time goes on.

use virtual_board::board::load;
use virtual_board::scene::Scene;
use virtual_board::time::{SECOND, US};

/// A board whose next save erases: its sectors are noise.
fn full_of_garbage() -> Scene {
    let mut scene = Scene::powered_up(load(None).expect("an image")).expect("powers up");
    scene.board.cpu.touch(|chip, _| {
        let mut noise = 1u32;
        for byte in &mut chip.flash.content {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *byte = (noise >> 24) as u8;
        }
    });
    scene.board.run_until("a tick", 20 * SECOND, |board| board.logged("tick 0 ")).expect("starts");
    scene
}

#[test]
fn the_first_save_over_garbage_is_read_back() {
    let mut scene = full_of_garbage();
    let board = &mut scene.board;
    assert!(board.logged("settings DEFAULTS"));
    assert_eq!(board.command("set pid.kp 2.25").expect("answers"), "pid.kp = 2.25 %/degC");
    assert_eq!(board.command("save").expect("answers"), "ok");
    assert!(!board.chip().flash.erased.is_empty(), "it was erased");
    assert_eq!(
        board.command("save").expect("answers"),
        "ok",
        "what was written is read, and not what was erased"
    );
    board.power_cycle().expect("comes back");
    board.run_for(SECOND).expect("starts");
    assert_eq!(board.command("get pid.kp").expect("answers"), "pid.kp = 2.25 %/degC");
}

#[test]
fn the_log_keeps_its_time_over_an_erase() {
    let mut scene = full_of_garbage();
    let offset = |scene: &Scene| {
        let told = scene.board.log_times().last().copied().expect("a line");
        scene.board.now() as f64 / (1_000_000.0 * US as f64) - told
    };
    scene.board.run_for(SECOND).expect("runs on");
    let before = offset(&scene);
    assert_eq!(scene.board.command("save").expect("answers"), "ok");
    scene.board.run_for(SECOND).expect("runs on");
    let after = offset(&scene);
    // A line is at most a tick old.
    assert!((after - before).abs() < 0.12, "{before} s before, {after} s after");
}
