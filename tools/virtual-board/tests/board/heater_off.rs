//! Whatever goes wrong while it heats, the heater's pin goes low, within the times of docs/safety.md.

use std::rc::Rc;

use virtual_board::board::load;
use virtual_board::chip::Chip;
use virtual_board::clock::Cause;
use virtual_board::image::Image;
use virtual_board::inject::{self, TASKS};
use virtual_board::registers::Refusal;
use virtual_board::scene::Scene;
use virtual_board::time::{MS, Ps, US};

fn image() -> Rc<Image> {
    load(None).expect("an image")
}

fn heating() -> Scene {
    Scene::heating(image()).expect("heats")
}

/// Nothing but an acknowledgement brings the heater back, and that does.
#[track_caller]
fn needs_acknowledgement(scene: &mut Scene) {
    let board = &mut scene.board;
    board.run_for(400 * MS).expect("runs on");
    let refusal = board.command("arm").expect("answers");
    assert!(refusal.contains("ack") || refusal.contains("mode tripped"), "armed without `ack`: {refusal}");
    board.run_for(1000 * MS).expect("runs on");
    assert_eq!(board.heater(), 0.0, "heats without acknowledgement");
    assert_eq!(board.contactor(), 0.0, "the contactor closes without acknowledgement");
    scene.rig.0.borrow_mut().overrides = [None; 3];
    scene.board.interlock(true);
    scene.board.run_for(2000 * MS).expect("runs on");
    assert_eq!(scene.board.command("ack").expect("answers"), "ok");
    scene.arm().expect("arms after the acknowledgement");
    scene.board.run_for(1000 * MS).expect("runs on");
    assert!(scene.board.heater() > 0.0);
}

/// A sample is taken each 110 ms and acted on 1.3 ms later.
const ONE_TICK: Ps = 112 * MS;

#[test]
fn t1_broken() {
    let mut scene = heating();
    scene.wire_sensor(1, 4095);
    scene.time_until_off(ONE_TICK).expect("off");
    needs_acknowledgement(&mut scene);
}

#[test]
fn t1_shorted() {
    let mut scene = heating();
    scene.wire_sensor(1, 0);
    scene.time_until_off(ONE_TICK).expect("off");
    needs_acknowledgement(&mut scene);
}

#[test]
fn too_hot() {
    // 87 degC; 200 degC, which is no longer plausible; the rail.
    for (sensor, code) in [(1, 500), (2, 500), (2, 30), (2, 0)] {
        let mut scene = heating();
        scene.wire_sensor(sensor, code);
        scene.time_until_off(ONE_TICK).unwrap_or_else(|e| panic!("T{sensor} at {code}: {e}"));
        scene.board.run_for(MS).expect("runs on");
        assert!(scene.board.logged("limit 75.0 degC"), "T{sensor}: the log does not say the limit");
        needs_acknowledgement(&mut scene);
    }
}

/// Announced on the console: no air, no heat.
#[test]
fn the_fan_is_announced_to_stand_still() {
    let mut scene = heating();
    assert_eq!(scene.board.command("fan 80").expect("answers"), "ok");
    assert!(scene.board.heater() > 0.0, "less air is enough");
    assert_eq!(scene.board.command("fan 0").expect("answers"), "ok");
    scene.time_until_off(0).expect("off with the answer");
    for order in ["ack", "arm"] {
        let refusal = scene.board.command(order).expect("answers");
        assert!(refusal.starts_with("error: "), "{order}: {refusal}");
    }
    assert_eq!(scene.board.command("fan 100").expect("answers"), "ok");
    needs_acknowledgement(&mut scene);
}

/// T1 reads the room beside a T2 that reads the air.
#[test]
fn t1_out_of_the_tube() {
    let mut scene = heating();
    scene.board.run_for(5000 * MS).expect("runs on"); // until there is something to contradict
    scene.wire_sensor(1, 2160);
    scene.time_until_off(5000 * MS).expect("off");
    scene.board.run_for(MS).expect("runs on");
    assert!(scene.board.logged("much power, and T1 has not risen"), "the log does not say why");
    needs_acknowledgement(&mut scene);
}

#[test]
fn break_input() {
    let mut scene = heating();
    scene.board.interlock(false);
    assert_eq!(scene.board.heater(), 0.0, "hardware does not wait for the program");
    scene.time_until_off(US).expect("off");
    scene.board.run_for(200 * MS).expect("runs on");
    assert!(scene.board.command("status").expect("answers").contains("interlock"));
    needs_acknowledgement(&mut scene);
}

#[test]
fn an_open_interlock_keeps_it_from_arming() {
    let mut scene = Scene::at_rest(image()).expect("boots");
    scene.board.interlock(false);
    let answer = scene.board.command("arm").expect("answers");
    assert!(answer.contains("interlock"), "{answer}");
    scene.board.run_for(500 * MS).expect("runs on");
    assert_eq!(scene.board.heater(), 0.0);
}

#[test]
fn panic_in_each_task() {
    for task in TASKS {
        let mut scene = heating();
        inject::panic(&mut scene.board, task).expect(task);
        scene.time_until_off(100 * US).unwrap_or_else(|e| panic!("{task}: {e}"));
        scene.board.run_for(500 * MS).expect("restarts");
        assert!(scene.board.resets.iter().any(|(_, cause)| *cause == Cause::Software), "{task}");
        assert!(scene.board.logged("crash record: injected:7"), "{task}");
        assert!(scene.board.logged("reset cause: panic"), "{task}");
        needs_acknowledgement(&mut scene);
    }
}

#[test]
fn hard_fault_in_each_task() {
    for task in TASKS {
        for (what, fault) in
            [("wild jump", inject::run_wild as fn(&mut _, &str) -> _), ("undefined", inject::undefined)]
        {
            let mut scene = heating();
            fault(&mut scene.board, task).expect(task);
            scene.time_until_off(100 * US).unwrap_or_else(|e| panic!("{what} in {task}: {e}"));
            scene.board.run_for(500 * MS).expect("restarts");
            assert!(scene.board.logged("reset cause: HardFault"), "{what} in {task}");
            assert!(scene.board.logged("crash record: pc 0x"), "{what} in {task}");
            needs_acknowledgement(&mut scene);
        }
    }
}

#[test]
fn stack_overflow_in_thread_and_in_interrupt() {
    for task in ["console", "control"] {
        let mut scene = heating();
        inject::overflow_stack(&mut scene.board, task).expect(task);
        scene.time_until_off(MS).unwrap_or_else(|e| panic!("{task}: {e}"));
        scene.board.run_for(500 * MS).expect("restarts");
        assert!(scene.board.logged("stack overflow"), "{task}");
        needs_acknowledgement(&mut scene);
    }
}

/// The deadline watchdog: 4 periods after the last completed tick was due.
const DEADLINE: Ps = 4 * 110 * MS + MS;

#[test]
fn control_task_hangs() {
    // A watchdog on its slowest oscillator bites after 753 ms: then it is the deadline watchdog that cuts.
    for oscillator in [17_000, 32_000] {
        let mut scene = Scene::heating_with(image(), oscillator).expect("heats");
        inject::hang(&mut scene.board, "control").expect("hangs");
        scene.time_until_off(DEADLINE).unwrap_or_else(|e| panic!("{oscillator} Hz: {e}"));
        scene.board.run_for(2000 * MS).expect("the watchdog restarts it");
        assert_eq!(scene.board.resets.last().map(|r| r.1), Some(Cause::Watchdog));
        needs_acknowledgement(&mut scene);
    }
}

#[test]
fn control_task_is_never_polled() {
    let mut scene = heating();
    let begin = scene.board.now();
    inject::silence(&mut scene.board, "control", 1200 * MS).expect("runs on");
    let off = scene.board.heater_off_since().expect("off");
    assert!(off - begin <= DEADLINE, "off after {} ms", (off - begin) / MS);
    scene.board.run_for(1000 * MS).expect("restarts");
    assert_eq!(scene.board.resets.last().map(|r| r.1), Some(Cause::Watchdog));
    needs_acknowledgement(&mut scene);
}

/// Number of the interrupt on which the control task's executor runs, and of the timer that wakes it.
const SPI4: u16 = 84;
const TIM5: u16 = 50;

#[test]
fn control_interrupt_disabled() {
    let mut scene = heating();
    scene.board.cpu.touch(|chip, _| chip.scs.nvic.enable(SPI4, false));
    scene.time_until_off(DEADLINE).expect("off");
}

#[test]
fn tick_interrupt_disabled() {
    let mut scene = heating();
    scene.board.cpu.touch(|chip, _| chip.scs.nvic.enable(TIM5, false));
    scene.time_until_off(1100 * MS).expect("the watchdog takes it off");
    assert_eq!(scene.board.resets.last().map(|r| r.1), Some(Cause::Watchdog));
}

#[test]
fn clocks_of_the_tasks_stop() {
    type Stop = fn(&mut Chip, Ps) -> Result<(), Refusal>;
    let clocks: [(&str, Stop, Ps); 2] = [
        ("TIM5", |chip, now| chip.tim5.write(0, 0, now), 1100 * MS),
        ("TIM2", |chip, now| chip.tim2.write(0, 0, now), 810 * MS),
    ];
    for (name, stop, limit) in clocks {
        let mut scene = heating();
        scene.board.cpu.touch(stop).expect("its control register");
        scene.time_until_off(limit).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(scene.board.resets.last().map(|r| r.1), Some(Cause::Watchdog), "{name}");
        needs_acknowledgement(&mut scene);
    }
}

/// Deadline of each task in docs/safety.md, to which the watchdog's 0.81 s are added.
const OTHER_TASKS: [(&str, Ps); 4] = [("diagnosis", 250), ("console", 500), ("status", 1500), ("panel", 250)];

#[test]
fn other_tasks_hang() {
    for (task, _) in OTHER_TASKS {
        let mut scene = heating();
        inject::hang(&mut scene.board, task).expect(task);
        // A task that spins starves all of thread mode, and with it the watchdog's.
        scene.time_until_off(810 * MS).unwrap_or_else(|e| panic!("{task}: {e}"));
        assert_eq!(scene.board.resets.last().map(|r| r.1), Some(Cause::Watchdog), "{task}");
        needs_acknowledgement(&mut scene);
    }
}

#[test]
fn other_tasks_fall_silent() {
    for (task, deadline) in OTHER_TASKS {
        let mut scene = heating();
        let begin = scene.board.now();
        inject::silence(&mut scene.board, task, 4000 * MS).expect(task);
        let off = scene.board.heater_off_since().unwrap_or_else(|| panic!("{task}: still on"));
        let limit = (deadline + 810) * MS;
        assert!(off - begin <= limit, "{task}: off after {} ms", (off - begin) / MS);
        assert_eq!(scene.board.resets.last().map(|r| r.1), Some(Cause::Watchdog), "{task}");
        needs_acknowledgement(&mut scene);
    }
}

#[test]
fn all_interrupts_masked_for_ever() {
    for oscillator in [17_000, 32_000, 47_000] {
        let mut scene = Scene::heating_with(image(), oscillator).expect("heats");
        inject::hang_masked(&mut scene.board, "panel").expect("hangs");
        scene.time_until_off(810 * MS).unwrap_or_else(|e| panic!("{oscillator} Hz: {e}"));
        needs_acknowledgement(&mut scene);
    }
}

#[test]
fn external_clock_stops() {
    let mut scene = heating();
    scene.board.cpu.touch(|chip, now| chip.fail_external_clock(now));
    assert_eq!(scene.board.heater(), 0.0, "hardware does not wait for the program");
    scene.board.run_for(1000 * MS).expect("restarts on the internal clock");
    assert!(scene.board.logged("reset cause: clock failure"));
    assert!(scene.board.logged("clock Internal"));
    needs_acknowledgement(&mut scene);
}

#[test]
fn resets_while_heating() {
    for (cause, told, held) in [
        (Cause::Pin, "reset pin", false),
        (Cause::BrownOut, "brown-out", true),
        (Cause::Software, "software reset", true),
        (Cause::Watchdog, "watchdog", true),
    ] {
        let mut scene = heating();
        scene.board.reset(cause).expect("resets");
        assert_eq!(scene.board.heater(), 0.0, "{told}");
        scene.board.run_for(3000 * MS).expect("restarts");
        assert!(scene.board.logged(&format!("reset cause: {told}")), "{told}");
        assert_eq!(scene.board.heater(), 0.0, "{told}: nothing heats by itself");
        if held {
            needs_acknowledgement(&mut scene);
        }
    }
}

#[test]
fn a_hold_outlives_the_reset_button_and_the_power_switch() {
    let mut scene = heating();
    scene.board.interlock(false);
    scene.board.run_for(300 * MS).expect("runs on");
    scene.board.interlock(true);
    scene.board.reset(Cause::Pin).expect("resets");
    scene.board.run_for(1000 * MS).expect("restarts");
    let answer = scene.board.command("arm").expect("answers");
    assert!(answer.contains("ack"), "{answer}");
    scene.board.power_cycle().expect("comes back");
    scene.board.run_for(1000 * MS).expect("starts");
    needs_acknowledgement(&mut scene);
}

#[test]
fn the_button_acknowledges_when_held_for_two_seconds() {
    let mut scene = heating();
    scene.board.interlock(false);
    scene.board.run_for(300 * MS).expect("runs on");
    scene.board.interlock(true);
    for (hold, released) in [(1500, false), (2500, true)] {
        scene.board.button(true);
        scene.board.run_for(hold * MS).expect("runs on");
        scene.board.button(false);
        scene.board.run_for(500 * MS).expect("runs on");
        let answer = scene.board.command("arm").expect("answers");
        assert_eq!(answer.starts_with("ok"), released, "{hold} ms: {answer}");
    }
}

#[test]
fn a_stop_key_works_at_once_while_an_answer_is_on_its_way() {
    for key in [0x03, 0x1B, b'!'] {
        let mut scene = heating();
        scene.board.send(b"get\r");
        scene.board.run_for(50 * MS).expect("runs on");
        assert!(scene.board.heater() > 0.0);
        scene.board.send(&[key]);
        let begin = scene.board.now();
        scene.board.run_for(50 * MS).expect("runs on");
        let off = scene.board.heater_off_since().expect("off");
        assert!(off - begin < 2 * MS, "{key:#x}: off after {} us", (off - begin) / US);
        scene.board.run_for(2000 * MS).expect("runs on");
        assert!(scene.board.command("status").expect("answers").contains("mode off"), "{key:#x}");
        scene.arm().expect("a stop is no hold");
    }
}

#[test]
fn the_button_stops_when_pressed_and_that_press_acknowledges_nothing() {
    let mut scene = heating();
    scene.board.button(true);
    // The panel looks at it each 50 ms.
    scene.time_until_off(55 * MS).expect("off");
    scene.wire_sensor(1, 4095);
    scene.board.run_for(3000 * MS).expect("runs on");
    assert!(!scene.board.logged("button held"), "the press that stopped went on to acknowledge");
    scene.board.button(false);
    scene.wire_sensor(1, 2160);
    scene.board.run_for(500 * MS).expect("runs on");
    scene.arm().expect("a stop is no hold");
}

#[test]
fn stop_works_at_once() {
    let mut scene = heating();
    scene.board.send(b"stop\r");
    let begin = scene.board.now();
    scene.board.run_for(50 * MS).expect("runs on");
    let off = scene.board.heater_off_since().expect("off");
    // Five bytes at 115200 baud take 0.43 ms.
    assert!(off - begin < 10 * MS, "off after {} us", (off - begin) / US);
    scene.board.run_for(500 * MS).expect("runs on");
    assert_eq!(scene.board.heater(), 0.0);
    assert!(scene.board.command("status").expect("answers").contains("mode off"));
    scene.arm().expect("a stop is no hold");
}
