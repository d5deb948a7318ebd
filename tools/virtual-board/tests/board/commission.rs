//! `pt326 board commission` and the unmodified image: from blank flash to a rig that is watched, by way of wrong wires.

use pt326::commands::board::{Commissioning, Person, commission};
use pt326::commands::replay::agreement;
use pt326_host::board::Session;

use crate::live::LiveBoard;

/// Says to each question what is next, to the first that has the word in it.
struct Scripted {
    answers: Vec<(&'static str, &'static str)>,
    told: String,
    /// Goes away, terminal and all, at a line with this in it.
    leaves_at: Option<&'static str>,
}

impl Person for Scripted {
    fn tell(&mut self, line: &str) -> anyhow::Result<()> {
        self.told += line;
        self.told.push('\n');
        anyhow::ensure!(!self.leaves_at.is_some_and(|word| line.contains(word)), "nobody listens");
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
    let mut person = Scripted { answers: answers.to_vec(), told: String::new(), leaves_at: None };
    let done = commission(&mut session, &mut person);
    assert!(done.error.is_none(), "{:#}\n{}", done.error.unwrap(), person.told);
    (done, person.told)
}

/// Whether the board was ordered this.
fn ordered(log: &str, what: &str) -> bool {
    log.lines().any(|line| line.starts_with("order ") && line.ends_with(what))
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
        "mode monitor",
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
    assert!([" check", " tune", " arm"].iter().all(|order| ordered(&done.log, order)));
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
    assert!(![" check", " tune", " arm"].iter().any(|order| ordered(&done.log, order)), "{}", done.log);
    // One yes is for one step.
    let (done, told) = lead(&board, &[("self-test may begin", "y")]);
    assert!(done.passed && ordered(&done.log, " check"), "{told}");
    assert!(told.contains("Tune the controller?") && told.contains("Begin?"), "{told}");
    assert!(![" tune", " arm"].iter().any(|order| ordered(&done.log, order)), "{}", done.log);
}

#[test]
fn whoever_goes_away_in_the_middle_leaves_a_heater_that_is_off_and_a_report() {
    let board = LiveBoard::new();
    let mut session = Session::open(&board.name).expect("a board");
    let answers = vec![("self-test may begin", "y"), ("Begin?", "y")];
    let mut person = Scripted { answers, told: String::new(), leaves_at: Some("mode settle") };
    let done = commission(&mut session, &mut person);
    let error = format!("{:#}", done.error.expect("nobody listens"));
    assert!(error.contains("its heater is off") && error.contains("nobody listens"), "{error}");
    assert!(!done.passed && done.report.contains("nobody listens") && ordered(&done.log, " arm"));
    drop(session);
    let mut session = Session::open(&board.name).expect("a board");
    // A status is that of the last tick, which may have been before the stop.
    let mut status = || session.order("status").expect("answers");
    assert!((0..100).any(|_| status().starts_with("mode off")), "{}", status());
}

#[test]
fn nothing_is_typed_behind_a_stop_by_another_hand() {
    let board = LiveBoard::new();
    let mut session = Session::open(&board.name).expect("a board");
    session.gate().close(|| session.other_hand().expect("the port"));
    let error = session.order("status").expect_err("it is closed");
    assert!(format!("{error:#}").contains("stopped by hand"), "{error:#}");
    let mut person = Scripted { answers: vec![], told: String::new(), leaves_at: None };
    let done = commission(&mut session, &mut person);
    assert!(format!("{:#}", done.error.expect("it is closed")).contains("stopped by hand"));
    assert!(!person.told.contains("Who commissions"), "nobody is asked any more: {}", person.told);
}
