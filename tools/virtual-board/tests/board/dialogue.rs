//! What `pt326 board` says and does beside the unmodified image, one process a question.

use crate::command::file;
use crate::live::LiveBoard;
use crate::process::{Input, Process};

/// Its exit code and words, with these lines in a pipe.
fn piped(board: &LiveBoard, arguments: &[&str], lines: &'static str) -> (i32, String) {
    let mut process = Process::start(&[&[&*board.name], arguments].concat(), Input::Pipe(lines));
    process.close_input();
    process.end()
}

#[test]
fn what_a_board_refuses_ends_a_pipe_with_2_and_keeps_no_line_from_it() {
    let board = LiveBoard::new();
    let (code, said) = piped(&board, &[], "arm\nnonsense\nset pid.kp 3\nget pid.kp\n");
    assert!(code == 2 && said.contains("error: `arm` was refused: no `check` has passed"), "{code}\n{said}");
    assert!(said.contains("unknown command \"nonsense\"") && said.contains("pid.kp = 3 %/degC"), "{said}");
    let (code, said) = piped(&board, &[], "status\n!\nget pid.kp\n");
    assert!(code == 0 && said.contains("stopped; what was typed"), "{code}\n{said}");
    assert!(said.contains("> get pid.kp\npid.kp = 3 %/degC\n"), "each answer behind its question: {said}");
}

#[test]
fn a_start_anew_is_told_and_the_console_goes_on() {
    let board = LiveBoard::new();
    let (code, said) =
        piped(&board, &[], "restart\nget pid.kp\nsimulate on\nstatus\nrestart\nstream off\nstatus\n");
    assert_eq!((code, said.matches("the board has started anew\n").count()), (0, 3), "{said}");
    assert!(said.contains("pid.kp = 2.4 %/degC\n"), "{said}");
    assert_eq!(said.matches("SIMULATED: ").count(), 1, "{said}");
    assert!(!said.lines().any(|line| line.starts_with("> >") || line == ">"), "{said}");
}

#[test]
fn settings_are_not_loaded_while_it_heats_and_nothing_is_changed() {
    let board = LiveBoard::new();
    let path = file("kp.toml");
    std::fs::write(&path, "[pid]\nkp = 5.0\n").expect("writes");
    let heat = "set supervisor.check_before_arming false\narm\n";
    assert_eq!(piped(&board, &[], heat).0, 0);
    let (code, said) = piped(&board, &["settings", "load", path.to_str().expect("UTF-8")], "");
    assert!(
        code == 2 && said.contains("mode settle") && said.contains("nothing was changed"),
        "{code}\n{said}"
    );
    let (_, said) = piped(&board, &[], "get pid.kp\nstop\n");
    assert!(said.contains("pid.kp = 2.4 %/degC"), "{said}");
    let _ = std::fs::remove_file(path);
}

#[test]
fn a_report_without_a_folder_is_told_before_anything_is_asked() {
    let board = LiveBoard::new();
    for action in ["commission", "verify"] {
        let (code, said) = piped(&board, &[action, "/no/such/folder/report.html"], "");
        assert!(
            code == 2 && said.contains("/no/such/folder/report.html cannot be written"),
            "{code}\n{said}"
        );
        assert!(!said.contains("Who commissions"), "{said}");
    }
}

#[test]
fn the_button_that_ends_a_check_is_named() {
    let board = LiveBoard::new();
    let mut process = Process::start(&[&board.name, "check"], Input::Pipe(""));
    process.wait_for("heat", |_| board.heater() > 0.0);
    board.desk("button down");
    let (code, said) = process.end();
    assert_eq!((code, board.heater()), (1, 0.0), "{said}");
    let (named, ended) = (said.find("stopped by the button"), said.find("check ended early: stopped"));
    assert!(named.is_some() && named < ended, "{said}");
}

#[test]
fn a_temperature_that_was_typed_is_withdrawn() {
    let board = LiveBoard::new();
    let path = file("back.html");
    let answers = "somebody\n22.5\n25\nback\n\ny\n\n\n";
    let (code, said) = piped(&board, &["commission", path.to_str().expect("UTF-8")], answers);
    let report = std::fs::read_to_string(&path).expect("a report");
    assert!(code == 0 && said.contains("Without it nothing more heats"), "{code}\n{said}");
    let offset = report.split("sensors.t1.offset = ").nth(1).and_then(|rest| rest.split(' ').next());
    let offset: f64 = offset.and_then(|offset| offset.parse().ok()).unwrap_or_else(|| panic!("{report}"));
    assert!(offset.abs() < 1.0, "{offset}: that of 22.5, and not the mean with 25");
    for path in [path.with_extension("log"), path] {
        let _ = std::fs::remove_file(path);
    }
}
