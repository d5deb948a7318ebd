//! `pt326 identify`.

use std::fmt::Write;

use crate::{arg, folder, pt326, pt326_reading, text};

/// A heater's temperature, 23 °C at rest and 0.4 °C per % more when heated, in two steps; one row a second.
fn warming() -> String {
    let (mut recording, mut rise) = (String::from("Time,Q1,T1\n"), 0.0);
    for k in 0..400 {
        let power = if k < 10 {
            0.0
        } else if k < 250 {
            50.0
        } else {
            30.0
        };
        let _ = writeln!(recording, "{k},{power},{:.3}", 23.0 + rise);
        rise = 0.98 * rise + 0.02 * 0.4 * power;
    }
    recording
}

fn json(output: &[u8]) -> serde_json::Value {
    serde_json::from_slice(output).expect("JSON")
}

#[test]
fn a_temperature_gives_the_right_gain_from_standard_input() {
    let order = ["--u", "Q1", "--y", "T1", "--order", "1,1,1"];
    let read = |more: &[&str]| pt326_reading(&[&["identify", "-"], &order[..], more].concat(), &warming());
    let found = json(&read(&["--json"]).stdout);
    assert_eq!(
        (&found["file"], &found["ts_s"], &found["detrend"]),
        (&"standard input".into(), &1.0.into(), &"offset".into())
    );
    let number = |key: &str| found[key]["value"].as_f64().unwrap();
    assert!((number("static_gain") - 0.4).abs() < 0.005, "{found}");
    assert!((number("output_at_zero_input") - 23.0).abs() < 0.2, "{found}");
    let told = text(&read(&[]).stdout);
    assert!(told.contains("since T1 is not zero while Q1 is; --detrend none"), "{told}");
    let kept = json(&read(&["--json", "--detrend", "none"]).stdout);
    assert!(kept["static_gain"]["value"].as_f64().unwrap() > 0.8, "the offset falsifies it: {kept}");
}

#[test]
fn uneven_times_and_a_contradicting_sample_time_are_told() {
    let dir = folder("identify-times");
    let file = dir.join("gap.csv");
    let gap: Vec<String> =
        warming().lines().map(str::to_owned).filter(|line| !line.starts_with("100,")).collect();
    std::fs::write(&file, gap.join("\n")).unwrap();
    let run = |more: &[&str]| {
        let output =
            pt326(&[&["identify", arg(&file), "--u", "Q1", "--y", "T1", "--order", "1,1,1"], more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let told = run(&[]);
    assert!(
        told.contains("the times are uneven: by column Time, row 100 is 2 s after the row before it"),
        "{told}"
    );
    assert!(!told.contains("--ts is"), "{told}");
    let told = run(&["--ts", "0.11"]);
    assert!(told.contains("--ts is 0.11 s, but column Time rises by 1 a row"), "{told}");
    assert!(!run(&["--from", "100"]).contains("uneven"), "the gap is left out");
}

#[test]
fn without_times_the_sample_time_must_be_given() {
    let output =
        pt326_reading(&["identify", "-", "--u", "1", "--y", "2", "--order", "1,1,1"], "1,2\n3,4\n5,6\n7,8\n");
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("expected --ts"), "{}", text(&output.stderr));
}
