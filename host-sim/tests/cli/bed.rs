//! A heated bed with glass on it, under a PI controller.

use std::fmt::Write as _;

use crate::plant::Dice;
use crate::{arg, folder, pt326, text};

/// Samples, 2 s apart; the heater gives nothing from `FAULT` on.
const SAMPLES: usize = 4000;
const FAULT: usize = 2400;

/// Its heater fails: T1 falls to 120 degC below what is expected, more than a thousand standard deviations, and stays there.
fn that_fails(seed: u64) -> String {
    let dice = &mut Dice::of(seed);
    let (mut bed, mut glass, mut sum, mut set_point) = (22.0_f64, 22.0_f64, 0.0_f64, 60.0);
    let mut rows = String::from("time,temp,power\n");
    for k in 0..SAMPLES {
        if k % 300 == 299 {
            set_point = dice.any(&[50.0, 60.0, 70.0, 80.0]);
        }
        let read = bed + 0.1 * (dice.next() + dice.next() - 1.0);
        let left = set_point - read;
        sum = (sum + 0.001 * left).clamp(0.0, 1.0);
        let power = (0.08 * left + sum).clamp(0.0, 1.0);
        let _ = writeln!(rows, "{},{read:.1},{:.1}", 2 * k, 100.0 * power);
        let heat = if k < FAULT { 220.0 * power } else { 0.0 };
        for _ in 0..8 {
            let across = 3.0 * (bed - glass);
            bed += 0.25 * (heat - across - 0.9 * (bed - 22.0)) / 350.0;
            glass += 0.25 * (across - 1.3 * (glass - 22.0)) / 500.0;
        }
    }
    rows
}

/// Bed and glass are two masses, of which the slower has most of the heat. When a wall was looked for from one start, that of a tube, the model explained 84 %
/// of such a bed. When every sample counted as if the model were exact, single precision had nothing left to decide by, and the name came and went.
#[test]
fn a_second_mass_is_found_and_a_heater_that_fails_has_one_name() {
    let dir = folder("bed");
    let file = dir.join("record.csv");
    for seed in [1, 2, 3] {
        std::fs::write(&file, that_fails(seed)).unwrap();
        let out = pt326(&["diagnose", arg(&file), "--train", "0:4000", "--out", arg(&dir)]);
        assert!(out.status.success(), "{}", text(&out.stderr));
        let said = text(&out.stdout);
        let (_, fit) = said.split_once("Fit, simulated: ").unwrap();
        let fit: f64 = fit.split(' ').next().unwrap().parse().unwrap();
        assert!(fit > 98.0, "seed {seed}: {said}");
        let (_, later) = said.split_once("% less power than asked for").expect("the heater's name");
        assert!(!later.contains("°C") && !later.contains("it cannot be told what"), "seed {seed}: {said}");
    }
}
