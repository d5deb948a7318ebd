//! Clocks that begin just before they wrap. TIM1 wraps each 50 us and TIM2 each 66 ms by themselves; TIM5 after 72 min; what
//! the program counts in 32 bits, after 72 min in microseconds and after 50 days in milliseconds.

use virtual_board::board::load;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, SECOND, US};

use crate::is_punctual;

fn powered_up() -> Scene {
    Scene::powered_up(load(None).expect("an image")).expect("powers up")
}

#[test]
fn the_tick_goes_on_when_its_timer_wraps() {
    // Before the first tick, between two, in the middle of a sample, on a due time, while the deadline watchdog lies ahead.
    for before in [1, 55_000, 110_000, 110_600, 111_000, 165_000, 440_000] {
        let mut scene = powered_up();
        scene.board.cpu.touch(|chip, _| chip.tim5.begins_at = u32::MAX - before);
        scene.board.run_for(600 * MS).expect("boots");
        scene.arm().expect("arms");
        scene.board.run_for(3 * SECOND).expect("runs on");
        let status = scene.board.command("status").expect("answers");
        assert!(is_punctual(&status), "{before} us before the wrap: {status}");
        assert!(scene.board.heater() > 0.0, "{before} us before the wrap");
        assert_eq!(scene.board.resets, []);
        let times = scene.board.log_times();
        assert!(times.is_sorted(), "{before} us before the wrap: the log's time goes back");
        assert!(times.last().is_some_and(|s| *s < 10.0 || *s > 4_294.967_296), "it has wrapped");
    }
}

#[test]
fn the_deadline_watchdog_cuts_across_a_wrap() {
    let mut scene = powered_up();
    scene.board.cpu.touch(|chip, _| chip.tim5.begins_at = u32::MAX - 3_000_000);
    scene.board.run_for(600 * MS).expect("boots");
    scene.arm().expect("arms");
    scene.board.run_for(2200 * MS).expect("runs on");
    assert!(scene.board.heater() > 0.0);
    scene.board.cpu.touch(|chip, _| chip.scs.nvic.enable(84, false)); // the control task's executor
    scene.time_until_off(441 * MS).expect("off");
    assert_eq!(scene.board.resets.len(), 1, "and the watchdog after it");
}

/// Periods of 2^15 us that embassy's clock has counted are in one of these words of its driver.
const DRIVER: &str = "embassy_stm32::time_driver::driver::DRIVER";
const DRIVER_WORDS: u32 = 6;
const PERIOD_US: u64 = 1 << 15;

/// Where the count of the periods is: the word that grows by one with each.
fn period_count() -> u32 {
    let mut scene = powered_up();
    let driver = scene.board.image.address(DRIVER).expect("embassy's clock");
    scene.board.run_for(100 * PERIOD_US * US).expect("boots");
    let counts = |address: &u32| scene.board.cpu.word(*address).is_ok_and(|n| (98..=100).contains(&n));
    let found: Vec<u32> = (0..DRIVER_WORDS).map(|i| driver + 4 * i).filter(counts).collect();
    assert_eq!(found.len(), 1, "words that may be the count of periods: {found:x?}");
    found[0]
}

#[test]
fn the_clock_of_the_other_tasks_goes_on_beyond_32_bits() {
    let count = period_count();
    let (microseconds, milliseconds) = (1 << 32, 1000 << 32);
    for limit in [microseconds, milliseconds] {
        let mut scene = powered_up();
        let board = &mut scene.board;
        while board.chip().tim2.count(board.now()) == 0 {
            board.run_for(5 * US).expect("boots");
        }
        // Some 3 s before the limit; even, for the counter is in its first half.
        board.cpu.set_word(count, (limit / PERIOD_US) as u32 - 92).expect("RAM");
        board.run_for(2 * SECOND).expect("boots");
        scene.arm().expect("arms");
        scene.board.run_for(6 * SECOND).expect("runs on");
        assert_eq!(scene.board.resets, []);
        let status = scene.board.command("status").expect("answers");
        assert!(is_punctual(&status) && status.contains("diagnosis lost 0, log dropped 0"), "{status}");
        assert!(scene.board.heater() > 0.0);
        assert!(scene.board.log_times().is_sorted(), "the log has a clock of its own");
        // The status task, which sleeps by this clock, says a line each second.
        let told =
            scene.board.log.iter().filter(|line| line.level == "info" && line.text.contains(" T0 ")).count();
        assert!((7..=8).contains(&told), "{told} lines in 8 s");
    }
}
