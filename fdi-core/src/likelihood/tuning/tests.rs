use super::*;

/// What is judged by rises is asked of more than what the bank calls out of the tube, and what is derived of one number is derived of it with any.
#[test]
fn hypotheses_follow_the_numbers() {
    let t = Tuning::DEFAULT;
    assert!(t.heat.unexplained > t.hypotheses.seen());
    let rows = hypothesis::rows(&t);
    let other = Tuning { hypotheses: HypothesisTuning { offset_sd: 4.0, ..t.hypotheses }, ..t };
    let changed =
        hypothesis::rows(&other).iter().zip(&rows).filter(|(new, old)| new.first.sd != old.first.sd).count();
    assert_eq!(changed, 3, "offsets of T0, T1, T2");
}
