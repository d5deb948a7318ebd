//! Neither threads nor shards nor interruptions nor what else is run change a result.

use std::path::Path;
use std::process::Command;

use crate::{SMALL, fails, folder, results, succeeds};

#[test]
fn threads_shards_and_interruptions_change_no_byte() {
    let (dir, file) = folder("same", SMALL);
    let [one, two, part, merged] = ["one", "two", "part", "merged"].map(|name| dir.join(name));
    let path = |dir: &Path| dir.to_str().unwrap().to_owned();
    let table = succeeds(&[&file, "--threads", "1", "--out", &path(&one)]);
    assert!(table.contains("fault/afs2 1.5") && table.contains("silence/ramp"), "{table}");
    let numbers = table.split("\nWritten").next().unwrap();
    assert!(numbers.lines().all(|line| line.chars().count() <= 100), "{table}");

    // Interrupted in the middle of a line, and gone on with by more threads.
    std::fs::create_dir_all(&two).unwrap();
    let whole = std::fs::read(one.join("runs.jsonl")).unwrap();
    let third_line = whole.iter().enumerate().filter(|(_, b)| **b == b'\n').nth(2).unwrap().0;
    std::fs::write(two.join("runs.jsonl"), &whole[..third_line + 40]).unwrap();
    succeeds(&[&file, "--threads", "3", "--out", &path(&two)]);
    assert_eq!(std::fs::read_to_string(two.join("runs.jsonl")).unwrap().lines().count(), 10);

    for shard in ["1/2", "2/2"] {
        succeeds(&[&file, "--shard", shard, "--out", &path(&part)]);
    }
    let parts = ["runs.1-of-2.jsonl", "runs.2-of-2.jsonl"].map(|name| path(&part.join(name)));
    let error = fails(&["merge", &parts[0], "--out", &path(&merged)]);
    assert!(error.contains("part 2 of 2 is missing"), "{error}");
    let again = succeeds(&["merge", &parts[1], &parts[0], "--out", &path(&merged)]);
    let numbers = |text: &str| text.split("\nWritten").next().unwrap().to_owned();
    assert_eq!(numbers(&again), numbers(&table));
    for other in [&two, &merged] {
        assert!(results(other) == results(&one), "{}", other.display());
        let picture = |dir: &Path| std::fs::read(dir.join("delays.svg")).expect("delays.svg");
        assert!(picture(other) == picture(&one), "{}", other.display());
    }
}

#[test]
fn results_of_another_definition_are_refused_until_put_away() {
    let (dir, file) = folder("changed", SMALL);
    let out = dir.join("out").to_str().unwrap().to_owned();
    succeeds(&[&file, "--only", "silence", "--out", &out]);
    std::fs::write(&file, SMALL.replace("setpoint = 38.0", "setpoint = 39.0")).unwrap();
    let error = fails(&[&file, "--only", "silence", "--out", &out]);
    assert!(error.contains("setpoint = 38.0") && error.contains("setpoint = 39.0"), "{error}");
    assert!(error.contains("runs.jsonl") && error.contains("--fresh"), "{error}");
    succeeds(&[&file, "--only", "silence", "--out", &out, "--fresh"]);
}

#[test]
fn seeds_do_not_depend_on_what_else_is_run() {
    let (dir, file) = folder("seeds", SMALL);
    let out = dir.join("out").to_str().unwrap().to_owned();
    let table =
        succeeds(&[&file, "--only", "silence", "--sweep", "diagnosis.sigma_factor=3,50.0", "--out", &out]);
    assert!(table.contains("silence/ramp [diagnosis.sigma_factor=50.0]"), "{table}");
    let runs = std::fs::read_to_string(dir.join("out/runs.csv")).unwrap();
    let seeds: Vec<&str> = runs.lines().skip(1).map(|line| line.split(',').nth(3).unwrap()).collect();
    assert_eq!(seeds, ["506", "507", "508", "506", "507", "508"], "after the six of the other cell");
}

/// More runs than anyone waits for.
const ENDLESS: &str = "[[cell]]\nname = \"quiet\"\nruns = 1000000\nduration = 10.0\n";

#[cfg(unix)]
#[test]
fn ctrl_c_says_how_to_go_on() {
    let (dir, file) = folder("interrupted", ENDLESS);
    let out = dir.join("out");
    let mut child = Command::new(env!("CARGO_BIN_EXE_pt326"))
        .args(["campaign", &file, "--out", out.to_str().unwrap()])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let finished = || std::fs::read_to_string(out.join("runs.jsonl")).map_or(0, |text| text.lines().count());
    while finished() < 3 {
        assert!(child.try_wait().unwrap().is_none(), "it has ended by itself");
        std::thread::yield_now();
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{message}");
    let kept = finished() - 1;
    assert!(message.contains(&format!("{kept} of 1000000 runs are finished")), "{message}");
    assert!(message.contains("The same command goes on"), "{message}");
}
