//! `pt326 board` as a process beside the unmodified image: whatever ends it in the middle, its exit code is 2, the heater is off where a
//! byte can still be sent, and where none can that is said.

use std::path::PathBuf;
use std::thread;

use crate::live::LiveBoard;
use crate::process::{Input, Process};

/// What ends it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    PortLost,
    Key(u8),
    Signal(&'static str),
}

const WAYS: [Way; 7] = [
    Way::PortLost,
    Way::Key(0x03),
    Way::Key(b'!'),
    Way::Key(0x1B),
    Way::Signal("-INT"),
    Way::Signal("-TERM"),
    Way::Signal("-HUP"),
];

/// Where it ends: arguments, answers to questions up to there, the last word before, and whether it heats there.
#[derive(Clone, Copy, Debug)]
struct Step {
    arguments: &'static [&'static str],
    answers: &'static [(&'static str, &'static str)],
    word: &'static str,
    heats: bool,
}

const fn step(
    arguments: &'static [&'static str],
    answers: &'static [(&'static str, &'static str)],
    word: &'static str,
    heats: bool,
) -> Step {
    Step { arguments, answers, word, heats }
}

const CHECK: &[&str] = &["check"];
const COMMISSION: &[&str] = &["commission", "FILE"];
const VERIFY: &[&str] = &["verify", "FILE"];
const BEGUN: &[(&str, &str)] = &[("Who", "x\n"), ("Temperature", "\n")];
const CHECKED: &[(&str, &str)] = &[("Who", "x\n"), ("Temperature", "\n"), ("may begin", "y\n")];
const TUNED: &[(&str, &str)] =
    &[("Who", "x\n"), ("Temperature", "\n"), ("may begin", "y\n"), ("Tune the", "y\n")];
const LEARNS: &[(&str, &str)] =
    &[("Who", "x\n"), ("Temperature", "\n"), ("may begin", "y\n"), ("Tune the", "\n"), ("Begin?", "y\n")];

const STEPS: [Step; 15] = [
    step(CHECK, &[], "check: ", false),
    step(CHECK, &[], "check: ", true),
    step(VERIFY, &[], "at once", false),
    step(COMMISSION, &[], "Who commissions", false),
    step(COMMISSION, &[("Who", "x\n")], "Temperature: ", false),
    step(COMMISSION, BEGUN, "may begin. [y/N]", false),
    step(COMMISSION, CHECKED, "check: ", false),
    step(COMMISSION, CHECKED, "check: ", true),
    step(COMMISSION, CHECKED, "Tune the controller?", false),
    step(COMMISSION, TUNED, "tune: at rest", false),
    step(COMMISSION, TUNED, "tune: constant power", true),
    step(COMMISSION, TUNED, "tune: power switched", true),
    step(COMMISSION, TUNED, "Put in force", false),
    step(COMMISSION, LEARNS, "mode settle", true),
    step(COMMISSION, LEARNS, "mode monitor", true),
];

/// A file that nobody else has.
pub(crate) fn file(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("pt326-{}-{:?}-{name}", std::process::id(), thread::current().id()))
}

/// Goes to a step, ends it there in this way, and looks at exit code, heater and words.
fn ends(step: &Step, way: Way) {
    let board = LiveBoard::new();
    let path = file("report.html");
    let arguments: Vec<&str> = std::iter::once(&*board.name)
        .chain(
            step.arguments
                .iter()
                .map(|word| if *word == "FILE" { path.to_str().expect("UTF-8") } else { *word }),
        )
        .collect();
    let mut process = Process::start(&arguments, Input::Terminal);
    for (question, answer) in step.answers {
        process.until(question);
        process.press(answer.as_bytes());
    }
    process.until(step.word);
    if step.heats {
        process.wait_for("heat", |_| board.heater() > 0.0);
    }
    match way {
        Way::PortLost => board.desk("unplug"),
        Way::Key(key) => process.press(&[key]),
        Way::Signal(name) => process.signal(name),
    }
    if way == Way::PortLost {
        process.press(b"y\n"); // at a question nothing heats: whoever answers it hears of the port
    }
    let (code, said) = process.end();
    let case = format!("{step:?} {way:?}: {code}\n{said}");
    assert_eq!(code, 2, "{case}");
    assert!(said.contains("ESC and ! stop the heater"), "{case}");
    match way {
        Way::PortLost => assert!(said.contains("goes on by itself") && said.contains("button"), "{case}"),
        _ => {
            assert!(said.contains("stopped by hand; the board says that its heater is off"), "{case}");
            assert_eq!(board.heater(), 0.0, "{case}");
        }
    }
    if step.arguments == COMMISSION {
        let report = std::fs::read_to_string(&path).expect("a report");
        assert!(report.contains("FAILED"), "{case}");
    }
    for path in [path.with_extension("log"), path] {
        let _ = std::fs::remove_file(path);
    }
}

#[test]
fn a_check_that_is_left_ends_with_2_and_a_cold_heater_or_says_who_stops_it() {
    let heating = &STEPS[1];
    for way in [Way::PortLost, Way::Key(b'!'), Way::Signal("-TERM")] {
        ends(heating, way);
    }
}

#[test]
fn a_commissioning_that_is_left_ends_with_2_and_a_cold_heater_or_says_who_stops_it() {
    ends(&STEPS[5], Way::Key(0x1B));
    ends(&STEPS[10], Way::Key(0x03));
    ends(&STEPS[10], Way::PortLost);
}

/// `cargo test -p virtual-board --test board -- --ignored every_way_at_every_step`
#[test]
#[ignore = "105 boards: 20 minutes"]
fn every_way_at_every_step_ends_with_2_and_a_cold_heater_or_says_who_stops_it() {
    for step in &STEPS {
        for way in WAYS {
            ends(step, way);
        }
    }
}

/// An experiment of `tune` on the console, by a terminal or by a pipe.
fn tuning(input: Input) -> (LiveBoard, Process) {
    let board = LiveBoard::new();
    let typed = matches!(input, Input::Terminal);
    let mut process = Process::start(&[&board.name], input);
    if typed {
        process.until("Ctrl-D leaves");
        process.press(b"set supervisor.check_before_arming false\r");
        process.until("check_before_arming = false");
        process.press(b"tune start\r");
    }
    process.wait_for("heat", |_| board.heater() > 0.0);
    (board, process)
}

const TUNE: &str = "set supervisor.check_before_arming false\ntune start\nwait 1000\n";

#[test]
fn a_console_that_is_ended_while_it_tunes_stops_it_and_one_that_is_cut_off_says_so() {
    for input in [Input::Terminal, Input::Pipe(TUNE)] {
        let (board, mut process) = tuning(input);
        process.signal("-TERM");
        let (code, said) = process.end();
        assert!(code == 2 && said.contains("the board says that its heater is off"), "{code}\n{said}");
        assert_eq!(board.heater(), 0.0);
    }
    for input in [Input::Terminal, Input::Pipe(TUNE)] {
        let (board, mut process) = tuning(input);
        board.desk("unplug");
        let (code, said) = process.end();
        assert!(code == 2 && said.contains("goes on by itself"), "{code}\n{said}");
    }
}

#[test]
#[ignore = "each takes a board: a minute"]
fn every_signal_ends_a_console_that_tunes_and_stops_it() {
    let cases = ["-TERM", "-HUP"].map(|name| (name, Input::Terminal)).into_iter();
    for (name, input) in cases.chain(["-INT", "-TERM", "-HUP"].map(|name| (name, Input::Pipe(TUNE)))) {
        let (board, mut process) = tuning(input);
        process.signal(name);
        let (code, said) = process.end();
        assert_eq!((code, board.heater()), (2, 0.0), "{name}: {said}");
    }
    // On a terminal Ctrl-C stops, and the console goes on, as with the other keys.
    let (board, mut process) = tuning(Input::Terminal);
    process.press(b"!");
    process.wait_for("a cold heater", |_| board.heater() == 0.0);
    process.press(b"\x04");
    assert_eq!(process.end().0, 0);
}

#[test]
fn a_terminal_has_its_mode_back_whatever_ended_the_check() {
    for way in [Way::Key(0x03), Way::Signal("-TERM"), Way::PortLost] {
        let board = LiveBoard::new();
        let mut process = Process::start(&[&board.name, "check"], Input::Terminal);
        process.until("check: ");
        let during = process.mode();
        match way {
            Way::PortLost => board.desk("unplug"),
            Way::Key(key) => process.press(&[key]),
            Way::Signal(name) => process.signal(name),
        }
        process.end();
        let after = process.mode();
        let has = |mode: &str, word| mode.split_whitespace().any(|each| each == word);
        assert!(has(&during, "-icanon"), "{way:?}: {during}");
        for word in ["icanon", "isig", "echo", "ixon"] {
            assert!(has(&after, word), "{way:?}: {word} in {after}");
        }
    }
}
