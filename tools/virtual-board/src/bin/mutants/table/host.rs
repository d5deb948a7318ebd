//! What the board shares with the host, and tests there see: settings and their flash, what people type, single readings. The rules of the
//! supervisor, `interlock`, `control_loop` and `self_test` have cargo-mutants (docs/evidence/safety-evidence.md).

use super::{Mutant, mutant};

const CORE: &[&str] = &["-p", "fdi-core", "--lib", "--test", "core"];
const LOGIC: &[&str] = &["-p", "pt326-firmware-logic", "--lib", "--tests"];

const STORE: &str = "firmware-logic/src/settings/store.rs";

pub(super) const MUTANTS: &[Mutant] = &[
    mutant(
        "damaged-settings-believed",
        "a flipped bit in flash is a limit",
        "firmware-logic/src/settings/stored.rs",
        [
            "if CRC32.checksum(content) != u32::from_le_bytes(*crc) {",
            "if CRC32.checksum(content) != u32::from_le_bytes(*crc) && false {",
        ],
        &["record::any_flipped_bit"],
    )
    .on_host(LOGIC),
    mutant(
        "save-not-read-back",
        "what is acknowledged is gone at the next start",
        STORE,
        ["Ok(Some(found)) if found == bytes", "_"],
        &["power_cut::what_is_acknowledged", "power_cut::what_is_saved"],
    )
    .on_host(LOGIC),
    mutant(
        "refusal-erases-all",
        "a word that the flash refuses costs all that was kept",
        STORE,
        ["                Err(Error::Storage { .. }) => break,\n", ""],
        &["power_cut::a_word_that_is_refused"],
    )
    .on_host(LOGIC),
    mutant(
        "no-mending-after-an-error",
        "an erasure that failed is taken for one that has ended",
        STORE,
        ["        self.mended = result.is_ok();\n", ""],
        &["power_cut::a_step_that_is_refused"],
    )
    .on_host(LOGIC),
    mutant(
        "commissioning-not-rewritten",
        "a save that has erased the commissioning loses it",
        "firmware-logic/src/console/board.rs",
        ["        self.given = None; // saving may have had to erase it\n", ""],
        &["commissioning::a_commissioning_is_written_once"],
    )
    .on_host(LOGIC),
    mutant(
        "permission-not-asked",
        "a flipped bit of the mode heats",
        "firmware-logic/src/control_loop/mod.rs",
        ["if self.permit != needed || ", "if "],
        &["no_flipped_bit_heats"],
    )
    .on_host(LOGIC),
    mutant(
        "cut-erasure-believed",
        "a power cut while a sector is erased loses what was saved",
        STORE,
        ["self.mended = self.sectors.mend().await.is_ok();", "self.mended = true;"],
        &["whatever_is_cut", "full_sectors"],
    )
    .on_host(LOGIC),
    mutant(
        "garbage-not-erased",
        "a flash full of garbage takes no settings for ever",
        STORE,
        [
            "Err(_) => self.map().erase_all().await.map_err(|_| SaveError::Flash)?,",
            "Err(_) => return Err(SaveError::Flash),",
        ],
        &["store::the_first_save"],
    )
    .on_host(LOGIC),
    mutant(
        "simulated-is-kept",
        "what a simulated rig taught is believed of the real one",
        "firmware-logic/src/console/board.rs",
        [
            "        if self.chip.is_simulated() {\n            return; //",
            "        if false {\n            return; //",
        ],
        &["commissioning::a_board_that_is_simulated"],
    )
    .on_host(LOGIC),
    mutant(
        "stream-torn",
        "a line that finds no room leaves a part of itself in the stream",
        "firmware-logic/src/stream/mod.rs",
        ["            self.waiting.truncate(before);\n", ""],
        &["stream::tests::what_finds_no_room"],
    )
    .on_host(LOGIC),
    mutant(
        "strange-bytes-skipped",
        "a command comes about by noise on the line",
        "firmware-logic/src/console/line.rs",
        [
            "self.error.get_or_insert(LineError::Byte { byte, column });",
            "let _ = LineError::Byte { byte, column };",
        ],
        &["console::line::tests::"],
    )
    .on_host(LOGIC),
    mutant(
        "jammed-button-acknowledges",
        "a button that is jammed since the start releases a lockout",
        "firmware-logic/src/hold_button.rs",
        ["Self { needed, held: SPENT }", "Self { needed, held: 0 }"],
        &["hold_button::tests::a_button_that_is_jammed"],
    )
    .on_host(LOGIC),
    mutant(
        "stuck-not-seen",
        "a frozen thermistor is regulated by",
        "fdi-core/src/sense/plausibility.rs",
        [
            "        state.still_ticks >= self.stuck_ticks\n",
            "        state.still_ticks >= self.stuck_ticks && false\n",
        ],
        &["supervision::a_t1_that_does_not_change"],
    )
    .on_host(CORE),
    mutant(
        "calibration-taken-for-heat",
        "thermistors that are calibrated anew contradict what was learnt with the old ones",
        "fdi-core/src/control/mod.rs",
        ["            self.supervisor.recalibrated(&mut state.supervisor);\n", ""],
        &["supervision::a_calibration_at_rest"],
    )
    .on_host(CORE),
    mutant(
        "any-supply-believed",
        "a broken wire of the supply makes every power look small",
        "fdi-core/src/sense/supply.rs",
        [" && PLAUSIBLE.contains(&share) {", " {"],
        &["known::", "sense::"],
    )
    .on_host(CORE),
    mutant(
        "tune-without-its-air",
        "an experiment heats on though T1 has left the air",
        "fdi-core/src/tune/mod.rs",
        ["const LEFT: f32 = 0.2;", "const LEFT: f32 = -1e9;"],
        &["tune::tests::a_t1_that_falls"],
    )
    .on_host(CORE),
];
