//! What is steady in a repetition of any length, and which rows can stand beside others.

use fdi_core::Config;
use fdi_core::diagnosis::signature::{MAX_ROWS, Signature, Symptom, Symptoms};
use fdi_core::diagnosis::teach::tables::{Full, add, conflicts, make_room};
use fdi_core::diagnosis::teach::{Repetition, Steady, common, tells};

const NORMAL: Symptoms = [Symptom::Normal; 5];
const HIGH: Symptoms = [Symptom::High; 5];
const LOW: Symptoms = [Symptom::Low; 5];

fn repetition(stretches: &[(usize, Symptoms)]) -> Repetition {
    let mut repetition = Repetition::default();
    let ticks = stretches.iter().flat_map(|(ticks, symptoms)| core::iter::repeat_n(symptoms, *ticks));
    ticks.for_each(|symptoms| repetition.push(symptoms));
    repetition
}

fn steady(stretches: &[(usize, Symptoms)]) -> Option<Steady> {
    repetition(stretches).steady()
}

#[test]
fn the_later_half_counts_however_long_it_is() {
    for ticks in [2, 7, 16, 17, 100, 227, 1000, 30_000] {
        let (earlier, later) = (ticks * 5 / 9, ticks - ticks * 5 / 9);
        let both = [(earlier, HIGH), (later, LOW)];
        assert_eq!(steady(&both), Some([Some(Symptom::Low); 5]), "{ticks}");
        assert_eq!(repetition(&both).ticks(), ticks as u32);
    }
    assert_eq!(steady(&[]), None);
    assert_eq!(steady(&[(1, HIGH)]), None, "one tick has no later half");
}

#[test]
fn nothing_overflows_in_a_day() {
    let day = repetition(&[(800_000, HIGH), (100_000, LOW)]);
    assert!(day.ticks() >= 250_000);
    assert_eq!(day.steady(), Some([Some(Symptom::High); 5]));
}

#[test]
fn what_comes_and_goes_is_not_steady() {
    let flicker = |of_ten: usize| [(10 - of_ten, NORMAL), (of_ten, HIGH)].repeat(40);
    assert_eq!(steady(&flicker(5)), Some([None; 5]));
    assert_eq!(steady(&flicker(8)), Some([None; 5]));
    assert_eq!(steady(&[flicker(0), vec![(2, HIGH)]].concat()), Some([Some(Symptom::Normal); 5]));
}

#[test]
fn a_row_is_what_all_have_in_common_and_must_say_something() {
    let [high, low] = [HIGH, LOW].map(|symptoms| symptoms.map(Some));
    let mixed = [high[0], high[1], low[2], None, high[4]];
    assert_eq!(common(&[high, mixed]).to_string(), "+1 +1 x x +1");
    assert_eq!(common(&[]).to_string(), "x x x x x");
    assert!(!tells(&common(&[])) && !tells(&common(&[NORMAL.map(Some)])) && tells(&common(&[high, mixed])));
}

#[test]
fn rows_find_room_keep_their_number_and_do_not_overlap() {
    let mut config = Config::default().diagnosis;
    let row = |number, name: &str| Signature {
        number,
        pattern: "-1 -1 -1 -1 -1".parse().expect("a pattern"),
        name: name.parse().expect("a name"),
    };
    let mut number = 0;
    for name in ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j"] {
        number = make_room(&mut config, name.parse().expect("a name"));
        assert_eq!(add(&mut config, row(number, name)), Ok(()));
    }
    assert_eq!((number, config.isolation.len()), (13, MAX_ROWS));
    let before = config.clone();
    assert_eq!(add(&mut config, row(99, "k")), Err(Full));
    assert_eq!(config, before);
    assert_eq!(make_room(&mut config, "c".parse().expect("a name")), 6);
    assert_eq!((config.isolation.len(), config.detection.len()), (12, 11));
    let paper = Config::default().diagnosis;
    let overlapping = conflicts(&paper, "+1 x -1 0 x".parse().expect("a pattern"));
    assert_eq!(overlapping.map(|(place, row)| (place, row.number)).collect::<Vec<_>>(), [(2, 2), (3, 3)]);
}
