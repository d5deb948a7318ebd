//! The log is nobody's business but the reader's: read, read late or never read, no tick is late for it.

use virtual_board::board::load;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, SECOND};

use crate::is_punctual;

#[test]
fn never_read_and_no_tick_is_late() {
    let mut scene = Scene::heating(load(None).expect("an image")).expect("heats");
    scene.board.probe.attached = false;
    scene.board.run_for(60 * SECOND).expect("runs on");
    let status = scene.board.command("status").expect("answers");
    assert!(is_punctual(&status) && status.contains("diagnosis lost 0"), "{status}");
    let dropped = status.split("log dropped ").nth(1).and_then(|s| s.split(',').next()?.parse::<u32>().ok());
    assert!(dropped.is_some_and(|n| n > 400), "{status}");
    assert_eq!(scene.board.resets, []);
}

#[test]
fn a_reader_that_comes_back_finds_whole_frames() {
    let mut scene = Scene::heating(load(None).expect("an image")).expect("heats");
    scene.board.probe.attached = false;
    scene.board.run_for(60 * SECOND).expect("runs on");
    scene.board.probe.attached = true;
    let before = scene.board.log.len();
    scene.board.run_for(10 * SECOND).expect("runs on");
    let ticks: Vec<u32> =
        scene.board.log[before..].iter().filter_map(|line| line.tick()).map(|record| record.tick()).collect();
    let gaps = ticks.windows(2).filter(|pair| pair[1] != pair[0] + 1).count();
    assert_eq!(gaps, 1, "what was buffered, and what came after");
    assert!(ticks.len() > 90);
}

#[test]
fn a_reader_that_stalls_now_and_then_loses_nothing() {
    let mut scene = Scene::heating(load(None).expect("an image")).expect("heats");
    for _ in 0..10 {
        scene.board.probe.attached = false;
        scene.board.run_for(2500 * MS).expect("runs on");
        scene.board.probe.attached = true;
        scene.board.run_for(500 * MS).expect("runs on");
    }
    let status = scene.board.command("status").expect("answers");
    assert!(status.contains("log dropped 0"), "{status}");
}
