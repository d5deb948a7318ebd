//! What leaves the chip at the pins of heater and contactor: the program's will, whatever is soldered to them, and what
//! the timer's lock keeps of it when something writes where it should not.

use virtual_board::board::{Board, load};
use virtual_board::gpio::Mode;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, Ps, SECOND};
use virtual_board::wiring::Pull;

const PULLS: [Pull; 3] = [Pull::Down, Pull::Up, Pull::None];
/// Registers of TIM1.
const CR2: u32 = 0x04;
const CCMR1: u32 = 0x18;
const CCMR2: u32 = 0x1C;
const CCER: u32 = 0x20;
const BDTR: u32 = 0x44;
const MOE: u32 = 1 << 15;

fn heating() -> Scene {
    Scene::heating(load(None).expect("an image")).expect("heats")
}

fn solder(board: &mut Board, pull: Pull) {
    board.cpu.touch(|chip, now| {
        (chip.wiring.heater, chip.wiring.contactor) = (pull, pull);
        chip.settle(now);
    });
}

/// Both pins are low because something drives them so.
#[track_caller]
fn is_driven_low(board: &Board, what: &str) {
    assert_eq!(board.chip().pins_are_driven(), [true; 2], "{what}: who drives heater and contactor");
    assert_eq!((board.heater(), board.contactor()), (0.0, 0.0), "{what}: heater and contactor");
}

fn tim1(board: &mut Board, register: u32) -> u32 {
    board.cpu.touch(|chip, now| chip.tim1.read(register, now)).expect("a register")
}

/// Writes to a register of TIM1 from outside, as a program gone wild would.
fn write_astray(board: &mut Board, register: u32, value: u32) {
    board.cpu.touch(|chip, now| {
        chip.tim1.write(register, value, now).expect("modelled");
        chip.settle(now);
    });
}

#[test]
fn after_the_start_no_pin_is_left_to_what_pulls_it() {
    for pull in PULLS {
        let mut scene = Scene::powered_up(load(None).expect("an image")).expect("powers up");
        solder(&mut scene.board, pull);
        scene.board.run_for(SECOND).expect("boots");
        is_driven_low(&scene.board, "at rest");
        // The first 50 ms belong to the resistors: clocks start, settings are read.
        for log in [&scene.board.chip().heater_log, &scene.board.chip().contactor_log] {
            assert!(log.iter().all(|(at, high)| *high == 0.0 || *at < 50 * MS), "{pull:?}: {log:?}");
        }
        scene.arm().expect("arms");
        scene.board.run_for(5 * SECOND).expect("runs on");
        assert!((0.05..0.95).contains(&scene.board.heater()), "{pull:?}: {}", scene.board.heater());
        scene.board.command("stop").expect("answers");
        is_driven_low(&scene.board, "stopped");
        scene.board.run_for(SECOND).expect("runs on");
        scene.arm().expect("arms");
        scene.board.run_for(SECOND).expect("runs on");
        scene.board.interlock(false);
        is_driven_low(&scene.board, "interlock open");
    }
}

#[test]
fn the_contactor_is_closed_while_armed_and_opens_with_the_heater() {
    let mut scene = heating();
    assert_eq!(scene.board.contactor(), 1.0);
    scene.board.interlock(false);
    assert_eq!(scene.board.contactor(), 0.0, "hardware does not wait for the program");
    scene.board.interlock(true);
    scene.board.run_for(SECOND).expect("runs on");
    is_driven_low(&scene.board, "a closed interlock brings nothing back");
    let closed = scene.board.chip().contactor_log.last().copied();
    assert_eq!(closed.map(|(_, high)| high), Some(0.0));
}

#[test]
fn nothing_is_enabled_before_it_is_armed_or_after_it_was_switched_off() {
    let mut scene = Scene::powered_up(load(None).expect("an image")).expect("powers up");
    for ms in 0..400 {
        scene.board.run_for(MS).expect("boots");
        assert_eq!(tim1(&mut scene.board, BDTR) & MOE, 0, "{ms} ms after power-up");
    }
    scene.arm().expect("arms");
    scene.board.run_for(SECOND).expect("runs on");
    assert_eq!(tim1(&mut scene.board, BDTR) & MOE, MOE, "armed");
    scene.board.command("stop").expect("answers");
    assert_eq!(tim1(&mut scene.board, BDTR) & MOE, 0, "stopped");
    scene.arm().expect("arms");
    scene.board.run_for(SECOND).expect("runs on");
    scene.wire_sensor(1, 4095);
    scene.board.run_for(200 * MS).expect("trips");
    assert_eq!(tim1(&mut scene.board, BDTR) & MOE, 0, "tripped");
}

#[test]
fn a_closed_interlock_does_not_bring_the_heater_back() {
    for open in [MS, 300 * MS] {
        let mut scene = heating();
        scene.board.interlock(false);
        scene.board.run_for(open).expect("runs on");
        scene.board.interlock(true);
        let closed = scene.board.now();
        scene.board.run_for(2 * SECOND).expect("runs on");
        assert!(scene.board.heater_off_since().is_some_and(|off| off < closed), "open for {} ms", open / MS);
    }
}

/// Writes that would undo what keeps the heater off: register, bits to set, bits to clear, what for.
const ASTRAY: [(u32, u32, u32, &str); 10] = [
    (BDTR, 0, 1 << 12, "break input off"),
    (BDTR, 0, 1 << 13, "break polarity"),
    (BDTR, 0, 1 << 10, "pins released when off"),
    (BDTR, 0, 1 << 11, "channels released when off"),
    (BDTR, 1 << 14, 0, "on again by itself"),
    (BDTR, 0, 3 << 8, "lock"),
    (CR2, 1 << 8 | 1 << 12, 0, "idle levels high"),
    (CCER, 1 << 1 | 1 << 9, 0, "polarities"),
    (CCMR1, 5 << 4, 7 << 4, "heater forced high"),
    (CCMR2, 5 << 4, 7 << 4, "contactor forced high"),
];

#[test]
fn a_stray_write_to_the_timer_undoes_no_protection() {
    let mut scene = heating();
    let board = &mut scene.board;
    for (register, set, clear, what) in ASTRAY {
        let before = tim1(board, register);
        write_astray(board, register, before & !clear | set);
        assert_eq!(tim1(board, register), before, "{what}");
    }
    board.run_for(SECOND).expect("runs on");
    assert!((0.05..0.95).contains(&board.heater()), "{}", board.heater());
    solder(board, Pull::Up);
    board.interlock(false);
    is_driven_low(board, "interlock open after all of them");
    board.interlock(true);
    board.run_for(MS).expect("runs on");
    is_driven_low(board, "interlock closed again");
}

#[test]
fn a_stray_write_to_the_port_takes_no_pin_from_the_timer() {
    /// Registers of port A, and values that would make heater, contactor and break input plain pins, the first two high.
    const MODER: u32 = 0x00;
    const PUPDR: u32 = 0x0C;
    const ODR: u32 = 0x14;
    const AFRL: u32 = 0x20;
    const AFRH: u32 = 0x24;
    let mut scene = heating();
    scene.board.command("stop").expect("answers");
    scene.board.run_for(SECOND).expect("runs on");
    scene.board.cpu.touch(|chip, now| {
        let writes = [(MODER, 1 << 16 | 1 << 20), (PUPDR, 0), (AFRL, 0), (AFRH, 0), (ODR, 1 << 8 | 1 << 10)];
        for (register, value) in writes {
            chip.ports[0].write(register, value).expect("modelled");
        }
        chip.settle(now);
    });
    is_driven_low(&scene.board, "stopped");
    assert_eq!(scene.board.chip().ports[0].mode(6), Mode::Alternate(1), "the break input");
}

#[test]
fn a_stray_enable_while_off_heats_nothing() {
    type End = fn(&mut Scene);
    let ends: [(&str, End); 2] = [
        ("stopped", |scene| drop(scene.board.command("stop").expect("answers"))),
        ("tripped", |scene| scene.wire_sensor(1, 4095)),
    ];
    for (what, end) in ends {
        let mut scene = heating();
        end(&mut scene);
        scene.board.run_for(SECOND).expect("runs on");
        // The main output enable is not locked; behind it there must be nothing to come out, for as long as it lasts.
        let bdtr = tim1(&mut scene.board, BDTR);
        write_astray(&mut scene.board, BDTR, bdtr | MOE);
        is_driven_low(&scene.board, what);
        scene.board.run_for(MS).expect("runs on");
        is_driven_low(&scene.board, what);
        scene.board.run_for(150 * MS).expect("runs on");
        assert_eq!(tim1(&mut scene.board, BDTR) & MOE, 0, "{what}: cleared by the next tick");
    }
}

#[test]
fn a_channel_that_a_stray_write_switches_off_is_driven_low() {
    let mut scene = heating();
    solder(&mut scene.board, Pull::Up);
    // Both channels off and their complements on, which OSSR answers with the inactive level.
    write_astray(&mut scene.board, CCER, 1 << 2 | 1 << 10);
    is_driven_low(&scene.board, "channels off");
}

/// TIM1 counts 5000 steps of 10 ns a period.
const STEP: Ps = 10_000;
const STEPS: Ps = 5000;

#[test]
fn a_new_power_begins_with_a_period_of_the_pwm() {
    let scene = heating();
    let (chip, now) = (scene.board.chip(), scene.board.now());
    let here = Ps::from(chip.tim1.count(now));
    let log = &chip.heater_log;
    let changes: Vec<Ps> = log.windows(2).filter(|w| w[0].1 > 0.0 && w[1].1 > 0.0).map(|w| w[1].0).collect();
    assert!(changes.len() > 20, "{} changes", changes.len());
    for at in changes {
        let ago = (now - at) / STEP;
        // A power that took effect as it is written would come 3.8 us after the beginning.
        let step = (here + STEPS - ago % STEPS) % STEPS;
        assert!((step + 2) % STEPS < 4, "{} us: at step {step} of {STEPS}", at / 1_000_000);
    }
}

#[test]
fn a_timer_that_a_stray_write_stops_while_its_pin_is_high_goes_on_with_the_next_tick() {
    const ARPE: u32 = 1 << 7;
    let mut scene = heating();
    while scene.board.chip().tim1.count(scene.board.now()) > 100 {
        scene.board.run_for(50 * STEP).expect("runs on");
    }
    write_astray(&mut scene.board, 0, ARPE);
    assert_eq!(scene.board.heater(), 1.0, "nothing locks the counter");
    scene.board.run_for(112 * MS).expect("runs on");
    assert!(scene.board.heater() < 1.0, "stands still at full power");
}
