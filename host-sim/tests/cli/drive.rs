//! What drives the heater: the same whatever is asked for, or logged a row late.

use std::fmt::Write as _;

use crate::plant::Dice;
use crate::{arg, folder, pt326, text};

/// A heater of two lags (samples) and 0.5 degC a %, under a PI controller whose set-point changes every 300 samples, in a room that wanders by `wander`,
/// degC, within 1000 samples. `given` says which power arrives on a sample, of that which is asked for, %. The power of a row drives the heater up to that
/// row.
fn record(
    seed: u64,
    [slow, fast]: [f64; 2],
    count: usize,
    wander: f64,
    given: impl Fn(usize, f64) -> f64,
) -> String {
    let dice = &mut Dice::of(seed);
    let (mut heat, mut t1, mut sum, mut wanted, mut room) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let mut rows = String::from("time,temp,power\n");
    for k in 0..count {
        if k % 300 == 0 {
            wanted = dice.any(&[0.0, 0.0, 10.0, 20.0, 30.0]);
        }
        let left: f64 = wanted - t1 - room;
        sum = if wanted > 0.0 { (sum + 0.02 * left).clamp(0.0, 60.0) } else { 0.0 };
        let asked = if wanted > 0.0 { (6.0 * left + sum).clamp(0.0, 100.0) } else { 0.0 };
        heat += (given(k, asked) - heat) / slow;
        t1 += (0.5 * heat - t1) / fast;
        let noise = 0.1 * (dice.next() + dice.next() - 1.0);
        let _ = writeln!(rows, "{k},{:.2},{asked:.2}", 22.0 + t1 + room + noise);
        if wander > 0.0 {
            // A uniform step of as much as this has a standard deviation of sqrt(2 / 1000).
            room += 0.155 * wander * (dice.next() - 0.5) - room / 1000.0;
        }
    }
    rows
}

fn diagnosed(name: &str, record: &str, more: &[&str]) -> String {
    let dir = folder(name);
    let file = dir.join("record.csv");
    std::fs::write(&file, record).unwrap();
    let map = ["--map", "time=time", "--map", "t1=temp", "--map", "power=power", "--full-power", "100"];
    let to = ["--fan", "false", "--train", "0:2500", "--out", arg(&dir)];
    let out = pt326(&[&["diagnose", arg(&file)][..], &map, &to, more].concat());
    assert!(out.status.success(), "{}", text(&out.stderr));
    text(&out.stdout)
}

/// What it leaves behind is heat, which goes; no thermistor is wrong.
#[test]
fn behind_a_heater_that_was_stuck_no_thermistor_is_blamed() {
    let mut named = 0;
    for seed in 4..=6 {
        let stuck = |k, asked| if (2600..2900).contains(&k) { 60.0 } else { asked };
        let said = diagnosed("drive-stuck", &record(seed, [60.0, 8.0], 4000, 0.0, stuck), &[]);
        let over = said.lines().skip_while(|line| !line.contains("the same power whatever is asked for"));
        named += usize::from(over.clone().next().is_some());
        let mut behind = over.skip_while(|line| !line.contains("all is as expected again"));
        assert_eq!(behind.find(|line| line.contains("T1 reads")), None, "seed {seed}: {said}");
    }
    assert!(named > 1, "{named} of 3 were named");
}

/// In a room that wanders, too. Without the bank of `likelihood/interacting.rs` none is named there.
#[test]
fn a_heater_that_is_on_while_it_is_asked_for_nothing_is_named() {
    let mut named = 0;
    for seed in 1..=4 {
        let on = |k, asked| if k >= 2600 && asked == 0.0 { 50.0 } else { asked };
        let said = diagnosed("drive-on", &record(seed, [60.0, 8.0], 4000, 0.2, on), &[]);
        named += usize::from(said.contains("the same power whatever is asked for"));
    }
    assert!(named > 2, "{named} of 4 were named");
}

/// A dead time below zero can't be learnt: whoever logs the power that led to a row is told how to say so.
#[test]
fn a_power_that_is_logged_behind_its_effect_is_told() {
    let record = record(1, [6.0, 2.0], 2600, 0.0, |_, asked| asked);
    let said = diagnosed("drive-behind", &record, &[]);
    assert!(said.contains("T1 answers to the power of its own row"), "{said}");
    let fit = |said: &str| -> f64 {
        let (_, rest) = said.split_once("Fit, simulated: ").expect(said);
        rest.split_once(" %").unwrap().0.parse().unwrap()
    };
    let again = diagnosed("drive-behind", &record, &["--power-before"]);
    assert!(!again.contains("own row"), "{again}");
    assert!(100.0 - fit(&again) < 0.6 * (100.0 - fit(&said)), "{} {}", fit(&said), fit(&again));
}
