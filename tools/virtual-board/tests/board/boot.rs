//! From power-up to the first ticks, on boards as they are sold and on boards that lack something.

use virtual_board::board::load;
use virtual_board::clock::Cause;
use virtual_board::gpio::Mode;
use virtual_board::inject;
use virtual_board::scene::Scene;
use virtual_board::scs::CPACR;
use virtual_board::time::{MS, SECOND};

fn powered_up() -> Scene {
    Scene::powered_up(load(None).expect("an image")).expect("powers up")
}

#[test]
fn boots_to_off_and_nothing_heats_before_it_is_armed() {
    let mut scene = powered_up();
    scene.board.run_for(10 * SECOND).expect("boots");
    let board = &mut scene.board;
    assert!(board.logged("on NUCLEO-F411RE") && board.logged("clock StLink"), "{:?}", board.log.first());
    assert!(board.logged("reset cause: power-on") && board.logged("settings defaults, nothing saved"));
    assert!(board.command("status").expect("answers").starts_with("mode off"));
    assert_eq!(board.chip().heater_log, [(0, 0.0)], "the heater's pin was never high");
    assert_eq!(board.chip().ports[0].mode(8), Mode::Alternate(1), "and its timer holds it low");
    assert_eq!(board.chip().scs.get(CPACR), 0xF0_0000, "FPU on");
    assert_eq!(board.resets, []);
    let complaints: Vec<_> =
        board.log.iter().filter(|line| line.level == "warn" || line.level == "error").collect();
    assert!(matches!(complaints[..], [only] if only.text.contains("brown-out level off")), "{complaints:?}");
}

#[test]
fn arms_to_settle() {
    let mut scene = powered_up();
    scene.board.run_for(SECOND).expect("boots");
    scene.arm().expect("arms");
    scene.board.run_for(SECOND).expect("runs on");
    assert!(scene.board.logged("off -> settle"));
    assert!(scene.board.heater() > 0.0);
}

#[test]
fn the_first_tick_is_due_a_period_after_the_start_and_the_grid_never_moves() {
    let mut scene = powered_up();
    scene.board.run_for(20 * SECOND).expect("boots");
    let ticks: Vec<_> = scene.board.log.iter().filter(|line| line.tick().is_some()).collect();
    assert!((180..=182).contains(&ticks.len()), "{}", ticks.len());
    for line in ticks {
        let record = line.tick().expect("a record");
        assert!(!record.missed() && record.late_us() <= 5, "{line}");
    }
}

#[test]
fn without_the_external_clock_it_runs_on_the_internal_one() {
    let mut scene = powered_up();
    scene.board.cpu.touch(|chip, _| chip.clocks.external = None);
    scene.board.run_for(2 * SECOND).expect("boots");
    assert!(scene.board.logged("clock Internal"));
    scene.arm().expect("arms");
    scene.board.run_for(5 * SECOND).expect("runs on");
    assert!(scene.board.heater() > 0.05);
    assert_eq!(scene.board.resets, []);
}

#[test]
fn any_watchdog_oscillator_of_the_data_sheet_will_do() {
    for hz in [17_000, 47_000] {
        let mut scene = powered_up();
        scene.board.cpu.touch(|chip, _| chip.watchdog.oscillator = hz);
        scene.board.run_for(30 * SECOND).expect("boots");
        assert_eq!(scene.board.resets, [], "{hz} Hz");
        let status = scene.board.command("status").expect("answers");
        assert!(!status.contains("locked out"), "{hz} Hz: {status}");
    }
}

#[test]
fn a_start_that_hangs_is_restarted_by_the_watchdog() {
    // At once, while its deadline is set, while clocks start, or before the first task runs; 8 s nominal. Before it nothing but memory is tested and set up.
    let at_once = (0..10).map(|i| i * MS / 10);
    for at in at_once.chain([5 * MS, 15 * MS]) {
        let mut scene = powered_up();
        let mut started = 0;
        while !scene.board.cpu.touch(|chip, _| chip.watchdog.is_started()) {
            started += MS / 10;
            assert!(started < 50 * MS, "no watchdog");
            scene.board.run_for(MS / 10).expect("boots");
        }
        scene.board.run_for(at).expect("boots");
        inject::spin(&mut scene.board).expect("hangs");
        scene.board.run_for(8100 * MS).expect("waits");
        let cause = scene.board.resets.first().map(|r| r.1);
        assert_eq!(
            cause,
            Some(Cause::Watchdog),
            "hung {} us after its start, {} us",
            at * 1000 / MS,
            started * 1000 / MS
        );
        // Before the flags are taken, that of power-up stands beside the watchdog's.
        assert!(at < MS || scene.board.logged("reset cause: watchdog"));
    }
}
