//! The bank on a made heater.

extern crate std;

use super::super::process::Parameters;
use super::*;

/// A bank of a heater with lags of 60 and 5 samples, 0.5 degC a %, and T1's noise.
fn bank() -> Interacting {
    let parameters = Parameters([-0.7, 4.1, 0.0, 1.6, 0.0, 0.9, 1.3, 2.0, 0.0, 6.0, 0.0, 0.0, 0.0]);
    let mut whitening = WhiteningFilter::default();
    (whitening.sigma, whitening.inv_sigma) = ([0.05, 0.0], [20.0, 0.0]);
    Interacting::new(Tuned::default(), &Process::new(Default::default(), &parameters, 1.0), &whitening)
}

/// What is found on each of so many samples where the heater is asked for `asked`, gives `given`, and loses `lost` times as much heat on top; T1
/// reads so much too high.
fn found(count: u32, acts: impl Fn(u32) -> (f64, f64, f64, f64)) -> std::vec::Vec<Found> {
    found_of(1.0, count, acts)
}

/// The same of a rig that is so much faster than its model.
fn found_of(faster: f64, count: u32, acts: impl Fn(u32) -> (f64, f64, f64, f64)) -> std::vec::Vec<Found> {
    let mut bank = bank();
    let [heater, lag, _] = bank.shares;
    let (mut model, mut rig) = ([40.0; 2], [40.0; 2]);
    let of = |k: u32| {
        let (asked, given, lost, off) = acts(k);
        for (state, power, lost, faster) in [(&mut model, asked, 0.0, 1.0), (&mut rig, given, lost, faster)] {
            state[0] += faster * heater * (power - (1.0 + lost) * state[0]);
            state[1] += lag * (state[0] - (1.0 + 0.3 * lost) * state[1]);
        }
        let noise = 0.05 * (f64::from(k * 37 % 64) / 32.0 - 1.0);
        let e1 = bank.gains[0] * (rig[1] - model[1]) + off + noise;
        bank.step(Some(e1 as f32), model[0] as f32, (bank.gains[0] * model[1]) as f32)
    };
    (0..count).map(of).collect()
}

fn level(k: u32) -> f64 {
    if (k / 25).is_multiple_of(2) { 20.0 } else { 60.0 }
}

/// Soon after a lid is closed, and not while it is open.
#[test]
fn a_lid_that_is_closed_is_over() {
    let found = found(200, |k| (level(k), level(k), if k < 60 { 2.0 } else { 0.0 }, 0.0));
    let first = found.iter().position(|found| *found == Found::Over);
    assert!(first.is_some_and(|first| (60..80).contains(&first)), "{first:?}");
}

/// A fault that lasts is not over; when it is, that is found soon.
#[test]
fn a_fault_that_lasts_is_not_over() {
    for (share, off) in [(0.7, 0.0), (1.3, 0.0), (1.0, 2.0)] {
        let fault = |k| {
            if k < 300 { (level(k), share * level(k), 0.0, off) } else { (level(k), level(k), 0.0, 0.0) }
        };
        let found = found(400, fault);
        let first = found.iter().position(|found| *found == Found::Over);
        assert!(first.is_some_and(|first| (300..340).contains(&first)), "{share} {off}: {first:?}");
    }
}

/// The rig answers to a step of the power a little faster than its model, or slower: T1 reads wrong as before.
#[test]
fn an_error_of_the_model_does_not_end_the_alarm_of_an_error_of_t1() {
    for (faster, off) in [(0.96, 3.0), (0.96, -3.0), (1.04, 3.0), (1.04, -3.0)] {
        let step = |k: u32| if k < 250 { 80.0 } else { 0.0 };
        let found = found_of(faster, 500, |k| (step(k), step(k), 0.0, off));
        let first = found.iter().position(|found| *found == Found::Over);
        assert_eq!(first, None, "{faster} {off}");
    }
}

/// A heater that is on while it is asked for nothing, or gives the same whatever is asked for.
#[test]
fn a_heater_that_gives_what_nobody_asks_for_is_found() {
    let off = |k: u32| if !(40..=300).contains(&k) { level(k) } else { 0.0 };
    let on = found(200, |k| (off(k), if off(k) > 0.0 { off(k) } else { 50.0 }, 0.0, 0.0));
    assert_eq!(on.last(), Some(&Found::HeaterOn));
    let same = found(200, |k| (level(k), 50.0, 0.0, 0.0));
    assert_eq!(same.last(), Some(&Found::HeaterOn));
    let weak = found(200, |k| (level(k), 0.7 * level(k), 0.0, 0.0));
    assert!(!weak.contains(&Found::HeaterOn));
}

/// Where the end of another alarm has moved the model, only what is left is taken over: the model is not moved twice.
#[test]
fn what_the_model_has_taken_over_by_itself_is_not_taken_over_again() {
    let mut bank = bank();
    let [heater, lag, _] = bank.shares;
    let (mut model, mut rig) = ([40.0; 2], [20.0; 2]);
    for k in 0..60 {
        for state in [&mut model, &mut rig] {
            state[0] += heater * (level(k) - state[0]);
            state[1] += lag * (state[0] - state[1]);
        }
        let noise = 0.05 * (f64::from(k * 37 % 64) / 32.0 - 1.0);
        let e1 = bank.gains[0] * (rig[1] - model[1]) + noise;
        let rise = bank.gains[0] * model[1];
        let _ = bank.step(Some(e1 as f32), model[0] as f32, rise as f32);
        if k == 40 {
            let taken = [0, 1].map(|i| 1.5 * (rig[i] - model[i]));
            (0..2).for_each(|i| model[i] += taken[i]);
            bank.differ_less([taken[0] as f32, taken[1] as f32, taken[1] as f32]);
        }
        if k > 30 {
            let begun = bank.begun([0.0; 3]).motion;
            let left = rig[1] - model[1];
            assert!((f64::from(begun.m[0]) - left).abs() < 0.8, "{k}: {} for {left}", begun.m[0]);
        }
    }
}
