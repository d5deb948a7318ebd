//! `pt326 teach`.

use std::path::Path;

use crate::{arg, folder, pt326, text};

/// T2 reads too low, which no row of the paper's knows, at these times.
fn scenario(dir: &Path, at: &[f64]) -> std::path::PathBuf {
    let fault = |at: &f64| {
        format!(
            "[[fault]]\nname = \"low\"\ndo = \"offset\"\nsensor = \"t2\"\nsize = -1.5\nat = {at}\nfor = 20.0\n"
        )
    };
    let last = at.last().expect("a time") + 50.0;
    let faults: String = at.iter().map(fault).collect();
    let file = dir.join(format!("{last}.toml"));
    std::fs::write(&file, format!("duration = {last:?}\n{faults}")).unwrap();
    file
}

/// A column of the trace in a folder, with the time.
fn fiv(out: &Path) -> Vec<(f64, String)> {
    let trace = std::fs::read_to_string(out.join("trace.csv")).unwrap();
    let header: Vec<&str> = trace.lines().next().unwrap().split(',').collect();
    let place = header.iter().position(|column| *column == "fiv").unwrap();
    let cells = trace.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    cells.map(|cells| (cells[0].parse().unwrap(), cells[place].to_owned())).collect()
}

#[test]
fn a_fault_that_was_taught_on_one_run_is_named_in_another() {
    let dir = folder("teach");
    let (first, second) = (dir.join("first"), dir.join("second"));
    let lesson = scenario(&dir, &[400.0, 460.0, 520.0]);
    assert!(
        pt326(&["run", "--scenario", arg(&lesson), "--seed", "3", "--out", arg(&first)]).status.success()
    );

    let (trace, out) = (first.join("trace.csv"), dir.join("taught.toml"));
    let marks = "low_T2:400..420,460..480,520..540";
    let output = pt326(&["teach", arg(&trace), "--fault", marks, "--out", arg(&out)]);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told}{}", text(&output.stderr));
    let found = |line: &&str| line.contains("found 3 of 3") && line.contains("; 0 false in");
    assert_eq!(told.lines().filter(found).count(), 2, "by both diagnoses: {told}");
    assert!(told.contains("The likelihood diagnosis: ") && told.contains("offset of T2 -"), "{told}");
    let settings = std::fs::read_to_string(&out).unwrap();
    assert!(
        settings.contains("name = \"low_T2\"") && settings.contains("\nstart = 1 "),
        "the seed's phase is no setting"
    );

    let other = scenario(&dir, &[410.0]);
    let args =
        ["run", "--scenario", arg(&other), "--seed", "100004", "--config", arg(&out), "--out", arg(&second)];
    assert!(pt326(&args).status.success());
    let shown = |file: &str| std::fs::read_to_string(second.join(file)).unwrap();
    assert!(shown("figure6.svg").contains("3: MFP; 4: low_T2)"));
    assert!(shown("report.html").contains(r#""own_names":[[4,"low_T2"]]"#));
    let fiv = fiv(&second);
    let named =
        |from: f64, to: f64| fiv.iter().filter(|(t, fiv)| (from..to).contains(t) && fiv == "4").count();
    assert!(named(415.0, 430.0) > 100, "{} of 136 ticks", named(415.0, 430.0));
    assert_eq!(named(0.0, 410.0), 0);
}

#[test]
fn what_has_a_row_already_is_not_taught() {
    let dir = folder("teach-conflict");
    let (out, scenario) = (dir.join("out"), dir.join("high.toml"));
    let fault =
        "[[fault]]\nname = \"high\"\ndo = \"offset\"\nsensor = \"t2\"\nsize = 1.5\nat = 400.0\nfor = 20.0\n";
    std::fs::write(&scenario, format!("duration = 440.0\n{fault}")).unwrap();
    assert!(pt326(&["run", "--scenario", arg(&scenario), "--out", arg(&out)]).status.success());
    let trace = out.join("trace.csv");
    let output = pt326(&["teach", arg(&trace), "--fault", "high:400..420"]);
    let told = text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("Not taught: row 1 of isolation") && told.contains("One repetition"), "{told}");

    let output = pt326(&["teach", arg(&trace), "--fault", "early:100..120"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("from 100 to 120 s the instrument does not monitor"));
    let output = pt326(&["teach", arg(&trace), "--fault", "high:400..420", "--seed", "2"]);
    assert_eq!(
        output.status.code(),
        Some(2),
        "another seed than the recording's is no recording to learn from"
    );
}
