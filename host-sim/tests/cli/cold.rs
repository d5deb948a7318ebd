//! Slow heaters whose records begin cold.

use std::collections::VecDeque;
use std::fmt::Write as _;

use crate::plant::Dice;
use crate::{arg, folder, pt326, text};

/// Samples that are learnt from.
const LEARNT: usize = 2000;

/// A heater under a PI controller, from cold.
struct Heater {
    seconds: usize,
    gain: f64,
    /// Times in samples, each between two: the slow lag, the fast one and the dead time. The wall takes nine times as long as the slow one.
    slow: (f64, f64),
    fast: (f64, f64),
    dead: (f64, f64),
    /// How much of the rise comes with the wall.
    wall: (f64, f64),
    most_power: f64,
    decimals: usize,
    /// Samples between two set-points.
    holds: usize,
    count: usize,
}

impl Heater {
    fn record(&self, seed: u64) -> String {
        let dice = &mut Dice::of(seed);
        let mut between = |(low, high)| dice.between(low, high);
        let [slow, fast, dead, share] =
            [between(self.slow), between(self.fast), between(self.dead), between(self.wall)];
        let mut on_its_way = VecDeque::from(vec![0.0; dead as usize]);
        let [mut air, mut wall, mut rise, mut sum] = [0.0; 4];
        let mut wanted = 12.0;
        let mut rows = String::from("time,temp,power\n");
        for k in 0..self.count {
            if k % self.holds == self.holds - 1 {
                wanted = dice.any(&[6.0, 8.0, 10.0, 12.0]);
            }
            let left: f64 = wanted - rise;
            sum = (sum + 0.02 * left).clamp(0.0, 100.0);
            let power = (12.0 * left + sum).clamp(0.0, self.most_power);
            let noise = 0.02 * (dice.next() + dice.next() - 1.0);
            let read = 21.0 + rise + noise;
            let _ = writeln!(rows, "{},{read:.*},{power:.1}", k * self.seconds, self.decimals);
            on_its_way.push_back(self.gain * power);
            air += (on_its_way.pop_front().unwrap_or_default() - air) / slow;
            wall += (air - wall) / (9.0 * slow);
            rise += ((1.0 - share) * air + share * wall - rise) / fast;
        }
        rows
    }

    /// What `pt326 diagnose` says of a record.
    fn diagnosed(&self, name: &str, seed: u64) -> String {
        let dir = folder(name);
        let file = dir.join("record.csv");
        std::fs::write(&file, self.record(seed)).unwrap();
        let map = ["--map", "time=time", "--map", "t1=temp", "--map", "power=power", "--full-power", "100"];
        let train = format!("0:{}", LEARNT * self.seconds);
        let to = ["--fan", "false", "--train", &train, "--out", arg(&dir)];
        let out = pt326(&[&["diagnose", arg(&file)][..], &map, &to].concat());
        assert!(out.status.success(), "{}", text(&out.stderr));
        text(&out.stdout)
    }
}

/// What is left of the heat hides where the room is until the rig has forgotten how it began. When only 30 samples were looked at, the room was taken
/// for up to half a degree warmer than it is, and the three healthy records were in alarm for 240, 120 and 73 samples: T1 reads too low.
#[test]
fn a_slow_heater_that_begins_cold_is_healthy() {
    let floor = Heater {
        seconds: 30,
        gain: 0.18,
        slow: (50.0, 80.0),
        fast: (3.0, 6.0),
        dead: (4.0, 9.0),
        wall: (0.03, 0.03),
        most_power: 90.0,
        decimals: 1,
        holds: 300,
        count: 4000,
    };
    for seed in [3, 7, 12] {
        let said = floor.diagnosed("cold-floor", seed);
        assert!(said.contains(" watched, 0 alarms"), "seed {seed}: {said}");
    }
}

/// The training is one and a half times as long as the wall takes. When a parameter of the fit that left its range was only cut off, the fit had no wall on
/// seeds 1 and 4: gains were 11 and 9 % too low, and the models explained 74 and 82 % of what followed.
#[test]
fn a_slow_wall_is_found_under_a_controller() {
    let incubator = Heater {
        seconds: 2,
        gain: 0.25,
        slow: (140.0, 160.0),
        fast: (6.0, 12.0),
        dead: (4.0, 9.0),
        wall: (0.05, 0.1),
        most_power: 100.0,
        decimals: 2,
        holds: 400,
        count: 4500,
    };
    for seed in 1..=4 {
        let said = incubator.diagnosed("cold-incubator", seed);
        let after = |words: &str| {
            let number = said.split_once(words).unwrap().1.split([' ', ';', '%']).next().unwrap();
            number.parse::<f64>().unwrap()
        };
        let [gain, rest] = [after("T1; gain "), after("where it was learnt, ")];
        assert!((gain / 0.25 - 1.0).abs() < 0.04 && rest > 95.0, "seed {seed}: {gain} degC/%, {rest} %");
    }
}
