//! `check` on the simulated rig: every wrong wiring is told by its right name, on weak rigs and strong, quiet and noisy, and
//! a right wiring passes on all of them.

use fdi_core::Config;
use firmware_logic::self_test::{Ending, LEVELS, LONGEST, MAX_RISE};
use pt326::commands::console::Bench;
use pt326_host::experiment::scenario::Scenario;
use pt326_rig::RigConfig;

const SEEDS: u64 = 20;
const GAINS: [f64; 3] = [0.05, 0.3, 1.0];
const NOISES: [f64; 2] = [0.5, 2.0];

fn scenario(gain: f64, noise: f64) -> Scenario {
    let usual = RigConfig::default();
    let rig = RigConfig {
        gain,
        turbulence: noise * usual.turbulence,
        white_noise: noise * usual.white_noise,
        ..usual
    };
    Scenario { rig, faults: vec![], ..Scenario::default() }
}

fn bench(gain: f64, noise: f64, seed: u64) -> Bench {
    Bench::new(&Config::default(), &scenario(gain, noise), seed).expect("valid")
}

/// What a check came to.
struct Outcome {
    ending: Option<Ending>,
    /// Its lines.
    said: String,
    ticks: u32,
    /// How far the air rose at T1, degC, and the largest power that was asked for, %.
    rise: f64,
    power: f32,
}

fn check(bench: &mut Bench) -> Outcome {
    bench.pass();
    let ambient = bench.rig().air()[0];
    assert!(bench.answer("check").starts_with("ok"));
    let mut outcome = Outcome { ending: None, said: bench.news(), ticks: 0, rise: 0.0, power: 0.0 };
    while bench.is_checking() {
        bench.pass();
        outcome.said += &bench.news();
        outcome.ticks += 1;
        outcome.rise = outcome.rise.max(bench.rig().air()[0] - ambient);
        outcome.power = outcome.power.max(bench.output().asked().0);
        assert!(outcome.ticks <= LONGEST + 20, "endless: {}", outcome.said);
    }
    outcome.ending = bench.ending();
    assert!(bench.output().is_off(), "ended, but the output is not off: {}", outcome.said);
    outcome
}

/// Checks a wiring on all rigs; each must say `expected`. Returns the largest rise of the air.
fn on_all_rigs(wrong: &[&str], expected: &str) -> f64 {
    let mut rise: f64 = 0.0;
    let mut failures = Vec::new();
    for (gain, noise, seed) in GAINS
        .into_iter()
        .flat_map(|gain| NOISES.map(|noise| (gain, noise)))
        .flat_map(|(gain, noise)| (1..=SEEDS).map(move |seed| (gain, noise, seed)))
    {
        let mut bench = bench(gain, noise, seed);
        wrong.iter().for_each(|line| assert_eq!(bench.answer(line), "", "{line}"));
        let outcome = check(&mut bench);
        if !outcome.said.contains(expected) {
            failures.push(format!("gain {gain} noise x{noise} seed {seed}:\n{}", outcome.said));
        }
        rise = rise.max(outcome.rise);
        assert!(outcome.power <= LEVELS[3], "{} %", outcome.power);
    }
    assert!(failures.is_empty(), "{wrong:?}: {} without {expected:?}\n{}", failures.len(), failures[0]);
    println!("{wrong:?}: rises by {rise:.2} degC at most");
    rise
}

#[test]
fn a_right_wiring_passes_everywhere_and_is_warmed_by_a_few_degrees() {
    let rise = on_all_rigs(&[], "check passed");
    assert!(rise < 3.1 && rise < f64::from(MAX_RISE), "{rise} degC");
}

#[test]
fn thermistors_at_the_wrong_place_are_named() {
    on_all_rigs(&["wire swap t1 t2"], "T1 and T2 are swapped");
    on_all_rigs(&["wire swap t0 t1"], "T0 and T1 are swapped");
    on_all_rigs(&["wire swap t0 t2"], "T0 and T2 are swapped");
    on_all_rigs(&["wire swap t0 t1", "wire swap t1 t2"], "each at another's place");
}

#[test]
fn thermistors_that_see_nothing_are_named() {
    on_all_rigs(&["wire detached t1"], "T1 does not answer");
    on_all_rigs(&["wire detached t2"], "T2 does not answer");
    on_all_rigs(&["wire stuck t1"], "T1 stands still");
    on_all_rigs(&["wire stuck t2"], "T2 stands still");
    on_all_rigs(&["wire open t1"], "T1 reads as an open wire");
    on_all_rigs(&["wire short t2"], "T2 reads as a short");
    on_all_rigs(&["fault offset t0 20"], "T0 reads");
}

#[test]
fn a_rig_that_does_not_heat_or_blows_backwards_is_named() {
    on_all_rigs(&["wire unheated"], "no thermistor answers");
    on_all_rigs(&["wire backwards"], "blown backwards");
}

#[test]
fn a_power_stage_that_is_stuck_is_named() {
    let rise = on_all_rigs(&["wire mosfet shorted"], "MOSFET is shorted");
    assert!(rise < 25.0, "{rise} degC");
    on_all_rigs(&["wire contactor welded"], "it heats with the contactor open");
}

#[test]
fn an_interlock_that_is_open_or_does_not_cut_is_named() {
    on_all_rigs(&["wire interlock open"], "the interlock is open and holds the output off");
    on_all_rigs(&["wire break ignored"], "a break does not disable the output");
    on_all_rigs(
        &["wire interlock open", "wire break ignored"],
        "does not keep the output from being enabled",
    );
}
