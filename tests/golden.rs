//! Change indicator: the paper's run, tick by tick, against a committed record. A refactoring leaves it alone; a change
//! of function shows here in numbers. `UPDATE_GOLDEN=1 cargo test -p pt326-tests --test golden` writes it anew.
//!
//! Every bit of every tick goes into the hash; every 45th row stands in the file for people. The hash is the same in
//! debug and release, which `./check` runs both.

use std::fmt::Write;
use std::path::Path;

use fdi_core::Config;
use pt326_host::experiment::run;
use pt326_host::experiment::scenario::Scenario;
use pt326_host::record::trace::write_trace;
use pt326_lab::protocol;
use pt326_lab::session::Session;

const EVERY: usize = 45;

/// FNV-1a, 64 bit.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3))
}

fn golden() -> String {
    let record = run(&Config::default(), &Scenario::default(), 1).expect("the defaults are valid");
    let mut trace = Vec::new();
    write_trace(&record, &mut trace).expect("memory");
    let mut text = format!("# hash of all {} rows: {:016x}\n", record.rows.len(), hash(&trace));
    let trace = String::from_utf8(trace).expect("text");
    let mut lines = trace.lines();
    let _ = writeln!(text, "{}", lines.next().expect("header"));
    for line in lines.step_by(EVERY) {
        let _ = writeln!(text, "{line}");
    }
    text
}

#[test]
fn the_papers_run_is_unchanged() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/paper.csv");
    let now = golden();
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &now).expect("golden is written");
    }
    let committed = std::fs::read_to_string(&path).expect("tests/golden/paper.csv");
    let header: Vec<&str> = committed.lines().nth(1).unwrap_or_default().split(',').collect();
    let mut changes = String::new();
    for (was, is) in committed.lines().zip(now.lines()).filter(|(was, is)| was != is).take(5) {
        for ((column, a), b) in
            header.iter().zip(was.split(',')).zip(is.split(',')).filter(|((_, a), b)| a != b)
        {
            let _ = writeln!(
                changes,
                "t_s {}: {column} was {a}, is {b}",
                is.split(',').next().unwrap_or_default()
            );
        }
    }
    assert!(committed == now, "the paper's run has changed:\n{changes}");
}

/// The lab comes to the same bits, natively here and in a browser (lab/browser).
#[test]
fn the_papers_run_as_a_scene_of_the_lab_is_the_same() {
    let scene = protocol::read(include_bytes!("../lab/tests/paper.json")).expect("a scene");
    let mut session = Session::new(scene).expect("a rig");
    (0..7727).for_each(|_| drop(session.step()));
    let first = golden().lines().next().expect("a line").to_owned();
    assert_eq!(first, format!("# hash of all 7727 rows: {}", session.digest().expect("a trace")));
}
