//! What the board tests of itself while it runs: the program in flash, the RAM, the converter, the pins that heat.

use virtual_board::board::load;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, SECOND};
use virtual_board::wiring::Pull;

/// Twice over the image, or once over the RAM.
const PASS: u64 = 75 * SECOND;
const MEMORY: &str = "flash or RAM has changed by itself";

fn powered_up() -> Scene {
    Scene::powered_up(load(None).expect("an image")).expect("powers up")
}

fn heating() -> Scene {
    Scene::heating(load(None).expect("an image")).expect("heats")
}

/// Flips a bit of a function that does not run as long as all is well.
fn flip_a_bit_of_the_program(scene: &mut Scene) {
    let place = scene.board.image.address("HardFault").expect("the image has it") & !3;
    let word = scene.board.cpu.word(place).expect("memory");
    scene.board.cpu.set_word(place, word ^ 1 << 9).expect("memory");
}

#[track_caller]
fn is_locked_out_for_good(scene: &mut Scene, why: &str) {
    assert_eq!((scene.board.heater(), scene.board.contactor()), (0.0, 0.0));
    scene.board.command("ack").expect("answers");
    scene.board.run_for(300 * MS).expect("runs on");
    let said = scene.board.command("arm").expect("answers");
    assert!(said.contains(why), "{said}");
}

#[test]
fn a_program_that_is_not_the_one_that_was_built_never_heats() {
    let mut scene = powered_up();
    flip_a_bit_of_the_program(&mut scene);
    scene.board.run_for(SECOND).expect("starts");
    is_locked_out_for_good(&mut scene, MEMORY);
}

#[test]
fn a_program_that_changes_while_it_heats_is_cut_and_locked_out() {
    let mut scene = heating();
    flip_a_bit_of_the_program(&mut scene);
    scene.time_until_off(PASS).expect("off");
    is_locked_out_for_good(&mut scene, MEMORY);
}

#[test]
fn a_board_whose_ram_does_not_keep_what_is_written_does_not_start() {
    let mut scene = powered_up();
    let place = scene.board.image.address("firmware::start::share::SHARED").expect("the image has it");
    scene.board.cpu.stick(place, 1 << 4).expect("memory");
    scene.board.run_for(SECOND).expect("stands");
    assert!(scene.board.log.is_empty());
    assert_eq!((scene.board.heater(), scene.board.contactor()), (0.0, 0.0));
}

#[test]
fn a_cell_that_sticks_while_it_heats_is_found_and_locks_out() {
    let mut scene = heating();
    // The bottom of the stack, where nothing has ever been.
    let place = scene.board.image.address("_stack_end").expect("the image has it");
    scene.board.cpu.stick(place, 1).expect("memory");
    scene.time_until_off(PASS).expect("off");
    is_locked_out_for_good(&mut scene, MEMORY);
}

/// The test of a cell puts back what it held, whatever runs meanwhile.
#[test]
fn a_pass_over_all_memory_changes_nothing() {
    let mut scene = heating();
    scene.board.run_for(PASS).expect("runs on");
    assert_eq!(scene.board.resets, []);
    assert!(scene.board.heater() > 0.05);
}

#[test]
fn a_converter_that_gets_its_reference_wrong_gives_no_sample_and_trips() {
    for code in [1300, 1700] {
        let mut scene = heating();
        scene.board.cpu.touch(|chip, _| chip.wiring.reference = code);
        scene.time_until_off(720 * MS).expect("off");
        let record = scene.board.log.iter().rev().find_map(|line| line.tick()).expect("a tick");
        assert!(record.raw().t1.0.is_nan(), "{:?}", record.raw());
    }
}

#[test]
fn a_pin_that_something_else_holds_high_locks_out_at_rest() {
    type Solder = fn(&mut virtual_board::chip::Chip);
    let shorts: [Solder; 2] =
        [|chip| chip.wiring.heater = Pull::Short, |chip| chip.wiring.contactor = Pull::Short];
    for short in shorts {
        let mut scene = Scene::at_rest(load(None).expect("an image")).expect("starts");
        scene.board.cpu.touch(|chip, _| short(chip));
        scene.board.run_for(300 * MS).expect("runs on");
        scene.board.command("ack").expect("answers");
        scene.board.run_for(300 * MS).expect("runs on");
        let said = scene.board.command("arm").expect("answers");
        assert!(said.contains("is high while it is off"), "{said}");
    }
}
