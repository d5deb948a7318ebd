//! The supply, and the flash that must not be written while it heats or believed after it has failed.

use super::{Mutant, mutant};

const SUPPLY: &str = "firmware/src/hardware/supply.rs";
const DETECTOR: &str = "firmware/src/hardware/undervoltage.rs";
const FLASH: &str = "firmware/src/hardware/settings_flash.rs";
const CONSOLE: &str = "firmware-logic/src/console/board.rs";
const START: &str = "firmware/src/start.rs";

const FALLING: &[&str] = &["brown_out::a_falling_supply_cuts_before"];

pub(super) const MUTANTS: &[Mutant] = &[
    mutant(
        "detector-off",
        "a falling supply is not seen",
        DETECTOR,
        ["        w.set_pvde(true);\n", ""],
        FALLING,
    ),
    mutant(
        "detector-too-low",
        "it is seen too late",
        DETECTOR,
        ["const THRESHOLD: u8 = 7;", "const THRESHOLD: u8 = 4;"],
        FALLING,
    ),
    mutant(
        "detector-edge-off",
        "its interrupt never comes",
        DETECTOR,
        ["    EXTI.rtsr(0).modify(|w| w.set_line(LINE, true));\n", ""],
        FALLING,
    ),
    mutant(
        "detector-wrong-edge",
        "its interrupt comes when the supply is back",
        DETECTOR,
        ["    EXTI.rtsr(0).modify", "    EXTI.ftsr(0).modify"],
        FALLING,
    ),
    mutant(
        "detector-masked",
        "its interrupt never comes",
        DETECTOR,
        ["    EXTI.imr(0).modify(|w| w.set_line(LINE, true));\n", ""],
        FALLING,
    ),
    mutant(
        "detector-interrupt-off",
        "its interrupt never comes",
        DETECTOR,
        ["    unsafe { interrupt::PVD.enable() };\n", "    let _ = interrupt::PVD.is_enabled();\n"],
        FALLING,
    ),
    mutant(
        "detector-flag-not-cleared",
        "one interrupt for ever",
        DETECTOR,
        ["    EXTI.pr(0).write(|w| w.set_line(LINE, true));\n", ""],
        FALLING,
    ),
    mutant(
        "supply-not-watched",
        "a falling supply is not seen",
        START,
        ["    undervoltage::watch();\n", ""],
        FALLING,
    ),
    mutant(
        "armed-on-a-low-supply",
        "a supply that was low before gives no edge",
        "firmware/src/hardware/heater.rs",
        ["        if supply::is_low() {", "        if supply::is_low() && false {"],
        &["brown_out::a_supply_that_is_low"],
    ),
    mutant(
        "no-mark-when-armed",
        "a power failure looks like switching it on",
        CONSOLE,
        ["        if command.heats() && !self.marked", "        if false && command.heats() && !self.marked"],
        &["brown_out::a_sag"],
    ),
    mutant(
        "mark-not-read",
        "the same",
        START,
        ["    interlock.marked(cause, marked);\n", "    let _ = marked;\n"],
        &["brown_out::a_sag"],
    ),
    mutant(
        "saved-while-heating",
        "an erasure stalls the core while it heats",
        CONSOLE,
        [
            "            return Err(SaveError::Heating);\n        }\n        let settings",
            "        }\n        let settings",
        ],
        &["settings::nothing_is_saved"],
    ),
    mutant(
        "erased-by-bytes",
        "an erasure takes twice as long",
        FLASH,
        ["Psize::PSIZE32)", "Psize::PSIZE8)"],
        &["erase::a_sector"],
    ),
    mutant(
        "cache-not-flushed",
        "what was erased is still read",
        FLASH,
        ["    forget(true); // possible only while they are off\n", ""],
        &["erase::nothing_stale"],
    ),
    mutant(
        "cache-flushed-while-on",
        "the flush has no effect",
        FLASH,
        ["    enable(false);\n", ""],
        &["erase::nothing_stale"],
    ),
    mutant(
        "detector-does-not-note",
        "the next start does not know of the low supply",
        DETECTOR,
        ["        retained::note_undervoltage();\n", ""],
        &["supply::a_sag"],
    ),
    mutant(
        "mark-taken-away-while-latched",
        "the power switch acknowledges",
        CONSOLE,
        ["if self.marked && !latched && !self.may_heat() {", "if self.marked && !self.may_heat() {"],
        &["supply::a_trip_outlives"],
    ),
    mutant(
        "mark-never-taken-away",
        "switching it on needs an acknowledgement",
        CONSOLE,
        ["if self.marked && !latched && !self.may_heat() {", "if false {"],
        &["supply::a_power_failure"],
    ),
    mutant(
        "brown-out-level-not-told",
        "nobody knows that the factory leaves it off",
        SUPPLY,
        ["    if level == LEVEL_3 { None }", "    if level == LEVEL_3 || true { None }"],
        &["supply::the_brown_out"],
    ),
    mutant(
        "brown-out-level-set-while-heating",
        "programming the option bytes stalls the core while it heats",
        CONSOLE,
        [
            "    fn set_brown_out_level(&mut self) -> Result<(), SaveError> {\n        if self.may_heat() {",
            "    fn set_brown_out_level(&mut self) -> Result<(), SaveError> {\n        if false {",
        ],
        &["supply::the_brown_out"],
    ),
    mutant(
        "brown-out-level-not-programmed",
        "the level is written to the register alone",
        SUPPLY,
        ["        optcr.modify(|w| w.set_optstrt(true));\n", ""],
        &["supply::the_brown_out"],
    ),
    mutant(
        "baseline-not-restored",
        "after a reset, too much power for what was learnt is no trip",
        START,
        ["            control.restored(baseline);\n", ""],
        &["settings::what_was_learnt"],
    ),
    mutant(
        "refused-level-counted",
        "a brown-out level that the chip has refused is said to be set",
        SUPPLY,
        ["let refused = FLASH.sr().read().wrperr();", "let refused = FLASH.sr().read().wrperr() && false;"],
        &["supply::a_brown_out_level_that_the_chip_refuses"],
    ),
];
