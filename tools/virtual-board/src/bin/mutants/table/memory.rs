//! What the board tests of itself while it runs.

use super::{Mutant, mutant};

const MEMORY: &str = "firmware/src/hardware/memory.rs";
const CONTROL: &str = "firmware/src/tasks/control.rs";

const PROGRAM: &[&str] = &["self_tests::a_program_that"];
const WHILE_HEATING: &[&str] = &["self_tests::a_program_that_changes_while_it_heats"];
const CELL: &[&str] = &["self_tests::a_cell_that_sticks"];

pub(super) const MUTANTS: &[Mutant] = &[
    mutant(
        "image-not-tested",
        "any other program runs",
        MEMORY,
        ["        FAILED.fetch_or(CRC.dr().read() != 0, Ordering::Relaxed);\n", ""],
        PROGRAM,
    ),
    mutant(
        "image-tested-at-the-start-only",
        "a program that changes runs on",
        MEMORY,
        ["    test_image(IMAGE_WORDS);\n", "    let _ = IMAGE_WORDS;\n"],
        WHILE_HEATING,
    ),
    mutant(
        "no-march-at-the-start",
        "a board starts whose RAM does not keep what is written",
        MEMORY,
        ["    \"ldr r0, =_stack_end\",\n", "    \"bx lr\",\n"],
        &["self_tests::a_board_whose_ram"],
    ),
    mutant(
        "no-cell-tested",
        "a cell that fails later is not found",
        MEMORY,
        ["    test_ram(RAM_WORDS);\n", "    let _ = (RAM_WORDS, test_ram);\n"],
        CELL,
    ),
    mutant(
        "cell-not-put-back",
        "the test itself changes the memory",
        MEMORY,
        ["                \"str {kept}, [{word}]\",\n", ""],
        &["self_tests::a_pass_over_all_memory"],
    ),
    mutant(
        "failed-memory-believed",
        "what was found has no effect",
        CONTROL,
        ["if !memory::holds()", "if !memory::holds() && false"],
        PROGRAM,
    ),
    mutant(
        "reference-not-read",
        "a converter that is wrong by a tenth is believed",
        "firmware/src/hardware/inputs.rs",
        [
            "is_some_and(|code| REFERENCE.contains(&code))",
            "is_some_and(|code| REFERENCE.contains(&code) || true)",
        ],
        &["self_tests::a_converter_that_gets"],
    ),
    mutant(
        "pins-not-read",
        "a pin that something else holds high is not told",
        CONTROL,
        ["if heater.is_stuck_high()", "if heater.is_stuck_high() && false"],
        &["self_tests::a_pin_that"],
    ),
];
