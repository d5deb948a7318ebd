//! A bit of what the control task keeps in RAM flips while nothing may heat: neither pin goes high. The same of all bits of the loop alone, which
//! is quicker, is in `firmware-logic/tests/flipped_bits.rs`; here the program around it takes part.

use virtual_board::board::load;
use virtual_board::closed_loop::TICK;
use virtual_board::scene::Scene;

/// Brings the board where nothing may heat.
type Prepare = fn(&mut Scene);

fn off(_: &mut Scene) {}

fn locked_out(scene: &mut Scene) {
    scene.arm().expect("arms");
    scene.board.run_for(5 * TICK).expect("heats");
    scene.board.interlock(false);
    scene.board.run_for(2 * TICK).expect("locks out");
    scene.board.interlock(true);
}

fn prepared(prepare: Prepare) -> Scene {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("starts");
    prepare(&mut scene);
    scene.board.cpu.touch(|chip, _| (chip.heater_log.clear(), chip.contactor_log.clear()));
    scene
}

/// Flips each `step`th bit from `first` on, one at a time, and lets it run for two ticks.
fn flip(prepare: Prepare, first: u32, step: usize) {
    let mut scene = prepared(prepare);
    let symbols = scene.board.image.symbols.iter();
    let pool =
        symbols.clone().find(|s| s.name == "firmware::tasks::control::control::POOL").expect("it is there");
    let (begin, bits) = (pool.address, 8 * pool.size);
    for bit in (first..bits).step_by(step) {
        let (place, mask) = (begin + bit / 32 * 4, 1 << (bit % 32));
        let word = scene.board.cpu.word(place).expect("memory");
        scene.board.cpu.set_word(place, word ^ mask).expect("memory");
        let lines = scene.board.log.len();
        scene.board.run_for(2 * TICK).expect("runs on");
        let chip = scene.board.chip();
        let high = chip.heater_log.iter().chain(&chip.contactor_log).any(|(_, high)| *high > 0.0);
        assert!(!high, "bit {bit} of {bits}: a pin goes high");
        // Where nothing came of it, the bit is put back, and the board serves once more.
        let now = scene.board.cpu.word(place).expect("memory");
        let quiet =
            scene.board.log[lines..].iter().all(|line| line.tick().is_some_and(|tick| !tick.missed()));
        if now == word ^ mask && quiet && scene.board.resets.is_empty() {
            scene.board.cpu.set_word(place, word).expect("memory");
        } else if now != word || !quiet {
            scene = prepared(prepare);
        }
    }
}

/// One in 61, which is prime to the size of a word; all of them by the tests below.
#[test]
fn no_flipped_bit_heats_a_board_that_is_off() {
    flip(off, 0, 61);
}

#[test]
fn no_flipped_bit_heats_a_board_that_is_locked_out() {
    flip(locked_out, 7, 61);
}

#[test]
#[ignore = "minutes"]
fn no_flipped_bit_of_all_heats_a_board_that_is_off() {
    flip(off, 0, 1);
}

#[test]
#[ignore = "minutes"]
fn no_flipped_bit_of_all_heats_a_board_that_is_locked_out() {
    flip(locked_out, 0, 1);
}
