//! Names, numbers and sentences of the classes.

use super::super::hypothesis::HYPOTHESES;
use super::*;

/// Recordings are read by these, so that an old one says what it said.
#[test]
fn names_and_numbers_are_the_classes_own_and_never_change() {
    const NUMBERS: [(u32, &str); 29] = [
        (1, "t1_offset"),
        (2, "t2_offset"),
        (3, "t1_clogged"),
        (4, "air_flow"),
        (5, "heater_power"),
        (6, "t0_fault"),
        (7, "drift"),
        (8, "unknown"),
        (9, "t0_stuck"),
        (10, "t0_open"),
        (11, "t0_short"),
        (12, "t0_lost"),
        (13, "t1_detached"),
        (14, "t2_detached"),
        (15, "t1_t2_swapped"),
        (16, "t0_t1_swapped"),
        (17, "t0_t2_swapped"),
        (18, "air_flow_or_heater_power"),
        (20, "since_commissioning"),
        (25, "t1_stuck"),
        (26, "t1_open"),
        (27, "t1_short"),
        (28, "t1_lost"),
        (29, "t1_loose"),
        (41, "t2_stuck"),
        (42, "t2_open"),
        (43, "t2_short"),
        (44, "t2_lost"),
        (45, "t2_loose"),
    ];
    for (number, name) in NUMBERS {
        let classes = || FaultClass::ALL.iter().filter(|class| class.number() == number);
        assert!(classes().count() == 1 && classes().all(|class| class.name() == name), "{number} {name}");
    }
    for (i, class) in FaultClass::ALL.iter().enumerate() {
        let others = &FaultClass::ALL[i + 1..];
        assert!(class.number() > 0 && !others.contains(class), "{class:?}");
        assert!(others.iter().all(|c| c.number() != class.number() && c.name() != class.name()), "{class:?}");
    }
}

/// A class has a share of an alarm where a hypothesis is of it, under its own name.
#[test]
fn classes_with_a_hypothesis_have_a_share_of_their_name() {
    for class in FaultClass::ALL {
        let has = HYPOTHESES.iter().any(|row| row.class == class);
        assert_eq!(class.share().is_some(), has, "{class:?}");
        assert!(
            class.share().is_none_or(|share| share.field.strip_prefix("x_") == Some(class.name())),
            "{class:?}"
        );
    }
}

/// A class with a unit says its size, one without says none; a thermistor's class speaks of a thermistor.
#[test]
fn units_sentences_and_thermistors_go_together() {
    for class in FaultClass::ALL {
        let [plain, sized] = [false, true].map(|sized| class.sentence(sized));
        assert_eq!(sized != plain, !class.unit().is_empty(), "{class:?}");
        assert!(!plain.contains("{size}") && !plain.contains('|'), "{class:?}");
        assert!(class.sensor().is_some() || !(plain.contains("{t}") || sized.contains("{t}")), "{class:?}");
    }
}
