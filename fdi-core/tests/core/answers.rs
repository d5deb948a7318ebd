//! Rows of a user's own answer when they have matched for long enough; the paper's do at once, and meanwhile.

use fdi_core::diagnosis::answer::{Answers, Standing};
use fdi_core::diagnosis::signature::{PAPER_DETECTION, PAPER_ISOLATION, Signature, Symptom, Symptoms};

fn symptoms(signs: [i8; 5]) -> Symptoms {
    signs.map(|sign| [Symptom::Low, Symptom::Normal, Symptom::High][(sign + 1) as usize])
}

fn with(rows: &[Signature], own: &[(u8, &str)]) -> Vec<Signature> {
    let own = own.iter().map(|(number, pattern)| Signature {
        number: *number,
        pattern: pattern.parse().expect("a pattern"),
        name: "own".parse().expect("a name"),
    });
    rows.iter().copied().chain(own).collect()
}

fn answers(rows: &[Signature], signs: &[[i8; 5]]) -> Vec<u8> {
    let (answers, mut standing) = (Answers::new(rows, 3), Standing::default());
    signs.iter().map(|signs| answers.step(&mut standing, &symptoms(*signs))).collect()
}

const NORMAL: [i8; 5] = [0; 5];
const OWN: [i8; 5] = [0, 1, 0, -1, 0];
const OTHER: [i8; 5] = [-1, 1, 1, 0, 0];
const AFS2: [i8; 5] = [0, -1, 0, 1, 0];

#[test]
fn an_own_row_answers_when_it_has_stood_and_flickers_as_the_symptoms_do() {
    let rows = with(&PAPER_ISOLATION, &[(4, "0 +1 0 -1 0"), (5, "-1 +1 +1 0 x")]);
    assert_eq!(answers(&rows, &[OWN, OWN, OWN, NORMAL, OWN, AFS2, AFS2]), [0, 0, 4, 0, 4, 1, 1]);
    let seldom = [[NORMAL, OWN]; 20].concat();
    assert!(answers(&rows, &seldom).iter().all(|answer| *answer == 0), "as often not as yes");
    assert_eq!(answers(&rows, &[OWN, OTHER, OTHER, OTHER, OTHER, OWN]), [0, 0, 0, 0, 5, 0]);
}

#[test]
fn meanwhile_the_papers_rows_detect() {
    let rows = with(&PAPER_DETECTION, &[(4, "+1 +1 -1 x x")]);
    let both = [1, 1, -1, 0, 0];
    assert_eq!(answers(&rows, &[both, both, both, NORMAL]), [2, 2, 4, 0]);
}
