//! `pt326 replay`.

use std::path::Path;

use crate::{SHORT, arg, folder, pt326, text};

/// Runs an experiment of a few seconds; the folder with `out/trace.csv`.
fn recorded(name: &str, seed: &str) -> std::path::PathBuf {
    let dir = folder(name);
    let scenario = dir.join("short.toml");
    std::fs::write(&scenario, SHORT).unwrap();
    let out = dir.join("out");
    let output = pt326(&["run", "--scenario", arg(&scenario), "--seed", seed, "--out", arg(&out)]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    dir
}

/// A trace tells its settings; one of an older release does not, and neither does it tell its seed.
#[test]
fn the_seed_is_known_from_the_trace_or_from_the_summary_beside_it() {
    let dir = recorded("replay-seed", "7");
    let (trace, out) = (dir.join("out/trace.csv"), dir.join("replayed"));
    let args = ["replay", arg(&trace), "--out", arg(&out)];
    let output = pt326(&args);
    assert!(output.status.success(), "{}", text(&output.stdout));
    assert!(text(&output.stdout).contains("agrees with the recording on all 181 ticks"));
    let text = std::fs::read_to_string(&trace).unwrap();
    assert!(text.lines().next().unwrap().ends_with(",settings"));
    let older = text.lines().map(|line| format!("{}\n", line.rsplit_once(',').unwrap().0));
    std::fs::write(&trace, older.collect::<String>()).unwrap();
    assert!(pt326(&args).status.success());
    std::fs::remove_file(dir.join("out/summary.json")).unwrap();
    assert_eq!(pt326(&args).status.code(), Some(2), "without it, seed 1 is assumed");
    std::fs::write(&trace, text.as_bytes()).unwrap();
    assert!(pt326(&args).status.success());
}

#[test]
fn a_wrong_seed_or_wrong_settings_are_told_before_any_table() {
    let dir = recorded("replay-wrong", "1");
    let (trace, out, config) = (dir.join("out/trace.csv"), dir.join("replayed"), dir.join("other.toml"));
    std::fs::write(&config, "[pid]\nkp = 3.3\n").unwrap();
    for wrong in [["--seed", "2"], ["--config", arg(&config)]] {
        let output = pt326(&["replay", arg(&trace), wrong[0], wrong[1], "--out", arg(&out)]);
        assert_eq!(output.status.code(), Some(2));
        let printed = text(&output.stdout);
        let (told, table) = (printed.find("--seed and\n--config"), printed.find("PT-326 fault diagnosis"));
        assert!(told.is_some() && told < table, "{printed}");
        assert!(text(&output.stderr).contains("differs from the recording on"));
    }
}

/// The trace alone knows onsets to a tick only: the summary beside it is used, if it is of the same run.
#[test]
fn replay_gives_the_delays_of_the_run() {
    let dir = folder("delays");
    let run = |args: &[&str], out: &Path| {
        let output = pt326(&[args, &["--out", out.to_str().unwrap()]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let faults = |out: &Path| {
        let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
        serde_json::from_str::<serde_json::Value>(&summary).unwrap()["faults"].clone()
    };
    let [first, replayed, alone, other] = ["first", "replayed", "alone", "other"].map(|name| dir.join(name));
    run(&["run"], &first);
    let trace = first.join("trace.csv");
    run(&["replay", trace.to_str().unwrap()], &replayed);
    assert_eq!(faults(&replayed), faults(&first));

    std::fs::create_dir_all(&alone).unwrap();
    std::fs::copy(&trace, alone.join("trace.csv")).unwrap();
    let copy = alone.join("trace.csv");
    let printed = run(&["replay", copy.to_str().unwrap()], &dir.join("replayed alone"));
    assert!(printed.contains("onsets to a tick only"), "{printed}");
    run(&["run", "--fault-size", "2"], &other);
    let summary = std::fs::read_to_string(other.join("summary.json")).unwrap();
    std::fs::write(alone.join("summary.json"), summary.replace("384.5", "383.5")).unwrap();
    let printed = run(&["replay", copy.to_str().unwrap()], &dir.join("replayed beside another"));
    assert!(printed.contains("onsets to a tick only"), "{printed}");
}
