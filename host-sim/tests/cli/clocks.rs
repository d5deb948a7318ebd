//! What a gap, a unit and a sign say of a recording of a heater whose T1 reads too high from somewhere on.

use std::fmt::Write as _;

use crate::{arg, folder, pt326, pt326_reading, text};

/// Rows of a heater of one lag, a sample a second; T1 reads 4 degC too high from row `wrong` on, and `time` makes the cell of each.
fn rows(count: usize, wrong: usize, time: impl Fn(usize) -> String, power: impl Fn(f64) -> f64) -> String {
    let (mut text, mut rise) = (String::new(), 0.0);
    for k in 0..count {
        let heat = [60.0, 20.0, 80.0, 40.0, 0.0, 50.0][k / 60 % 6];
        let noise = 0.1 * ((k * 7919 % 101) as f64 / 50.0 - 1.0);
        let t = 22.0 + rise + noise + if k < wrong { 0.0 } else { 4.0 };
        let _ = writeln!(text, "{},{t:.2},{}", time(k), power(heat));
        rise += (0.6 * power(heat) - rise) / 25.0;
    }
    text
}

fn diagnosed(name: &str, content: &str, args: &[&str]) -> (bool, String) {
    let dir = folder(name);
    let file = dir.join("log.csv");
    std::fs::write(&file, content).unwrap();
    let done = pt326(&[&["diagnose", arg(&file), "--out", arg(&dir.join("out"))], args].concat());
    (done.status.success(), text(&done.stdout) + &text(&done.stderr))
}

#[test]
fn a_gap_does_not_end_an_alarm() {
    let time = |k: usize| (if k < 900 { k } else { k + 3000 }).to_string();
    let content = format!("time,temp,power\n{}", rows(1100, 800, time, |p| p));
    let (_, said) = diagnosed("clocks-gap", &content, &["--train", "0:700"]);
    assert!(said.contains("  801.00 s  T1 reads "), "{said}");
    assert!(said.contains("  899.00 s  a gap: whether it is over is not known"), "{said}");
    assert!(!said.contains("as expected again"), "{said}");
}

#[test]
fn a_stream_says_its_own_unit() {
    let dir = folder("clocks-live");
    let normal = dir.join("normal.csv");
    std::fs::write(&normal, format!("time,temp,power\n{}", rows(700, 700, |k| k.to_string(), |p| p)))
        .unwrap();
    let live = |name: &str, unit: usize| {
        let lines = format!("{name},temp,power\n{}", rows(900, 800, |k| (unit * k).to_string(), |p| p));
        let done = pt326_reading(&["diagnose", "-", "--live", "--train-on", arg(&normal)], &lines);
        (done.status.success(), text(&done.stdout) + &text(&done.stderr))
    };
    let (seconds, ms, none) = (live("time", 1), live("time_ms", 1000), live("time", 1000));
    assert!(seconds.0 && ms.0 && !none.0);
    for said in [&seconds.1, &ms.1] {
        assert!(said.contains("   801.00 s  T1 reads "), "{said}");
    }
    assert!(none.1.contains("each of 10 lines is a gap") && none.1.contains("--time-unit"), "{}", none.1);
}

/// A power below zero is named; on request it cools, with a gain of its own.
#[test]
fn a_negative_power_is_named_and_may_cool() {
    let content = format!("time,temp,power\n{}", rows(1200, 1100, |k| k.to_string(), |p| 2.0 * p - 80.0));
    let args = ["--train", "0:1000"];
    let (is_done, said) = diagnosed("clocks-negative", &content, &args);
    assert!(
        !is_done && said.contains("below 0 in 340 of 1000 samples") && said.contains("--cooling"),
        "{said}"
    );
    let (is_done, said) = diagnosed("clocks-cooling", &content, &[&args[..], &["--cooling"]].concat());
    assert!(is_done && said.contains("  1101.00 s  T1 reads "), "{said}");
}

/// A fan at half its level all the time is the usual fan.
#[test]
fn a_fan_that_never_moves_is_the_usual_one() {
    let fan = rows(900, 800, |k| k.to_string(), |p| p).replace('\n', ",50\n");
    let (is_done, said) = diagnosed(
        "clocks-fan",
        &format!("time,temp,power,fan\n{fan}"),
        &[
            "--train",
            "0:700",
            "--map",
            "time=time",
            "--map",
            "t1=temp",
            "--map",
            "power=power",
            "--map",
            "fan=fan",
        ],
    );
    assert!(
        is_done && said.contains("The fan stands at 50 all the time") && said.contains("T1 reads "),
        "{said}"
    );
}
