//! The log over the serial port: all that a replay needs, beside answers, without a tick that is late.

use std::rc::Rc;
use std::sync::LazyLock;

use fdi_core::Config;
use fdi_core::schema::WORDS;
use firmware_logic::stream::frame::{Reader, Step};
use virtual_board::board::load;
use virtual_board::image::Image;
use virtual_board::recording::Recording;
use virtual_board::rtt::Line;
use virtual_board::scene::{Scene, WAIVE_CHECK};
use virtual_board::time::SECOND;

use crate::is_punctual;

/// A board that was told to start anew, and has run for a second since.
fn restarted(image: Rc<Image>) -> Scene {
    let mut scene = Scene::at_rest(image).expect("boots");
    scene.board.take_terminal();
    scene.board.send(b"restart\r");
    scene.board.run_for(SECOND).expect("starts again");
    scene
}

/// Text and lines of what a terminal shows.
fn parted(shown: &str) -> (String, Vec<Line>) {
    let mut reader = Reader::<1024>::default();
    let (mut text, mut lines) = (String::new(), vec![]);
    for byte in shown.bytes() {
        match reader.push(byte) {
            Step::Text(byte) => text.push(byte.into()),
            Step::Line(line) => {
                lines.push(Line { timestamp: String::new(), level: "", text: line.to_owned() })
            }
            Step::Broken => panic!("a frame is broken in {shown}"),
            Step::Nothing => {}
        }
    }
    (text, lines)
}

/// Types a line amid the stream, and lets a second pass.
fn type_in(scene: &mut Scene, line: &str) {
    scene.board.send(format!("{line}\r").as_bytes());
    scene.board.run_for(SECOND).expect("runs on");
}

struct Run {
    lines: Vec<Line>,
    logged: Vec<String>,
    text: String,
}

/// 850 s with the paper's faults, a command each 50 s.
static RUN: LazyLock<Run> = LazyLock::new(|| {
    let mut scene = restarted(load(None).expect("an image"));
    let start =
        scene.board.log.iter().rposition(|line| line.text.starts_with("log format")).expect("a start");
    type_in(&mut scene, WAIVE_CHECK);
    scene.connect(&pt326_host::experiment::scenario::Scenario::default().faults);
    type_in(&mut scene, "arm");
    for _ in 0..17 {
        type_in(&mut scene, "get"); // the longest answer
        scene.board.run_for(49 * SECOND).expect("runs on");
    }
    type_in(&mut scene, "status");
    let (text, lines) = parted(&scene.board.take_terminal());
    let logged = scene.board.log[start..].iter().map(|line| line.text.clone()).collect();
    Run { lines, logged, text }
});

#[test]
fn every_word_of_the_stream_comes_out_of_the_core_on_the_host() {
    let recording = Recording::of(&RUN.lines, &Config::default()).expect("no gap");
    assert!(recording.ticks.len() * WORDS > 247_000, "{} ticks", recording.ticks.len());
    assert_eq!(recording.differences, []);
}

#[test]
fn nothing_is_late_and_nothing_is_dropped() {
    let status = RUN.text.rsplit("> status").next().expect("an answer");
    assert!(is_punctual(status), "{status}");
    assert!(status.contains("log dropped 0, stream dropped 0"), "{status}");
}

#[test]
fn the_stream_has_what_the_log_has_and_answers_stay_whole() {
    let streamed: Vec<&str> = RUN.lines.iter().map(|line| &*line.text).collect();
    let machine = |text: &&String| {
        text.starts_with("tick ") || text.starts_with("order ") || text.starts_with("commissioned")
    };
    for line in RUN.logged.iter().filter(machine).take(7000) {
        assert!(streamed.contains(&&**line), "{line}");
    }
    assert_eq!(RUN.text.matches("pid.kp = 2.4 %/degC").count(), 17);
}

#[test]
fn without_the_order_nothing_is_streamed() {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    scene.board.take_terminal();
    type_in(&mut scene, "faults");
    assert!(!scene.board.take_terminal().contains('\x02'));
    type_in(&mut scene, "stream on");
    type_in(&mut scene, "stream off");
    let lines = parted(&scene.board.take_terminal()).1;
    let ticks = lines.iter().filter(|line| line.text.starts_with("tick ")).count();
    assert!((8..=11).contains(&ticks), "{ticks} ticks in a second");
    type_in(&mut scene, "faults");
    assert!(!scene.board.take_terminal().contains('\x02'));
}

#[test]
fn a_restart_is_no_fault_and_lifts_no_lockout() {
    let mut scene = restarted(load(None).expect("an image"));
    assert!(scene.board.logged("reset cause: restart"));
    type_in(&mut scene, "stream off");
    assert!(!scene.board.command("status").expect("answers").contains("locked out"));
    scene.arm().expect("arms");
    scene.board.run_for(3 * SECOND).expect("heats");
    assert!(
        scene.board.command("restart").expect("answers").contains("error: not while the heater may be on")
    );
    scene.board.interlock(false);
    scene.board.run_for(SECOND).expect("runs on");
    scene.board.interlock(true);
    assert!(
        scene.board.command("restart").expect("answers").contains("error: a trip or a lockout is latched")
    );
}
