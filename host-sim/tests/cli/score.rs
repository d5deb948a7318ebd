//! What a run says of its faults: what it saw, what it could not see, and beside what it is set.

use crate::{folder, pt326, text};

/// A run of 400 s that monitors from 360 s on, with `more` in its scenario.
fn run_scenario(name: &str, more: &str, args: &[&str]) -> (String, serde_json::Value, String) {
    let dir = folder(name);
    let file = dir.join("scenario.toml");
    std::fs::write(&file, format!("duration = 400.0\n{more}")).unwrap();
    let common = ["run", "--scenario", file.to_str().unwrap(), "--out", dir.to_str().unwrap()];
    let output = pt326(&[&common, args].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let read = |name| std::fs::read_to_string(dir.join(name)).unwrap();
    (text(&output.stdout), serde_json::from_str(&read("summary.json")).unwrap(), read("report.html"))
}

/// An offset of T2 by 1.5 degC.
fn offset(name: &str, at: f64, duration: f64) -> String {
    format!(
        "[[fault]]\nname = \"{name}\"\ndo = \"offset\"\nsensor = \"t2\"\nsize = 1.5\nat = {at}\nfor = {duration}\n"
    )
}

#[test]
fn what_a_run_could_not_see_is_told_and_not_scored_as_missed() {
    let faults =
        [offset("early", 100.0, 9.0), offset("long", 380.0, 99.0), offset("late", 450.0, 9.0)].concat();
    let action = "[[action]]\nat = 420.0\nsetpoint = 36.0\n";
    let (table, summary, page) = run_scenario("unseen", &(faults + action), &[]);
    let line = |name: &str| table.lines().find(|line| line.starts_with(name)).unwrap().to_owned();
    assert_eq!(line("early").matches("before monitoring").count(), 2, "{table}");
    assert_eq!(line("late").matches("after the end").count(), 2, "{table}");
    assert!(!table.contains("never"), "{table}");
    assert!(line("long").contains("/ 20.0 s"), "as far as the run goes: {table}");
    assert!(table.contains("long lasts 99.0 s, beyond the end of the run at 400.0 s"), "{table}");
    assert!(table.contains("an action at 420.00 s, after the end"), "{table}");
    let not_scored = |i: usize| summary["faults"][i]["signature"]["not_scored"].clone();
    assert_eq!((not_scored(0), not_scored(2)), ("before_monitoring".into(), "after_the_end".into()));
    assert!(not_scored(1).is_null() && summary["faults"][1]["beyond_the_end"] == true);
    assert!(page.contains("1 of 1") && page.contains("An action at 420.00 s was not done"), "{page}");
    // The page draws the run by the lab's own code, which has words for the paper.
    let words =
        page.split("<script").map(|part| part.rsplit("</script>").next().unwrap()).collect::<String>();
    assert!(words.contains("before monitoring"), "{words}");
    for text in [&table, &words] {
        assert!(
            !text.to_lowercase().contains("paper:") && !text.contains("4.3 %"),
            "it is not the paper's run"
        );
    }
}

#[test]
fn nothing_is_zero_that_was_not_measured() {
    let (table, summary, _) = run_scenario("measured", "fault = []\n", &[]);
    assert!(table.contains("% of the set-point") && table.contains("fdv 0"), "{table}");
    assert!(summary["control_error_max_pct"].is_f64() && summary["false_alarms"]["fdv"] == 0);
    let dir = folder("shorter");
    let file = dir.join("scenario.toml");
    std::fs::write(&file, "duration = 20.0\nfault = []\n").unwrap();
    let output = pt326(&["run", "--scenario", file.to_str().unwrap(), "--out", dir.to_str().unwrap()]);
    let table = text(&output.stdout);
    assert!(!table.contains("0.00 %") && table.contains("not measured"), "{table}");
    assert!(table.contains("fdv -, fiv - (low-passed)") && table.contains("likelihood -"), "{table}");
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(dir.join("summary.json")).unwrap()).unwrap();
    assert!(summary["control_error_max_pct"].is_null() && summary["false_alarms"]["fdv"].is_null());
}

#[test]
fn repeat_counts_no_fault_as_missed_that_it_could_not_see() {
    let dir = folder("repeat-unseen");
    let file = dir.join("scenario.toml");
    std::fs::write(&file, format!("duration = 400.0\n{}", offset("late", 450.0, 9.0))).unwrap();
    let output = pt326(&["repeat", "--seeds", "2", "--scenario", file.to_str().unwrap()]);
    let table = text(&output.stdout);
    let line = table.lines().find(|line| line.starts_with("late")).unwrap();
    assert!(!line.contains("never") && !line.contains('%'), "{table}");
}

/// The paper's results stand beside its own experiment, and nothing is wider than a terminal.
#[test]
fn the_papers_run_has_the_papers_results_beside_it() {
    let dir = folder("papers");
    let output = pt326(&["run", "--out", dir.to_str().unwrap()]);
    let table = text(&output.stdout);
    assert!(table.contains("2 s, 14 s") && table.contains("paper 4.3 %"), "{table}");
    assert!(
        table.lines().all(|line| line.chars().count() <= 100 || line.starts_with("Written to")),
        "{table}"
    );
    assert!(table.contains("°C") && !table.contains("degC"), "{table}");
    let page = std::fs::read_to_string(dir.join("report.html")).unwrap();
    assert!(page.contains("Paper: delay") && !page.contains("degC"));
}
