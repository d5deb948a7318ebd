//! Another sample time that was saved: the period of the tick from the next start on. How soon what is dangerous switches the heater off
//! does not go by it.

use virtual_board::board::load;
use virtual_board::clock::Cause;
use virtual_board::inject;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, SECOND};

/// Restarted with this sample time, the tick at hand being the third.
fn with(sample_time: &str) -> Scene {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    let sample_time = format!("set sample_time {sample_time}");
    // A loop that is slow enough for all of them.
    for line in ["set identification.answer_time 8", &sample_time, "set pid.kp 0.5", "set pid.ti 2", "save"] {
        let answer = scene.board.command(line).expect("answers");
        assert!(!answer.contains("error"), "{line}: {answer}");
    }
    // The slowest of the data sheet: else, where the control task hangs, it is the watchdog that cuts first.
    scene.board.cpu.touch(|chip, _| chip.watchdog.oscillator = 17_000);
    scene.board.reset(Cause::Pin).expect("resets");
    scene.board.log.clear();
    scene.board.run_until("ticks", 10 * SECOND, |board| board.logged("tick 2 ")).expect("ticks");
    scene
}

fn heating(sample_time: &str) -> Scene {
    let mut scene = with(sample_time);
    scene.arm().expect("arms");
    scene.board.run_for(8 * SECOND).expect("runs on");
    assert!(scene.board.heater() > 0.0, "{sample_time} s: armed, but the heater is off");
    scene
}

#[test]
fn ticks_come_by_the_saved_sample_time() {
    for (sample_time, ms) in [("0.05", 50), ("0.25", 250), ("1", 1000)] {
        let mut scene = with(sample_time);
        let begin = scene.board.now();
        scene.board.run_until("ticks", 20 * SECOND, |board| board.logged("tick c ")).expect("ticks");
        let took = (scene.board.now() - begin) / MS;
        assert!((10 * ms - 20..=10 * ms + 20).contains(&took), "{sample_time} s: 10 ticks took {took} ms");
        let status = scene.board.command("status").expect("answers");
        assert!(crate::is_punctual(&status), "{status}");
    }
}

/// As with 110 ms: heater_off.rs has the same times.
#[test]
fn the_heater_is_off_as_soon_whatever_the_sample_time_is() {
    for sample_time in ["0.05", "0.25", "1"] {
        let mut broken = heating(sample_time);
        broken.wire_sensor(1, 4095);
        broken.time_until_off(112 * MS).unwrap_or_else(|e| panic!("{sample_time} s, T1 broken: {e}"));
        let mut hot = heating(sample_time);
        hot.wire_sensor(2, 500);
        hot.time_until_off(112 * MS).unwrap_or_else(|e| panic!("{sample_time} s, too hot: {e}"));
        hot.board.run_for(2 * SECOND).expect("runs on");
        assert!(hot.board.logged("limit 75.0 degC"), "{sample_time} s: the log does not say why");
        let mut hung = heating(sample_time);
        inject::hang(&mut hung.board, "control").expect("hangs");
        hung.time_until_off(442 * MS).unwrap_or_else(|e| panic!("{sample_time} s, control hangs: {e}"));
    }
}
