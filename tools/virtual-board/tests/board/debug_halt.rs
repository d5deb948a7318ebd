//! What a debugger's halt leaves behind: a hold with its name, missed ticks, no reset; at rest nothing.

use virtual_board::board::load;
use virtual_board::clock::Cause;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, Ps, SECOND, US};

fn heating() -> Scene {
    Scene::heating(load(None).expect("an image")).expect("heats")
}

/// From a single step to a coffee break; the longest is three times the deadline of the watchdog.
const HALTS: [Ps; 6] = [20 * US, MS, 50 * MS, 300 * MS, SECOND, 30 * SECOND];

#[test]
fn a_halt_of_any_length_cuts_and_holds() {
    for halt in HALTS {
        let mut scene = heating();
        let name = format!("{} us", halt / US);
        scene.board.halt(halt).expect("stands still");
        scene.board.run_for(112 * MS).expect("runs on");
        assert_eq!((scene.board.heater(), scene.board.contactor()), (0.0, 0.0), "{name}: on again");
        scene.board.run_for(300 * MS).expect("runs on");
        assert_eq!(scene.board.resets, [], "{name}: the watchdog has bitten");
        let refusal = scene.board.command("arm").expect("answers");
        assert!(refusal.contains("halted"), "{name}: {refusal}");
        assert_eq!(scene.board.command("ack").expect("answers"), "ok", "{name}");
        scene.arm().expect("arms after the acknowledgement");
    }
}

#[test]
fn a_halt_past_the_deadline_never_heats_again() {
    let mut scene = heating();
    scene.board.halt(600 * MS).expect("stands still");
    let resumed = scene.board.now();
    scene.board.run_for(SECOND).expect("runs on");
    let again = scene.board.chip().heater_log.iter().filter(|(at, _)| *at > resumed + 2 * US);
    assert!(again.clone().all(|(_, power)| *power == 0.0), "{:?}", again.collect::<Vec<_>>());
    let status = scene.board.command("status").expect("answers");
    let missed = status.split(" missed ").nth(1).and_then(|rest| rest.split(' ').next()?.parse::<u32>().ok());
    assert!(missed.is_some_and(|n| (4..=5).contains(&n)), "five ticks were due meanwhile: {status}");
}

#[test]
fn a_halt_at_rest_holds_nothing() {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("boots");
    scene.board.halt(2 * SECOND).expect("stands still");
    scene.board.run_for(500 * MS).expect("runs on");
    scene.arm().expect("arms");
    scene.board.run_for(SECOND).expect("runs on");
    assert!(scene.board.heater() > 0.0);
}

#[test]
fn a_halt_beyond_half_a_wrap_of_the_tick_timer_ends_in_a_reset() {
    let mut scene = heating();
    scene.board.halt(40 * 60 * SECOND).expect("stands still");
    scene.board.run_for(3 * SECOND).expect("restarts");
    assert_eq!(scene.board.resets.last().map(|r| r.1), Some(Cause::Watchdog));
    assert_eq!((scene.board.heater(), scene.board.contactor()), (0.0, 0.0));
    let refusal = scene.board.command("arm").expect("answers");
    assert!(refusal.contains("ack"), "{refusal}");
}
