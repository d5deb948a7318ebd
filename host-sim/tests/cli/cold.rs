//! A slow heater whose record begins cold.

use std::collections::VecDeque;
use std::fmt::Write as _;

use crate::plant::Dice;
use crate::{arg, folder, pt326, text};

/// Samples of a record, of 30 s each.
const COUNT: usize = 4000;
const LEARNT: usize = 2000;

/// A floor of 0.18 degC a %, of lags of 50 to 80 and 3 to 6 samples, a dead time and a slow wall of 3 %, from cold under a PI controller of 90 % at most.
/// T1 is read in steps of 0.1 degC.
fn record(seed: u64) -> String {
    let dice = &mut Dice::of(seed);
    let [slow, fast, dead] =
        [(50.0, 80.0), (3.0, 6.0), (4.0, 9.0)].map(|(low, high)| dice.between(low, high));
    let mut on_its_way = VecDeque::from(vec![0.0; dead as usize]);
    let [mut air, mut wall, mut rise, mut sum] = [0.0; 4];
    let mut wanted = 12.0;
    let mut rows = String::from("time,temp,power\n");
    for k in 0..COUNT {
        if k % 300 == 299 {
            wanted = dice.any(&[6.0, 8.0, 10.0, 12.0]);
        }
        let left: f64 = wanted - rise;
        sum = (sum + 0.02 * left).clamp(0.0, 100.0);
        let power = (12.0 * left + sum).clamp(0.0, 90.0);
        let noise = 0.02 * (dice.next() + dice.next() - 1.0);
        let _ = writeln!(rows, "{},{:.1},{power:.1}", k * 30, 21.0 + rise + noise);
        on_its_way.push_back(0.18 * power);
        air += (on_its_way.pop_front().unwrap_or_default() - air) / slow;
        wall += (air - wall) / (9.0 * slow);
        rise += (0.97 * air + 0.03 * wall - rise) / fast;
    }
    rows
}

/// What is left of the heat hides where the room is until the rig has forgotten how it began. When only 30 samples were looked at, the room was taken
/// for up to half a degree warmer than it is, and the three healthy records were in alarm for 240, 120 and 73 samples: T1 reads too low.
#[test]
fn a_slow_heater_that_begins_cold_is_healthy() {
    for seed in [3, 7, 12] {
        let dir = folder("cold");
        let file = dir.join("record.csv");
        std::fs::write(&file, record(seed)).unwrap();
        let map = ["--map", "time=time", "--map", "t1=temp", "--map", "power=power", "--full-power", "100"];
        let train = format!("0:{}", LEARNT * 30);
        let to = ["--fan", "false", "--train", &train, "--out", arg(&dir)];
        let out = pt326(&[&["diagnose", arg(&file)][..], &map, &to].concat());
        assert!(out.status.success(), "{}", text(&out.stderr));
        let said = text(&out.stdout);
        assert!(said.contains(" watched, 0 alarms"), "seed {seed}: {said}");
    }
}
