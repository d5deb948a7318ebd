//! A clock of another speed than it should have: at the start it is not used, and while it runs it is seen by the oscillator of the watchdog.

use virtual_board::board::{Board, load};
use virtual_board::scene::Scene;
use virtual_board::time::{MS, Ps, SECOND, US};

/// Slowest, typical and fastest oscillator of the watchdog by the data sheet, Hz.
const OSCILLATORS: [u64; 3] = [17_000, 32_000, 47_000];
/// The ST-LINK's clock, Hz.
const RIGHT: u64 = 8_000_000;
/// A tick and its sample, by the clock of the board.
const ONE_TICK: Ps = 112 * MS;

fn powered_up(oscillator: u64, external: u64) -> Scene {
    let mut scene = Scene::powered_up(load(None).expect("an image")).expect("powers up");
    scene.board.cpu.touch(|chip, _| {
        chip.watchdog.oscillator = oscillator;
        chip.clocks.external = Some(external);
    });
    scene.board.run_for(SECOND).expect("boots");
    scene
}

fn heating(oscillator: u64) -> Scene {
    Scene::heating_with(load(None).expect("an image"), oscillator).expect("heats")
}

fn set_external(board: &mut Board, hz: u64) {
    board.cpu.touch(|chip, now| chip.set_external_clock(hz, now));
}

#[test]
fn a_crystal_that_changes_its_speed_while_it_heats_switches_off_within_a_tick_or_two_of_that_speed() {
    for oscillator in OSCILLATORS {
        // Faster than the last is too fast for the converter.
        for hz in [1_000_000, RIGHT / 2, 11_400_000] {
            let mut scene = heating(oscillator);
            set_external(&mut scene.board, hz);
            // A sample by a faster clock may be over before a slow oscillator is measured: then the next one says so.
            let ticks = if hz > RIGHT { 2 } else { 1 };
            scene
                .time_until_off(ticks * ONE_TICK * RIGHT / hz)
                .unwrap_or_else(|e| panic!("{hz} Hz, oscillator {oscillator} Hz: {e}"));
        }
    }
}

#[test]
fn a_wrong_clock_is_told_and_needs_an_acknowledgement() {
    let mut scene = heating(32_000);
    set_external(&mut scene.board, RIGHT / 2);
    scene.time_until_off(2 * ONE_TICK).expect("off");
    set_external(&mut scene.board, RIGHT); // else the port does not understand us
    scene.board.run_for(SECOND).expect("runs on");
    assert!(scene.board.logged("the clock runs at a wrong speed, by the oscillator of the watchdog"));
    let mut say = |line: &str| scene.board.command(line).expect("answers");
    assert!(say("status").contains("locked out: the clock runs at a wrong speed"));
    assert!(say("arm").contains("ack"));
    assert_eq!(say("ack"), "ok");
    scene.arm().expect("arms after the acknowledgement");
}

/// The oscillator goes astray here, or stands still, so that the port goes on to understand us.
#[test]
fn no_acknowledgement_helps_while_they_disagree() {
    for oscillator in [1, 17_000, 47_000] {
        let mut scene = heating(if oscillator == 17_000 { 32_000 } else { 24_000 });
        scene.board.cpu.touch(|chip, _| chip.watchdog.oscillator = oscillator);
        scene.time_until_off(2 * ONE_TICK).expect("off");
        scene.board.run_for(SECOND).expect("runs on");
        scene.board.cpu.touch(|chip, _| chip.heater_log.clear());
        for _ in 0..3 {
            assert_eq!(scene.board.command("ack").expect("answers"), "ok");
            let _ = scene.arm();
            scene.board.run_for(SECOND).expect("runs on");
        }
        let heated = scene.board.chip().heater_log.iter().filter(|(_, power)| *power > 0.0).count();
        assert_eq!(heated, 0, "{oscillator} Hz");
    }
}

#[test]
fn an_external_clock_that_is_wrong_from_the_start_is_not_used() {
    for oscillator in OSCILLATORS {
        for hz in [1_000_000, RIGHT / 2, 2 * RIGHT, 25_000_000] {
            let mut scene = powered_up(oscillator, hz);
            assert!(scene.board.logged("clock InternalForWrongClock"), "{hz} Hz, oscillator {oscillator} Hz");
            assert!(scene.board.logged("the external clock is not 8 MHz, and not used"));
            scene.arm().expect("arms");
            scene.board.run_for(SECOND).expect("runs on");
            assert!(scene.board.heater() > 0.0, "{hz} Hz, oscillator {oscillator} Hz");
        }
    }
}

#[test]
fn an_oscillator_of_the_data_sheet_that_drifts_is_no_wrong_clock() {
    for oscillator in OSCILLATORS {
        let mut scene = heating(oscillator);
        assert!(scene.board.logged("clock StLink"));
        for percent in [95, 90, 100, 110] {
            scene.board.cpu.touch(|chip, _| chip.watchdog.oscillator = oscillator * percent / 100);
            scene.board.run_for(SECOND).expect("runs on");
            assert!(scene.board.heater() > 0.0, "{percent} % of {oscillator} Hz");
        }
        assert_eq!(scene.board.resets, []);
    }
}

/// Erasing a sector of the flash stalls the core, perhaps in the middle of a measurement; to that, a debugger is the same.
#[test]
fn edges_that_are_lost_while_the_core_stands_are_no_wrong_clock() {
    const CCER: u32 = 0x20;
    let is_measuring = |board: &mut Board| {
        board.cpu.touch(|chip, now| chip.tim5.read(CCER, now).expect("a register")) & 1 << 12 != 0
    };
    for oscillator in OSCILLATORS {
        let mut scene = powered_up(oscillator, RIGHT);
        let board = &mut scene.board;
        let span = 8 * SECOND / oscillator;
        for capture in 0..2 {
            board.run_until("a measurement", SECOND, |board| !is_measuring(board)).expect("runs on");
            while !is_measuring(board) {
                board.run_for(10 * US).expect("runs on");
            }
            board.run_for(span / 2 + span * capture).expect("runs on");
            assert!(is_measuring(board));
            board.halt(5 * MS).expect("halts");
            board.run_for(SECOND).expect("runs on");
            let status = board.command("status").expect("answers");
            assert!(!status.contains("locked out"), "{oscillator} Hz, after {capture}: {status}");
        }
    }
}
