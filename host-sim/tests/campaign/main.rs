//! `pt326 campaign` as a user calls it.

mod definition;
mod merge;
mod parquet;
mod same;
mod show;
mod tables;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SMALL: &str = r#"
seeds_from = 500
[[cell]]
name = "fault/afs2"
runs = 3
phase = 60.0
sizes = [1.5, -1.5]
fault = [{ do = "offset", sensor = "t2", at = 400.0, for = 10.0 }]
[[cell]]
name = "silence/ramp"
runs = 3
action = [{ at = 400.0, setpoint = 38.0, over = 10.0 }]
[[target]]
cells = "fault/afs2 1.5"
measure = "first-right"
by = "signature"
at_least = 50.0
[[target]]
cells = "silence/*"
measure = "runs-with-alarm"
at_most = 0.0
"#;

fn campaign(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pt326")).arg("campaign").args(args).output().expect("pt326 runs")
}

fn succeeds(args: &[&str]) -> String {
    let output = campaign(args);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn fails(args: &[&str]) -> String {
    let output = campaign(args);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {}", String::from_utf8_lossy(&output.stdout));
    String::from_utf8(output.stderr).unwrap()
}

/// A fresh folder of this test's own, with the definition in it.
fn folder(name: &str, definition: &str) -> (PathBuf, String) {
    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("campaign-{name}"));
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).expect("folder");
    let file = dir.join("campaign.toml");
    std::fs::write(&file, definition).expect("definition");
    (dir, file.to_str().unwrap().into())
}

fn results(dir: &Path) -> Vec<Vec<u8>> {
    ["campaign.json", "cells.csv", "runs.csv", "tables.md"]
        .map(|name| std::fs::read(dir.join(name)).expect(name))
        .into()
}
