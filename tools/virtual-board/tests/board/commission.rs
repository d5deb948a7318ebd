//! `pt326 board commission` and the unmodified image: from blank flash to a rig that is watched, by way of wrong wires.

use host_sim::board::Session;
use host_sim::commands::board::{Commissioning, Person, commission};
use host_sim::commands::replay::agreement;

use crate::live::LiveBoard;

/// Says to each question what is next, to the first that has the word in it.
struct Scripted {
    answers: Vec<(&'static str, &'static str)>,
    told: String,
}

impl Person for Scripted {
    fn tell(&mut self, line: &str) -> anyhow::Result<()> {
        self.told += line;
        self.told.push('\n');
        Ok(())
    }

    fn ask(&mut self, question: &str) -> anyhow::Result<Option<String>> {
        self.told += question;
        let next = self.answers.iter().position(|(word, _)| question.contains(word));
        let answer = next.map(|i| self.answers.remove(i).1.to_owned());
        self.told += answer.as_deref().unwrap_or_default();
        self.told.push('\n');
        Ok(Some(answer.unwrap_or_default()))
    }
}

fn lead(board: &LiveBoard, answers: &[(&'static str, &'static str)]) -> (Commissioning, String) {
    let mut session = Session::open(&board.name).expect("a board");
    let mut person = Scripted { answers: answers.to_vec(), told: String::new() };
    let done = commission(&mut session, &mut person);
    let done = done.unwrap_or_else(|error| panic!("{error:#}\n{}", person.told));
    (done, person.told)
}

#[test]
fn a_board_with_blank_flash_is_led_to_a_rig_that_is_watched() {
    let board = LiveBoard::new();
    board.desk("wire swap t1 t2");
    let (done, told) = lead(&board, &[("self-test may begin", "y")]);
    assert!(!done.passed && told.contains("T1 and T2 are swapped"), "{told}");
    assert!(!told.contains("Tune the controller?"), "{told}");

    board.desk("wire ok");
    let answers = [
        ("Who", "somebody & a test"),
        ("Temperature", "22.5"),
        ("Put that in force?", "y"),
        ("self-test may begin", "yes"),
        ("Tune", "y"),
        ("quick", "quickly"),
        ("quick", "quick"),
        ("Begin?", "y"),
        ("keep", "y"),
    ];
    let (done, told) = lead(&board, &answers);
    assert!(done.passed, "{told}");
    for word in [
        "gain 1.0000, offset",
        "check passed",
        "tune: done",
        "error: tune: expected",
        "in force: kp",
        "monitoring",
        "learnt from",
        "Median of",
        "Kept.",
    ] {
        assert!(told.contains(word), "{word} in:\n{told}");
    }
    for word in ["somebody &amp; a test", "pid.kp = ", "sensors.t1.offset = ", "What can be told apart"] {
        assert!(done.report.contains(word), "{word} in:\n{}", done.report);
    }
    assert!(!done.report.contains(">FAILED"));

    // Each word of it, experiment included, is what the core on the host comes to.
    let (agrees, said) = agreement(&done.log).expect("a log from its first tick on");
    assert!(agrees, "{said}");

    board.desk("power");
    let mut session = Session::open(&board.name).expect("a board");
    assert!(session.order("get pid.kp").expect("answers").trim() != "pid.kp = 2.4 %/degC", "it was kept");
}

#[test]
fn nobody_who_says_no_is_heated_for() {
    let board = LiveBoard::new();
    let (done, told) = lead(&board, &[]);
    assert!(done.passed && told.contains("Without it nothing more heats."), "{told}");
    let heated = |line: &str| {
        line.starts_with("order ")
            && (line.ends_with(" arm") || line.ends_with(" check") || line.ends_with(" tune"))
    };
    assert!(!done.log.lines().any(heated), "{}", done.log);
}
