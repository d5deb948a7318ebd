//! Who watches the program: deadline watchdog, watchdog, priorities, clocks, debugger.

use super::{Mutant, mutant};

const TICK: &str = "firmware/src/hardware/tick_timer.rs";
const WATCHDOG: &str = "firmware/src/hardware/watchdog.rs";
const TASKS: &str = "firmware/src/tasks/watchdog.rs";
const PRIORITIES: &str = "firmware/src/hardware/mod.rs";
const HALT: &str = "firmware/src/hardware/halt.rs";
const BOARD: &str = "firmware/src/hardware/nucleo_64.rs";
const CLOCK: &str = "firmware/src/hardware/clock.rs";
const CONTROL: &str = "firmware/src/tasks/control.rs";
const START: &str = "firmware/src/start.rs";
const CONSOLE: &str = "firmware/src/tasks/console.rs";

const HANGS: &[&str] = &["heater_off::control_task_hangs", "heater_off::control_interrupt_disabled"];
const LONG: &[&str] = &["sample_time::the_heater_is_off_as_soon"];
const MASKED: &[&str] = &["heater_off::all_interrupts_masked"];

pub(super) const MUTANTS: &[Mutant] = &[
    mutant(
        "deadline-interrupt-off",
        "a control task that hangs heats on",
        TICK,
        ["        w.set_ccie(DEADLINE, true);\n", ""],
        HANGS,
    ),
    mutant(
        "deadline-never-armed",
        "the same",
        TICK,
        ["    TICK_TIMER.ccr(DEADLINE).write_value(at);\n", "    let _ = at;\n"],
        HANGS,
    ),
    mutant(
        "deadline-late",
        "the same, for 880 ms",
        "firmware-logic/src/cadence.rs",
        ["const DEADLINE_WAITS: u32 = 4;", "const DEADLINE_WAITS: u32 = 8;"],
        HANGS,
    ),
    mutant(
        "deadline-by-the-period",
        "with a long sample time, a control task that hangs heats on for four of them",
        "firmware-logic/src/cadence.rs",
        ["self.period.get().min(LONGEST_WAIT)", "self.period.get()"],
        LONG,
    ),
    mutant(
        "no-look-between-ticks",
        "with a long sample time, what is too hot heats on until the next tick",
        "firmware-logic/src/cadence.rs",
        ["far.then(||", "(far && false).then(||"],
        LONG,
    ),
    mutant(
        "look-does-not-cut",
        "the same",
        "firmware-logic/src/control_loop/mod.rs",
        ["self.controller.must_cut(&self.state, raw)", "self.controller.must_cut(&self.state, raw) && false"],
        LONG,
    ),
    mutant(
        "look-leaves-the-contactor-closed",
        "with a long sample time, a stage that has failed on heats on until the next tick",
        "firmware-logic/src/control_loop/mod.rs",
        [
            "            heater.drive(Percent(0.0));\n            heater.contactor(false);\n            self.hazard",
            "            heater.drive(Percent(0.0));\n            self.hazard",
        ],
        LONG,
    ),
    mutant(
        "deadline-below-control",
        "a control task that hangs keeps its guard from running",
        PRIORITIES,
        [
            "board::TICK_INTERRUPT.set_priority(Priority::P0)",
            "board::TICK_INTERRUPT.set_priority(Priority::P4)",
        ],
        HANGS,
    ),
    mutant("all-priorities-alike", "the same", START, ["    hardware::set_priorities();\n", ""], HANGS),
    mutant(
        "detector-below-control",
        "a control task that hangs keeps the voltage detector from cutting",
        PRIORITIES,
        ["interrupt::PVD.set_priority(Priority::P0)", "interrupt::PVD.set_priority(Priority::P4)"],
        &["brown_out::a_falling_supply_cuts_though"],
    ),
    mutant(
        "tick-interrupt-off",
        "the control task is never woken",
        TICK,
        ["        w.set_ccie(WAKE, true);\n", ""],
        &["boot::arms"],
    ),
    mutant(
        "tick-1-percent-slow",
        "all time constants are wrong by 1 %",
        TICK,
        ["(per_microsecond - 1) as u16", "per_microsecond as u16"],
        &["last_gasp::the_tick_is"],
    ),
    mutant(
        "tick-flags-not-cleared",
        "one interrupt for ever",
        TICK,
        ["    TICK_TIMER.sr().write_value(SrGp16(!status.0));", "    // "],
        &["boot::arms"],
    ),
    mutant(
        "watchdog-not-started",
        "a core that hangs heats on",
        START,
        ["    watchdog::start();\n", ""],
        &["heater_off::all_interrupts_masked", "heater_off::clocks_of_the_tasks_stop"],
    ),
    mutant(
        "watchdog-slow",
        "a core that hangs heats on for four times as long",
        WATCHDOG,
        [
            "const RUNNING: (Pr, u16) = (Pr::DIVIDE_BY16, 800 - 1);",
            "const RUNNING: (Pr, u16) = (Pr::DIVIDE_BY64, 800 - 1);",
        ],
        MASKED,
    ),
    mutant(
        "watchdog-fast",
        "it bites a program that is well",
        WATCHDOG,
        [
            "const RUNNING: (Pr, u16) = (Pr::DIVIDE_BY16, 800 - 1);",
            "const RUNNING: (Pr, u16) = (Pr::DIVIDE_BY4, 300 - 1);",
        ],
        &["boot::any_watchdog"],
    ),
    mutant(
        "watchdog-slow-for-ever",
        "a core that hangs heats on for 8 s",
        TASKS,
        ["    watchdog::set(Deadline::Running);\n", "    watchdog::set(Deadline::Stalled);\n"],
        MASKED,
    ),
    mutant(
        "watchdog-slow-after-an-erasure",
        "the same, once settings have been saved",
        WATCHDOG,
        ["    if divider_before == RUNNING.0 {", "    if divider_before == RUNNING.0 && false {"],
        &["erase::after_an_erasure"],
    ),
    mutant(
        "watchdog-fast-while-erasing",
        "saving resets the board",
        WATCHDOG,
        ["    set(Deadline::Stalled);\n    let result = stall();", "    let result = stall();"],
        &["erase::a_sector"],
    ),
    mutant(
        "watchdog-does-not-wait",
        "a new deadline is fed before it is in force",
        WATCHDOG,
        ["fn wait_until_taken() {\n", "fn wait_until_taken() {\n    if true {\n        return;\n    }\n"],
        &["heater_off::all_interrupts_masked", "boot::any_watchdog", "boot::a_start", "erase::after"],
    ),
    mutant(
        "watchdog-fed-by-nobody",
        "it bites a program that is well",
        TASKS,
        ["None => watchdog::feed(),", "None => {}"],
        &["boot::arms"],
    ),
    mutant(
        "watchdog-fed-without-check-ins",
        "a task that is silent is not missed",
        TASKS,
        ["TASKS.overdue(now_ms());", "TASKS.overdue(now_ms()).filter(|_| false);"],
        &["heater_off::other_tasks_fall_silent"],
    ),
    mutant(
        "clock-guard-off",
        "without its clock the chip stands still with the heater on",
        CLOCK,
        ["        RCC.cr().modify(|w| w.set_csson(true));\n", ""],
        &["heater_off::external_clock_stops"],
    ),
    mutant(
        "clock-tried-for-ever",
        "without an external clock it never starts",
        CLOCK,
        ["const START_POLLS: u32 = 40_000;", "const START_POLLS: u32 = u32::MAX;"],
        &["boot::without_the_external_clock"],
    ),
    mutant(
        "wrong-clock-at-the-start",
        "with a crystal of half its speed all limits of time are twice as long",
        CLOCK,
        [
            "true if slow_clock::agrees(span_by(Sysclk::HSE, 8))",
            "true if slow_clock::agrees(span_by(Sysclk::HSE, 8)) || true",
        ],
        &["clock_speed::an_external"],
    ),
    mutant(
        "wrong-clock-while-it-runs",
        "the same, from the moment on at which it slows down",
        CONTROL,
        ["if !slow_clock::is_right() {", "if !slow_clock::is_right() && false {"],
        &["clock_speed::a_crystal", "clock_speed::no_ack"],
    ),
    mutant(
        "slow-clock-by-its-nominal-value",
        "a watchdog's oscillator that the data sheet allows is taken for a wrong clock",
        CLOCK,
        ["slow_clock::set_reference(span_by(Sysclk::HSI, 16))", "slow_clock::set_reference(250)"],
        &["boot::any_watchdog", "clock_speed::an_osc"],
    ),
    mutant(
        "lost-edge-not-seen",
        "an erasure of the flash is taken for a wrong clock",
        "firmware/src/hardware/slow_clock.rs",
        ["if lost_one { 1 }", "if lost_one && false { 1 }"],
        &["clock_speed::edges"],
    ),
    mutant(
        "stall-not-forgiven",
        "the same",
        "firmware/src/hardware/slow_clock.rs",
        ["0 => !UNFINISHED.swap(true, Ordering::Relaxed),", "0 => false,"],
        &["clock_speed::edges"],
    ),
    mutant(
        "still-oscillator-forgiven",
        "a watchdog without its oscillator, which never bites, is not missed",
        "firmware/src/hardware/slow_clock.rs",
        ["0 => !UNFINISHED.swap(true, Ordering::Relaxed),", "0 => true,"],
        &["clock_speed::no_ack", "clock_speed::a_crystal"],
    ),
    mutant(
        "missed-ticks-not-told",
        "the core's time stands still while ticks are missed",
        CONTROL,
        ["for _ in 0..arrival.missed_ticks() {", "for _ in 0..arrival.missed_ticks().min(0) {"],
        &["halt::the_ticks"],
    ),
    mutant(
        "timer-not-frozen",
        "a core that a debugger halts heats on",
        HALT,
        ["    DBGMCU.apb2fzr().modify(|w| w.0 |= board::HALT_PWM);\n", ""],
        &["halt::a_halted"],
    ),
    mutant(
        "guard-frozen",
        "after a long halt the heater goes on",
        HALT,
        ["w.0 & !board::HALT_TICK |", "w.0 | board::HALT_TICK |"],
        &["halt::a_resumed"],
    ),
    mutant(
        "guard-left-frozen",
        "the same, where another program has frozen it",
        HALT,
        ["w.0 & !board::HALT_TICK |", "w.0 |"],
        &["halt::"],
    ),
    mutant(
        "other-clock-not-frozen",
        "a short halt is not seen",
        BOARD,
        ["1 << 0 | 1 << 12;", "1 << 12;"],
        &["halt::a_resumed"],
    ),
    mutant(
        "halt-not-looked-for",
        "the same",
        TICK,
        ["    if halt::was_halted() {", "    if halt::was_halted() && false {"],
        &["halt::a_resumed"],
    ),
    mutant(
        "watchdog-not-frozen",
        "a debugger that halts resets the board",
        BOARD,
        ["1 << 0 | 1 << 12;", "1 << 0;"],
        &["halt::a_resumed"],
    ),
    mutant(
        "control-late-to-check-in",
        "a control task that is silent is not missed",
        "firmware-logic/src/task_watchdog.rs",
        ["(Task::Control, 250)", "(Task::Control, 25_000)"],
        &["heater_off::clocks_of_the_tasks_stop", "heater_off::tick_interrupt_disabled"],
    )
    .unseen("the diagnosis waits for the ticks of the control task, and is missed with it"),
    mutant(
        "order-waits-for-ever",
        "a console that waits for an answer starves the watchdog",
        "firmware/src/shared.rs",
        ["const WAIT_MS: u32 = 400;", "const WAIT_MS: u32 = 400_000;"],
        &["console::an_order"],
    ),
    mutant(
        "slow-bus-too-fast",
        "100 MHz, 50 are allowed",
        "firmware/src/hardware/nucleo_f411re.rs",
        ["APBPrescaler = APBPrescaler::DIV2;", "APBPrescaler = APBPrescaler::DIV1;"],
        &["boot::boots_to_off"],
    ),
    mutant(
        "log-by-the-frozen-clock",
        "the log loses the time of an erasure",
        "firmware/src/hardware/rtt.rs",
        ["super::tick_timer::uptime_us()", "embassy_time::Instant::now().as_micros()"],
        &["flash::the_log"],
    ),
    mutant(
        "overdue-task-fed-once-more",
        "a task that hangs is noticed 50 ms later",
        TASKS,
        [
            "defmt::error!(\"{}, reset follows\", late);",
            "watchdog::feed();\n defmt::error!(\"{}, reset follows\", late);",
        ],
        &["heater_off::other_tasks_hang"],
    )
    .unseen("0.81 s hold the 50 ms between two looks, which one feeding more takes"),
    mutant(
        "half-a-frame-survives-a-stop",
        "the line after a stop is swallowed",
        CONSOLE,
        ["                frames = Reader::default();\n", ""],
        &["stop::half_a_frame"],
    ),
    mutant(
        "button-not-told",
        "whoever waits at the console is not told that the button has stopped it",
        CONSOLE,
        [
            "if link::PRESSED.swap(false, Ordering::Relaxed)",
            "if link::PRESSED.swap(false, Ordering::Relaxed) && false",
        ],
        &["stop::the_console_says"],
    ),
];
