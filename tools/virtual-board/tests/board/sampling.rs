//! What is at the inputs is what the core gets: settled, free of ripple, each input its own.

use virtual_board::board::load;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, SECOND};
use virtual_board::wiring::Wiring;

/// Codes of T0, T1, T2 at the inputs: far enough apart for one to show in the other.
const AT_INPUTS: [u16; 3] = [2160, 1617, 1840];
/// At the supply's input.
const SUPPLY: u16 = 2980;

/// Codes that the core got, tick by tick, at rest or heating.
fn codes(wiring: Wiring, heating: bool) -> Vec<[f32; 3]> {
    let image = load(None).expect("an image");
    let scene = if heating { Scene::heating(image) } else { Scene::at_rest(image) };
    let mut scene = scene.expect("runs");
    scene.board.cpu.touch(|chip, _| chip.wiring = wiring);
    (0..3).for_each(|sensor| scene.wire_sensor(sensor, AT_INPUTS[sensor]));
    scene.board.run_for(SECOND).expect("runs on");
    let from = scene.board.log.len();
    scene.board.run_for(SECOND).expect("runs on");
    assert!(!heating || scene.board.heater() > 0.05, "heats on");
    let records = scene.board.log[from..].iter().filter_map(|line| line.tick());
    let codes: Vec<_> =
        records.map(|record| record.raw()).map(|raw| [raw.t0.0, raw.t1.0, raw.t2.0]).collect();
    assert!(codes.len() >= 9, "{} ticks in a second", codes.len());
    codes
}

#[track_caller]
fn are_those_at_the_inputs(codes: &[[f32; 3]], within: f32) {
    for tick in codes {
        for (got, wired) in tick.iter().zip(AT_INPUTS) {
            assert!((got - f32::from(wired)).abs() <= within, "{tick:?}, expected {AT_INPUTS:?} +- {within}");
        }
    }
}

#[test]
fn each_thermistor_is_read_by_itself_and_settled() {
    are_those_at_the_inputs(&codes(Wiring::default(), false), 0.0);
}

#[test]
fn the_supply_is_read_and_known_once_it_has_a_nominal_voltage() {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    scene.rig.0.borrow_mut().supply = SUPPLY;
    scene.board.run_for(SECOND).expect("runs on");
    let record = scene.board.log.iter().rev().find_map(|line| line.tick()).expect("a tick");
    assert_eq!(record.raw().supply.0, f32::from(SUPPLY));
    let mut say = |line: &str| scene.board.command(line).expect("answers");
    assert!(!say("status").contains("supply"));
    assert_eq!(say("set supply.nominal_voltage 12"), "supply.nominal_voltage = 12 V");
    let status = say("status");
    assert!(status.contains("supply 100.1 % of nominal"), "{status}");
}

#[test]
fn a_thermistor_without_its_capacitor_settles_too() {
    are_those_at_the_inputs(&codes(Wiring { capacitors: false, ..Wiring::default() }, false), 0.0);
}

#[test]
fn the_ripple_of_the_pwm_cancels_within_a_tick() {
    // Rounding each conversion leaves some of it.
    are_those_at_the_inputs(&codes(Wiring { ripple: 60.0, ..Wiring::default() }, true), 0.6);
}

#[test]
fn noise_is_averaged_over_a_tick() {
    // Even noise of +-20 codes has a deviation of 11.5; the mean of 25 has 2.3, and 27 of these stay within 4.5 of it.
    are_those_at_the_inputs(&codes(Wiring { noise: 20.0, ..Wiring::default() }, false), 10.4);
}

#[test]
fn a_converter_that_hangs_trips_and_hangs_nothing_else() {
    let mut scene = Scene::heating(load(None).expect("an image")).expect("heats");
    scene.board.cpu.touch(|chip, _| chip.adc.stuck = true);
    scene.time_until_off(720 * MS).expect("off");
    scene.board.run_for(2 * SECOND).expect("runs on");
    assert_eq!(scene.board.resets, []);
    let status = scene.board.command("status").expect("answers");
    assert!(status.contains("mode tripped"), "{status}");
}

/// What stands in its register then is an old code, and would be a plausible one.
#[test]
fn a_conversion_that_does_not_end_is_no_sample() {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    scene.rig.0.borrow_mut().supply = AT_INPUTS[0];
    scene.board.run_for(SECOND).expect("runs on");
    scene.board.cpu.touch(|chip, _| chip.adc.stuck = true);
    scene.board.run_for(SECOND).expect("runs on");
    let record = scene.board.log.iter().rev().find_map(|line| line.tick()).expect("a tick");
    let raw = record.raw();
    assert!([raw.t0, raw.t1, raw.t2, raw.supply].iter().all(|code| code.0.is_nan()), "{raw:?}");
}
