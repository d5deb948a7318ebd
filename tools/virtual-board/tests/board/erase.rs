//! Erasing the sectors of the settings: as fast as the supply allows, and nothing stale is read afterwards.

use virtual_board::board::{Board, load};
use virtual_board::flash::SECTOR;
use virtual_board::inject;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, Ps, SECOND};

/// Saves that fill a sector, and some more.
const SAVES: usize = 240;

fn at_rest() -> Scene {
    Scene::at_rest(load(None).expect("an image")).expect("boots")
}

/// Saves; the longest time that one took.
fn save_over_an_erasure(board: &mut Board) -> Ps {
    let mut longest = 0;
    for i in 0..SAVES {
        let begin = board.now();
        assert_eq!(board.command("save").expect("answers"), "ok", "save {i}");
        longest = longest.max(board.now() - begin);
    }
    assert!(!board.chip().flash.erased.is_empty(), "the sectors have changed");
    longest
}

#[test]
fn a_sector_is_erased_by_words_within_the_time_of_the_data_sheet() {
    for (slow, limit) in [(false, SECOND), (true, 2 * SECOND)] {
        let mut scene = at_rest();
        scene.board.cpu.touch(|chip, _| chip.flash.slow = slow);
        let longest = save_over_an_erasure(&mut scene.board);
        // The save that erases copies the settings before, and the console takes its time.
        assert!(longest <= limit + 250 * MS, "the longest save took {} ms", longest / MS);
        assert_eq!(scene.board.resets, []);
    }
}

#[test]
fn nothing_stale_is_read_after_an_erasure() {
    let mut scene = at_rest();
    // What a cache of eight lines evicts by chance is no promise.
    scene.board.cpu.touch(|chip, _| chip.flash.cache.size = 2 * SECTOR / 16);
    save_over_an_erasure(&mut scene.board);
    assert_eq!(scene.board.chip().flash.cache.stale_reads, 0);
}

#[test]
fn after_an_erasure_the_watchdog_is_as_fast_as_before() {
    let mut scene = at_rest();
    save_over_an_erasure(&mut scene.board);
    scene.arm().expect("arms");
    scene.board.run_for(5 * SECOND).expect("runs on");
    assert!(scene.board.heater() > 0.0);
    inject::hang_masked(&mut scene.board, "panel").expect("hangs");
    scene.time_until_off(810 * MS).expect("off");
}
