//! The tables of docs/diagnosis-tutorial.md are those of the run that it follows.

use std::fmt::Write;

use fdi_core::Config;
use pt326_host::experiment::{Record, Row, run, scenario::Scenario};

use super::root;

const AGAIN: &str = "stale: UPDATE_DOCS=1 cargo test -p pt326-tests --test docs followed";

fn row(record: &Record, time: f64) -> &Row {
    &record.rows[index(record, time)]
}

/// The tick at a time that is told with two decimals.
fn index(record: &Record, time: f64) -> usize {
    (time / record.sample_time).round() as usize
}

fn residuals(record: &Record) -> String {
    let mut text = String::from(
        "| time, s | T2 measured, °C | T2 expected, °C | e2, °C | T1 measured, °C | e1, °C | |\n|---|--:|--:|--:|--:|--:|---|\n",
    );
    for (time, what) in [
        (384.45, "the last tick before the fault"),
        (384.56, "the first tick with it"),
        (384.67, "alarm, and the name"),
    ] {
        let Row { tick, report, .. } = row(record, time);
        let [_, t1, t2] = report.likelihood.expected.map(|expected| expected.unwrap());
        let (is1, is2) = (tick.sample.t1.celsius.0, tick.sample.t2.celsius.0);
        // A rest that rounds to nothing has no sign.
        let rest = |is: f32, expected: f32| (100.0 * (is - expected)).round() / 100.0 + 0.0;
        let (e1, e2) = (rest(is1, t1), rest(is2, t2));
        let _ = writeln!(text, "| {time} | {is2:.2} | {t2:.2} | {e2:+.2} | {is1:.2} | {e1:+.2} | {what} |");
    }
    text
}

fn shares(record: &Record) -> String {
    let mut text = String::from("| | at 384.67 s | at 385.99 s |\n|---|--:|--:|\n");
    for (class, name) in [
        ("t2_offset", "T2 reads wrong"),
        ("drift", "a thermistor drifts"),
        ("t0_fault", "T0 reads wrong"),
        ("t1_t2_swapped", "T1 and T2 are swapped"),
        ("heater_power", "heater power"),
        ("air_flow", "air flow"),
        ("t1_offset", "T1 reads wrong"),
    ] {
        let share = |time: f64| {
            let at = index(record, time);
            let (_, all) = record.explained.iter().find(|(row, _)| *row == at).unwrap();
            all.iter()
                .filter(|(of, _)| of.name() == class)
                .map(|(_, share)| 100.0 * share)
                .fold(0.0, f32::max)
        };
        let _ = writeln!(text, "| {name} | {:.0} % | {:.0} % |", share(384.67), share(385.99));
    }
    text
}

fn sizes(record: &Record) -> String {
    let mut text =
        String::from("| time, s | T2 reads too high by, °C | 95 % interval, °C |\n|---|--:|---|\n");
    for time in [384.67, 385.0, 385.99, 409.42] {
        let size = row(record, time).report.likelihood.finding.unwrap().magnitude.unwrap();
        let (low, high) = (size.value - size.half_width, size.value + size.half_width);
        let _ = writeln!(text, "| {time:.2} | {:.2} | {low:.2} to {high:.2} |", size.value);
    }
    text
}

#[test]
fn the_tables_of_the_fault_that_is_followed_are_those_of_its_run() {
    let record = run(&Config::default(), &Scenario::default(), 1).unwrap();
    let path = root().join("docs/diagnosis-tutorial.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let mut new = page.clone();
    for (name, table) in
        [("residuals", residuals(&record)), ("shares", shares(&record)), ("sizes", sizes(&record))]
    {
        let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- end {name} -->"));
        let (head, rest) = new.split_once(&begin).expect(name);
        let (_, tail) = rest.split_once(&end).expect(name);
        new = format!("{head}{begin}{table}{end}{tail}");
    }
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(path, new).unwrap();
    } else {
        assert!(page == new, "{AGAIN}\n{new}");
    }
}
