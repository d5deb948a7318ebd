//! `pt326 board` and the unmodified image, with a serial port between them.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread;

use clap::Parser;
use fdi_core::Config;
use pt326::commands::Cli;
use virtual_board::recording::Recording;
use virtual_board::rtt::Line;

use crate::live::LiveBoard;

/// Runs `pt326 board PORT ..`; whether its exit code is 0.
fn pt326(port: &str, arguments: &[&str]) -> anyhow::Result<bool> {
    let arguments = [&["pt326", "board", port], arguments].concat();
    Ok(Cli::try_parse_from(arguments)?.run()? == ExitCode::SUCCESS)
}

/// A file that nobody else has.
fn file(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("pt326-{}-{name}", std::process::id()))
}

fn lines(path: &Path) -> Vec<Line> {
    let text = std::fs::read_to_string(path).expect("a record");
    let line = |text: &str| Line { timestamp: String::new(), level: "", text: text.to_owned() };
    text.lines().map(line).collect()
}

#[test]
fn exit_codes_tell_a_right_rig_from_a_wrong_one() {
    let board = LiveBoard::new();
    assert!(pt326(&board.name, &["status"]).expect("answers"));
    assert!(pt326(&board.name, &["check"]).expect("checks"));
    assert!(pt326(&board.name, &["faults"]).expect("answers"));
    board.desk("wire swap t1 t2");
    assert!(!pt326(&board.name, &["check"]).expect("checks"));
}

#[test]
fn settings_go_to_a_file_and_come_back() {
    let board = LiveBoard::new();
    let path = file("settings.toml");
    let name = path.to_str().expect("a name");
    assert!(pt326(&board.name, &["settings", "save", name]).expect("saves"));
    let text = std::fs::read_to_string(&path).expect("a file");
    assert!(text.contains("kp = 2.4 "), "{text}");
    std::fs::write(&path, text.replace("kp = 2.4 ", "kp = 2.9 ")).expect("writes");
    assert!(pt326(&board.name, &["settings", "load", name]).expect("loads"));
    board.desk("power");
    assert!(pt326(&board.name, &["settings", "save", name]).expect("saves"));
    let kept = std::fs::read_to_string(&path).expect("a file");
    assert!(kept.contains("kp = 2.9 "), "{kept}");
    std::fs::write(&path, kept.replace("kp = 2.9 ", "kp = -1.0 ")).expect("writes");
    let error = format!("{:#}", pt326(&board.name, &["settings", "load", name]).expect_err("out of bounds"));
    assert!(error.contains("pid.kp"), "{error}");
    let _ = std::fs::remove_file(path);
}

#[test]
fn a_record_from_the_start_runs_through_the_core_to_the_same_bits() {
    let board = LiveBoard::new();
    let path = file("record.log");
    let name = path.to_str().expect("a name");
    assert!(pt326(&board.name, &["--record", name, "--from-start", "--seconds", "60"]).expect("records"));
    let recording = Recording::of(&lines(&path), &Config::default()).expect("no gap");
    assert!(recording.ticks.len() >= 545, "{} ticks", recording.ticks.len());
    assert_eq!(recording.differences, []);
    let _ = std::fs::remove_file(path);
}

#[test]
fn a_record_goes_on_when_the_cable_is_plugged_in_again_and_tells_the_gap() {
    let board = LiveBoard::new();
    let path = file("gap.log");
    let name = path.to_str().expect("a name").to_owned();
    let port = &board.name;
    thread::scope(|scope| {
        let recording = scope.spawn(|| pt326(port, &["--record", &name, "--from-start", "--seconds", "60"]));
        while !std::fs::metadata(&path).is_ok_and(|file| file.len() > 0) && !recording.is_finished() {
            thread::yield_now();
        }
        board.desk("unplug");
        board.desk("plug");
        assert!(recording.join().expect("no panic").expect("records"));
    });
    let text = std::fs::read_to_string(&path).expect("a record");
    let told: Vec<&str> = text.lines().filter(|line| line.starts_with('#')).collect();
    assert!(told[0] == "# the port has gone" && told[1] == "# the port is back", "{told:?}");
    assert!(told[2].ends_with("are missing"), "{told:?}");
    let _ = std::fs::remove_file(path);
}

#[test]
fn what_is_no_board_is_told() {
    let board = LiveBoard::new();
    board.desk("unplug");
    let error = format!("{:#}", pt326(&board.name, &["status"]).expect_err("nobody is there"));
    assert!(error.contains("cannot be opened"), "{error}");
}
