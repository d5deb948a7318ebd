//! A board that takes its codes from the port: it is the whole instrument, and nothing of it reaches the pins.

use std::io::{self, ErrorKind, Read, Write};

use fdi_core::{AdcCode, RawSample};
use firmware_logic::stream::codes::Codes;
use firmware_logic::stream::frame;
use pt326::commands::board::verify;
use pt326_host::board::Session;
use pt326_host::board::simulate::SimulatedRig;
use pt326_host::experiment::scenario::Scenario;
use pt326_rig::Rig;
use virtual_board::board::{Board, load};
use virtual_board::clock::Cause;
use virtual_board::closed_loop::TICK;
use virtual_board::scene::{Scene, WAIVE_CHECK};
use virtual_board::time::{MS, SECOND};

/// The port of a board whose time passes while somebody reads.
struct Wire<'a>(&'a mut Board);

impl Read for Wire<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        for _ in 0..20 {
            self.0.run_for(MS).map_err(io::Error::other)?;
            let sent = self.0.take_terminal();
            if !sent.is_empty() {
                let n = sent.len();
                bytes[..n].copy_from_slice(sent.as_bytes());
                return Ok(n);
            }
        }
        Err(ErrorKind::TimedOut.into())
    }
}

impl Write for Wire<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.send(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn at_rest() -> Scene {
    Scene::at_rest(load(None).expect("an image")).expect("boots")
}

/// Neither pin was ever high, and something drives both low.
fn is_locked_off(board: &Board) {
    let chip = board.chip();
    assert!(chip.heater_log.iter().chain(&chip.contactor_log).all(|(_, high)| *high == 0.0));
    assert_eq!(chip.pins_are_driven(), [true; 2]);
}

/// Armed, with a rig beside it, for ten seconds.
fn armed(scene: &mut Scene) {
    let scenario = Scenario::default();
    let rig = SimulatedRig::new(Rig::new(&scenario.rig, scenario.disturbance, 0.11, 1, &[]));
    let mut session = Session::over(Wire(&mut scene.board)).expect("answers");
    session.simulate(rig.clone());
    session.order("simulate on").expect("starts anew");
    session.order(WAIVE_CHECK).expect("waived");
    session.order("arm").expect("arms");
    (0..1000).for_each(|_| drop(session.hear().expect("hears")));
    let status = session.order("status").expect("answers");
    assert!(status.starts_with("SIMULATED: ") && status.contains("mode settle"), "{status}");
    assert!(!status.contains("heater 0.0 %"), "{status}");
    assert_eq!(rig.unseen(), 0);
}

#[test]
fn the_experiment_on_the_bare_board_has_the_hosts_words() {
    let mut scene = at_rest();
    scene.board.interlock(true);
    let mut session = Session::over(Wire(&mut scene.board)).expect("answers");
    let found = verify(&mut session, Some(200.0), |_, _| ()).expect("verifies");
    assert!(found.passed, "{}", found.report);
    for word in [
        "PT-326 FDI",
        "on NUCLEO-F411RE, 100000000 Hz",
        "on all 18",
        "ticks missed 0",
        "second half  median ",
    ] {
        assert!(found.report.contains(word), "{word} in:\n{}", found.report);
    }
    assert!(!scene.board.command("status").expect("answers").contains("SIMULATED"), "it ends as a board");
    is_locked_off(&scene.board);
}

#[test]
fn nothing_reaches_the_pins_whatever_is_armed() {
    let mut scene = at_rest();
    armed(&mut scene);
    is_locked_off(&scene.board);
    // A program gone wild gives the pins to the timer.
    const MODER: u32 = 0;
    scene.board.cpu.touch(|chip, now| {
        let mode = chip.ports[0].read(MODER).expect("a register");
        let alternate = mode & !(3 << 16 | 3 << 20) | 2 << 16 | 2 << 20;
        chip.ports[0].write(MODER, alternate).expect("modelled");
        chip.settle(now);
    });
    scene.board.run_for(SECOND).expect("runs on");
    is_locked_off(&scene.board);
}

#[test]
fn without_codes_it_trips() {
    let mut scene = at_rest();
    armed(&mut scene);
    scene.board.run_for(SECOND).expect("runs on");
    scene.board.send(b"stream off\r");
    scene.board.run_for(SECOND).expect("runs on");
    assert!(scene.board.command("status").expect("answers").contains("mode tripped"));
}

/// They are for the tick before, each time.
#[test]
fn with_codes_that_come_late_it_trips() {
    let mut scene = at_rest();
    armed(&mut scene);
    scene.board.command("stream off").expect("answers");
    for _ in 0..12 {
        let last = scene.board.log.iter().rev().find_map(|line| line.tick()).expect("a tick");
        // They move a little, as noise does: a T1 that stands still would trip, too.
        let t1 = AdcCode(1700.0 + (last.tick() % 3) as f32);
        let raw = RawSample { t0: AdcCode(2160.0), t1, t2: AdcCode(1800.0), supply: AdcCode(0.0) };
        let late = Codes { tick: last.tick(), raw };
        let mut frame = String::new();
        frame::write(&late, &mut frame).expect("there is room");
        scene.board.send(frame.as_bytes());
        scene.board.run_for(TICK).expect("runs on");
    }
    assert!(scene.board.command("status").expect("answers").contains("mode tripped"));
}

#[test]
fn any_reset_ends_it() {
    let mut scene = at_rest();
    armed(&mut scene);
    scene.board.reset(Cause::Pin).expect("resets");
    scene.board.run_for(SECOND).expect("starts");
    let status = scene.board.command("status").expect("answers");
    assert!(!status.contains("SIMULATED") && status.contains("T1 22."), "{status}");
}

#[test]
fn it_begins_with_the_heater_off_only_and_a_board_that_is_not_simulated_believes_no_codes() {
    let mut scene = Scene::heating(load(None).expect("an image")).expect("heats");
    assert!(
        scene
            .board
            .command("simulate on")
            .expect("answers")
            .starts_with("error: not while the heater may be on")
    );
    let before = scene.board.command("status").expect("answers");
    for tick in 0..200 {
        let mut codes = String::new();
        let raw = fdi_core::RawSample::default();
        frame::write(&Codes { tick, raw }, &mut codes).expect("room");
        scene.board.send(codes.as_bytes());
    }
    scene.board.run_for(5 * SECOND).expect("runs on");
    let status = scene.board.command("status").expect("answers");
    assert!(before.contains("mode settle") && status.contains("mode settle"), "{status}");
    assert!(scene.board.heater() > 0.05);
}
