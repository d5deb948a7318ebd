//! `pt326 campaign show`: one of the runs.

use crate::{SMALL, fails, folder, succeeds};

#[test]
fn one_run_can_be_looked_at() {
    let (dir, file) = folder("show", SMALL);
    let out = dir.join("run");
    succeeds(&["show", "fault/afs2 1.5", &file, "--run", "2", "--out", out.to_str().unwrap()]);
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    assert!(summary.contains("\"seed\": 502"), "{summary}");
    let error = fails(&["show", "afs2", &file]);
    assert!(error.contains("fault/afs2 -1.5"), "{error}");
}

#[test]
fn a_run_beyond_the_cell_is_refused() {
    let (dir, file) = folder("beyond", SMALL);
    let show = ["show", "fault/afs2 1.5", &file, "--run", "3", "--out", dir.to_str().unwrap()];
    let error = fails(&show);
    assert!(error.contains("--run 3") && error.contains("from 0 to 2"), "{error}");
}
