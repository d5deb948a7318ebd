//! The converter and the placing of its samples.

use super::{Mutant, mutant};

const FILE: &str = "firmware/src/hardware/inputs.rs";
const BOARD: &str = "firmware/src/hardware/nucleo_64.rs";

pub(super) const MUTANTS: &[Mutant] = &[
    mutant(
        "sampling-3-cycles",
        "each thermistor shows in the next",
        FILE,
        ["SampleTime::CYCLES84", "SampleTime::CYCLES3"],
        &["sampling::"],
    ),
    mutant(
        "converter-too-fast",
        "50 MHz, 36 are allowed",
        FILE,
        ["Adcpre::DIV4", "Adcpre::DIV2"],
        &["boot::boots_to_off"],
    ),
    mutant(
        "t1-and-t2-swapped",
        "control by T2",
        BOARD,
        ["[u8; 4] = [4, 0, 1, 8]", "[u8; 4] = [4, 1, 0, 8]"],
        &["sampling::each"],
    ),
    mutant(
        "t0-and-t1-swapped",
        "control by the room",
        BOARD,
        ["[u8; 4] = [4, 0, 1, 8]", "[u8; 4] = [0, 4, 1, 8]"],
        &["sampling::each"],
    ),
    mutant(
        "sampling-in-step-with-the-pwm",
        "the ripple is taken for temperature",
        FILE,
        ["round * SPACING_US", "round * (SPACING_US - 2)"],
        &["sampling::the_ripple"],
    ),
    mutant(
        "one-conversion-a-tick",
        "no mean",
        FILE,
        ["for round in 0..ROUNDS {", "for round in 0..ROUNDS / 25 {"],
        &["sampling::"],
    ),
    mutant(
        "pins-not-analogue",
        "the converter reads what a digital input lets through",
        FILE,
        ["            pin.set_as_analog();\n", "            let _ = &mut pin;\n"],
        &["boot::boots_to_off"],
    ),
    mutant(
        "converter-not-on",
        "no samples",
        FILE,
        ["        ADC.cr2().modify(|w| w.set_adon(true));\n", ""],
        &["boot::boots_to_off"],
    ),
    mutant(
        "converter-waited-for-for-ever",
        "a converter that hangs takes the control task along",
        FILE,
        ["const MAX_POLLS: u32 = 1000;", "const MAX_POLLS: u32 = u32::MAX;"],
        &["sampling::a_converter"],
    ),
    mutant(
        "stale-code",
        "a conversion that does not end gives the code of the one before",
        FILE,
        [
            "    done.then(|| ADC.dr().read().0 as u16)",
            "    Some(ADC.dr().read().0 as u16).filter(|_| done || true)",
        ],
        &["sampling::a_conversion"],
    ),
    mutant(
        "broken-wire-believed",
        "a T1 that is broken or shorted is a temperature",
        "fdi-core/src/sense/plausibility.rs",
        [
            "        Reading { celsius, validity }\n",
            "        Reading { celsius, validity: if true { Validity::Good } else { validity } }\n",
        ],
        &["heater_off::t1_broken", "heater_off::t1_shorted"],
    ),
    mutant(
        "late-codes-believed",
        "codes that are for another tick are taken for those of this one",
        "firmware/src/simulation.rs",
        [".filter(|came| came.tick == tick)", ".filter(|came| came.tick == tick || true)"],
        &["simulated::with_codes_that_come_late"],
    ),
    mutant(
        "log-overwrites-itself",
        "a reader of the log that was away finds torn frames",
        "firmware/src/hardware/rtt.rs",
        ["        if next == read {", "        if next == read && false {"],
        &["log::a_reader_that_comes_back", "log::never_read"],
    ),
];
