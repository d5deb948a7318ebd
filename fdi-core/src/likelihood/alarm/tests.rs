use super::*;
use crate::likelihood::reference::Random;
use crate::likelihood::watch::tests::trained;

const SEEDS: core::ops::Range<u64> = 1..21;
/// From this tick on the fault is gone.
const END: usize = 200;

/// The tick on which an alarm ends that says that T2 reads 1.5 degC too high, where what each tick adds to the residuals of both is `error`.
fn ends(seed: u64, error: impl Fn(usize) -> [f32; 2]) -> Option<usize> {
    let (t, filter, mut random) = (Tuning::DEFAULT, trained(seed).whitening, Random::new(seed));
    let mut alarm = Alarm::new(&t.naming, 0);
    let (mut of_fault, mut of_error) = (Past::default(), Past::default());
    let says = [0.0, 1.5];
    (0..END + 100).find(|&tick| {
        let [shows, expected] = [filter.step(&mut of_error, error(tick)), filter.step(&mut of_fault, says)];
        let z = shows.map(|shows| shows + random.gaussian() as f32);
        alarm.follow(&t, &filter, z, [says, expected]);
        alarm.is_over(&t.alarm)
    })
}

#[test]
fn the_end_of_a_fault_is_told_on_the_second_tick() {
    for seed in SEEDS {
        let end = ends(seed, |tick| [0.0, if tick < END { 1.5 } else { 0.0 }]);
        assert_eq!(end, Some(END + 1), "seed {seed}");
    }
}

/// A sample that is 3 degC too low is further from the fault than from nothing.
#[test]
fn a_spike_is_no_end() {
    for seed in SEEDS {
        let end = ends(seed, |tick| [0.0, if tick == END - 50 { -1.5 } else { 1.5 }]);
        assert_eq!(end, None, "seed {seed}");
    }
}

/// Two faults, of which the alarm's hypothesis is a compromise: nothing is nearer to what is seen than it is, and fits no better. It ends with both.
#[test]
fn what_has_never_fitted_ends_only_where_nothing_fits() {
    for seed in SEEDS {
        let end = ends(seed, |tick| if tick < END { [1.0, 0.6] } else { [0.0; 2] });
        assert!(end.is_some_and(|end| (END..END + 20).contains(&end)), "seed {seed}: {end:?}");
    }
}
