//! Mains that step, which nobody measures.

use super::*;

/// What the tracker takes for power.
fn followed(s: &WatchState) -> f32 {
    let mut row = [[0.0; 2]; LASTING];
    row[Regressor::Power as usize] = [1.0, 1.0];
    s.tracker.expected(&row)[0]
}

/// A step of the mains that is too small for a fault is taken over in its whole size: in the median of nine runs within a tenth of it. (One in ten is taken
/// for air. With the nuisance of the power as narrow as where nothing is known the median is 14 % too small.)
#[test]
fn a_step_of_the_mains_is_taken_over_as_power() {
    let mut errors: Vec<f32> = (51..60)
        .map(|seed| {
            let (said, s) = Run { ticks: END, ..Run::new(Wrong::Power(0.93), seed) }.run();
            assert!(said.iter().all(|said| !said.alarm()), "seed {seed}");
            (followed(&s) + 0.07).abs()
        })
        .collect();
    errors.sort_by(f32::total_cmp);
    assert!(errors[4] < 0.007, "{errors:?}");
}

/// Where steps of the mains are known to be so large, one of 14 % may be taken for something else at first, but no alarm stands.
#[test]
fn where_mains_are_restless_a_step_is_no_alarm_that_stands() {
    for seed in 61..66 {
        let run = Run { ticks: END, steps: Some(0.07), ..Run::new(Wrong::Power(0.86), seed) };
        let (said, s) = run.run();
        let ticks = said[ONSET..].iter().filter(|said| said.alarm()).count();
        let power = followed(&s);
        assert!(ticks < 150 && (power + 0.14).abs() < 0.04, "{ticks} ticks, {power}, seed {seed}");
        let calm = Run { steps: None, ..run }.said();
        assert!(
            calm[ONSET + 150..].iter().all(Said::alarm),
            "the same where the mains are calm, seed {seed}"
        );
    }
}
