//! What a person has stopped stays so, however much was under way.

use virtual_board::board::load;
use virtual_board::inject;
use virtual_board::scene::{Scene, WAIVE_CHECK};
use virtual_board::time::{MS, SECOND};

fn about_to_arm() -> Scene {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    scene.board.command(WAIVE_CHECK).expect("answers");
    scene.connect(&[]);
    scene
}

/// The diagnosis, which tells the panel what a tick has done, is late; the panel looks at the output itself.
#[test]
fn the_button_stops_an_output_of_which_the_status_does_not_know_yet() {
    let mut scene = about_to_arm();
    scene.board.send(b"arm\r");
    let mut waited = 0;
    while scene.board.heater() == 0.0 {
        inject::silence(&mut scene.board, "diagnosis", 5 * MS).expect("runs on");
        waited += 5;
        assert!(waited < 220, "does not heat");
    }
    scene.board.button(true);
    let pressed = scene.board.now();
    inject::silence(&mut scene.board, "diagnosis", 60 * MS).expect("runs on");
    let off = scene.board.heater_off_since().expect("off");
    assert!(off - pressed <= 55 * MS, "off after {} ms", (off - pressed) / MS);
    assert_eq!(scene.board.resets, []);
}

/// Behind a long answer; in one burst with the stop; and at whatever place its own carrying out has come to.
#[test]
fn a_line_that_was_typed_before_a_stop_does_not_heat_after_it() {
    let under_way = (1..16).map(|i| ("arm\r", 10 * i));
    for (typed, wait) in [("get\rarm\r", 50), ("arm\r", 0)].into_iter().chain(under_way) {
        let mut scene = about_to_arm();
        scene.board.send(typed.as_bytes());
        scene.board.run_for(wait * MS).expect("runs on");
        scene.board.send(b"!");
        scene.board.run_for(MS).expect("runs on");
        let stopped = scene.board.now();
        scene.board.run_for(3 * SECOND).expect("runs on");
        let log = &scene.board.chip().heater_log;
        let heated =
            scene.board.heater() > 0.0 || log.iter().any(|(at, power)| *at > stopped && *power > 0.0);
        assert!(!heated, "{typed:?} heats after a stop {wait} ms later");
        assert!(scene.board.command("status").expect("answers").contains("mode off"));
        scene.arm().expect("a stop is no hold, and the console goes on");
    }
}

#[test]
fn a_line_that_was_typed_before_a_stop_is_forgotten_whatever_it_orders() {
    let mut scene = about_to_arm();
    scene.board.send(b"get\rset pid.kp 2\r");
    scene.board.run_for(50 * MS).expect("runs on");
    scene.board.send(b"!");
    scene.board.run_for(2 * SECOND).expect("runs on");
    assert_eq!(scene.board.command("get pid.kp").expect("answers"), "pid.kp = 2.4 %/degC");
}

/// The begin of a frame is forgotten with what was typed: it would swallow the line after it.
#[test]
fn half_a_frame_does_not_swallow_what_is_typed_after_a_stop() {
    let mut scene = about_to_arm();
    scene.board.send(b"\x02codes 1 2 3");
    scene.board.run_for(SECOND).expect("has read it");
    scene.board.send(b"!");
    scene.board.run_for(SECOND).expect("runs on");
    assert_eq!(scene.board.command("get pid.kp").expect("answers"), "pid.kp = 2.4 %/degC");
}

#[test]
fn the_console_says_that_the_button_has_stopped_it() {
    let mut scene = about_to_arm();
    scene.board.command("arm").expect("answers");
    scene.board.run_for(SECOND).expect("heats");
    scene.board.take_terminal();
    scene.board.button(true);
    scene.board.run_for(300 * MS).expect("runs on");
    let said = scene.board.take_terminal();
    assert!(said.contains("stopped by the button"), "{said}");
}
