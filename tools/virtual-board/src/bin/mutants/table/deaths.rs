//! How the program dies, and what the next one makes of it.

use super::{Mutant, mutant};

const FAULT: &str = "firmware/src/hardware/fault.rs";
const START: &str = "firmware/src/start.rs";

pub(super) const MUTANTS: &[Mutant] = &[
    mutant(
        "panic-does-not-cut",
        "a panic heats on while it writes its words",
        "firmware/src/panic.rs",
        ["    heater::cut();\n", ""],
        &["last_gasp::a_panic"],
    ),
    mutant(
        "hard-fault-does-not-cut",
        "a HardFault heats on while it writes its words",
        FAULT,
        [
            "fn hard_fault(stack: *const u32) -> ! {\n    heater::cut();\n",
            "fn hard_fault(stack: *const u32) -> ! {\n",
        ],
        &["last_gasp::a_hard_fault"],
    ),
    mutant(
        "stray-interrupt-does-not-cut",
        "a stray interrupt heats on while it writes its words",
        FAULT,
        ["DefaultHandler(irq: i16) -> ! {\n    heater::cut();\n", "DefaultHandler(irq: i16) -> ! {\n"],
        &["last_gasp::a_stray"],
    ),
    mutant(
        "clock-failure-does-not-cut",
        "a dead clock is left to hardware alone",
        FAULT,
        ["NonMaskableInt() -> ! {\n    heater::cut();\n", "NonMaskableInt() -> ! {\n"],
        &["heater_off::external_clock_stops"],
    )
    .unseen("the clock's guard has broken TIM1 before the interrupt comes"),
    mutant(
        "no-stack-for-faults",
        "a stack overflow locks the core up",
        FAULT,
        ["    \"msr msp, r1\",\n", ""],
        &["heater_off::stack_overflow"],
    ),
    mutant(
        "death-not-kept",
        "the next start does not know how the last one ended",
        FAULT,
        [
            "    retained::store(&Retained { death: Some(death), words, ..Retained::EMPTY });\n",
            "    let _ = (death, words);\n",
        ],
        &["heater_off::panic_in_each_task"],
    ),
    mutant(
        "reset-flags-not-cleared",
        "each start sees the flags of all before",
        "firmware/src/hardware/reset.rs",
        ["    RCC.csr().modify(|w| w.set_rmvf(true));\n", ""],
        &["last_gasp::each_start"],
    ),
    mutant(
        "fault-reset-does-not-lock-out",
        "after a fault reset it can be armed at once",
        "firmware-logic/src/reset_cause.rs",
        [
            "        !matches!(self, Self::PowerOn | Self::Pin | Self::Restarted(_))",
            "        !matches!(self, Self::PowerOn | Self::Pin | Self::Restarted(_)) && false",
        ],
        &["heater_off::resets_while_heating"],
    ),
    mutant(
        "lockout-not-kept",
        "the reset button acknowledges",
        START,
        ["    retained::store(&Retained { lockout: interlock.lockout(), ..Retained::EMPTY });\n", ""],
        &["last_gasp::a_fault_reset"],
    ),
    mutant(
        "retained-words-not-checked",
        "noise in RAM is taken for a crash record",
        "firmware-logic/src/retained.rs",
        [" || words[WORDS - 1] != checksum(words)", ""],
        &["last_gasp::ram_full"],
    ),
    mutant(
        "stack-above-the-data",
        "a stack overflow corrupts the controller",
        "memory.x",
        [
            "  STACK : ORIGIN = 0x20000000, LENGTH = 30K\n  RAM   : ORIGIN = 0x20007800, LENGTH = 98K\n",
            "  STACK : ORIGIN = 0x20010000, LENGTH = 30K\n  RAM   : ORIGIN = 0x20000000, LENGTH = 64K\n",
        ],
        &["last_gasp::a_stack_overflow"],
    ),
];
