use super::super::reference::{Matrix, Random};
use super::super::regressor::LASTING;
use super::*;
use crate::likelihood::tuning::{NuisanceTuning, TrackerTuning, Tuning};

const TUNING: TrackerTuning = TrackerTuning::DEFAULT;

/// Standard deviations at the start.
fn first() -> [f32; N] {
    NuisanceTuning::DEFAULT.tracked()
}

/// Whitened regressors as on the reference rig, some of them moving: power, both secants of the air flow, offsets.
fn row(random: &mut Random) -> Regressors<LASTING> {
    let mut row = [[0.0; 2]; LASTING];
    let mut put = |regressor: Regressor, a: f32, b: f32| row[regressor as usize] = [a, b];
    let mut moving = |mean: f64| (mean + 3.0 * random.gaussian()) as f32;
    put(Regressor::Power, moving(60.0), moving(40.0));
    put(Regressor::LessFlow, moving(70.0), moving(55.0));
    put(Regressor::MoreFlow, moving(50.0), moving(35.0));
    put(Regressor::Offset1, 5.0, -2.0);
    put(Regressor::Offset2, 0.0, 4.0);
    row
}

/// The textbook's filter, one measurement at a time, with full matrices in f64.
struct Kalman {
    x: [f64; N],
    p: Matrix,
}

impl Kalman {
    fn new() -> Self {
        let diagonal = |i: usize, j: usize| if i == j { f64::from(first()[i]).powi(2) } else { 0.0 };
        Self { x: [0.0; N], p: (0..N).map(|i| (0..N).map(|j| diagonal(i, j)).collect()).collect() }
    }

    fn step(&mut self, whitened: &Regressors<LASTING>, z: [f32; 2]) {
        let flow = if self.x[1] < 0.0 { Regressor::MoreFlow } else { Regressor::LessFlow };
        let regressors = [Regressor::Power, flow, Regressor::Offset1, Regressor::Offset2];
        for i in 0..N {
            self.p[i][i] += f64::from(TUNING.walk * first()[i]).powi(2);
        }
        for m in 0..2 {
            let phi = regressors.map(|regressor| f64::from(whitened[regressor as usize][m]));
            let p_phi: [f64; N] = core::array::from_fn(|i| (0..N).map(|j| self.p[i][j] * phi[j]).sum());
            let variance = f64::from(TUNING.noise) + (0..N).map(|i| phi[i] * p_phi[i]).sum::<f64>();
            for i in 0..N {
                self.x[i] += p_phi[i] / variance * f64::from(z[m]);
                for j in 0..N {
                    self.p[i][j] -= p_phi[i] * p_phi[j] / variance;
                }
            }
        }
    }
}

fn positive_definite(tracker: &Tracker) -> bool {
    (1..=N).all(|n| {
        let leading: Matrix = (0..n).map(|i| (0..n).map(|j| f64::from(tracker.p[i][j])).collect()).collect();
        // The sign of each leading minor, by its pivots.
        let mut a = leading;
        for i in 0..n {
            if !(a[i][i] > 0.0) {
                return false;
            }
            for k in i + 1..n {
                let factor = a[k][i] / a[i][i];
                for j in i..n {
                    let above = a[i][j];
                    a[k][j] -= factor * above;
                }
            }
        }
        true
    })
}

#[test]
fn it_is_the_kalman_filter_of_the_textbook() {
    let (mut tracker, mut wanted, mut random) =
        (Tracker::new(Default::default()), Kalman::new(), Random::new(1));
    for k in 0..3000 {
        let (row, z) = (row(&mut random), [random.gaussian() as f32, random.gaussian() as f32]);
        // A residual that the offset of T1 explains, so that something is learnt.
        let shifted = [z[0] + if k > 500 { 0.5 } else { 0.0 }, z[1]];
        tracker.step(&row, shifted);
        wanted.step(&row, shifted);
        for i in 0..N {
            let sd = wanted.p[i][i].sqrt();
            assert!(
                (f64::from(tracker.x[i]) - wanted.x[i]).abs() < 0.02 * sd,
                "tick {k}: {:?} {:?}",
                tracker.x,
                wanted.x
            );
            assert!((f64::from(tracker.p[i][i]) / wanted.p[i][i] - 1.0).abs() < 0.01, "tick {k}, {i}");
        }
    }
}

/// A power that sags by 3 % within ten minutes, and an offset of T2 that grows: which of both it is may stay open, but little of it is left.
#[test]
fn what_changes_slowly_is_followed() {
    let (mut tracker, mut random) = (Tracker::new(Default::default()), Random::new(2));
    let (mut left, mut all) = (0.0, 0.0);
    for k in 0..6000 {
        let row = row(&mut random);
        let share = k as f32 / 6000.0;
        let truth = [-0.03 * share, 0.0, 0.0, 0.4 * share];
        let z: [f32; 2] = core::array::from_fn(|m| {
            let seen =
                truth[0] * row[Regressor::Power as usize][m] + truth[3] * row[Regressor::Offset2 as usize][m];
            all += seen * seen;
            random.gaussian() as f32 + seen
        });
        let expected = tracker.expected(&row);
        tracker.step(&row, [z[0] - expected[0], z[1] - expected[1]]);
        let missed = [0, 1].map(|m| {
            let seen =
                truth[0] * row[Regressor::Power as usize][m] + truth[3] * row[Regressor::Offset2 as usize][m];
            seen - expected[m]
        });
        left += missed[0] * missed[0] + missed[1] * missed[1];
    }
    assert!(left < 0.1 * all, "{left} of {all} is not followed");
}

/// A million quiet ticks: rounding neither makes the covariance indefinite nor lets it leave what the equations settle at.
#[test]
fn a_million_quiet_ticks_leave_it_positive_definite() {
    let (mut tracker, mut random) = (Tracker::new(Default::default()), Random::new(3));
    let rows: [Regressors<LASTING>; 16] = core::array::from_fn(|_| row(&mut random));
    for k in 0..1_000_000 {
        let z = [(k % 7) as f32 - 3.0, (k % 5) as f32 - 2.0].map(|z| 0.5 * z);
        tracker.step(&rows[k % 16], z);
        if k % 10_000 == 0 {
            assert!(positive_definite(&tracker), "tick {k}: {:?}", tracker.p);
        }
    }
    assert!(tracker.x.iter().all(|x| x.is_finite()));
    for i in 0..N {
        assert!(tracker.p[i][i] <= first()[i] * first()[i] * 4.0, "{:?}", tracker.p);
        for j in 0..i {
            let scale = (tracker.p[i][i] * tracker.p[j][j]).sqrt();
            assert!((tracker.p[i][j] - tracker.p[j][i]).abs() < 1e-3 * scale, "symmetric");
        }
    }
}

#[test]
fn widening_adds_variances_and_nothing_else() {
    let mut tracker = Tracker::new(Default::default());
    tracker.widen([0.1, 0.0, 0.3, 0.0]);
    for (i, by) in [0.1, 0.0, 0.3, 0.0].into_iter().enumerate() {
        let wanted = first()[i] * first()[i] + by * by;
        assert!((tracker.p[i][i] - wanted).abs() < 1e-7);
    }
    assert_eq!(tracker.x, [0.0; N]);
}

/// What comes and goes is usual on this rig; a loss that grows for a day and stays excuses nothing.
#[test]
fn a_level_is_no_walk() {
    let mean = LowPass::over(1000.0);
    let after = |power: &dyn Fn(f32) -> f32| {
        let mut tracker = Tracker::new(Default::default());
        for k in 0..20_000 {
            tracker.x[0] = power(k as f32);
            tracker.remember(&mean);
        }
        libm::sqrtf(tracker.walk()[0])
    };
    let swings = after(&|k| 0.1 * libm::sinf(k / 100.0));
    let ages = after(&|k| -0.2 * k / 20_000.0);
    assert!(swings > 0.06 && ages < 0.015, "{swings} {ages}");
}

/// What came and went is usual, up to what mains do.
#[test]
fn what_has_passed_is_usual_within_bounds() {
    let mut tracker = Tracker::new(Default::default());
    for (quantity, size, place, usual) in [
        (Quantity::Power, 0.05, 0, 0.05),
        (Quantity::Power, 0.02, 0, 0.05),
        (Quantity::Power, 0.5, 0, Tuning::DEFAULT.alarm.least_flow),
        (Quantity::Flow, 0.03, 1, 0.03),
        (Quantity::Offset, 0.03, 2, 0.0),
    ] {
        tracker.learn(quantity, size);
        assert!((libm::sqrtf(tracker.walk()[place]) - usual).abs() < 1e-6, "{quantity:?} {size}");
    }
}

/// What is left of the trained state is known at once, and no more sure than at the start.
#[test]
fn it_returns_to_what_is_left() {
    let (mut tracker, mut random) = (Tracker::new(Default::default()), Random::new(4));
    for _ in 0..500 {
        let row = row(&mut random);
        tracker.step(&row, [2.0, 1.0]);
    }
    let row = row(&mut random);
    let before = tracker.expected(&row);
    let change = tracker.return_to([0.05, 0.01, 0.2, -0.1], &row);
    let after = tracker.expected(&row);
    assert_eq!(tracker.x, [0.05, 0.01, 0.2, -0.1]);
    assert!((0..2).all(|m| (before[m] + change[m] - after[m]).abs() < 1e-4));
    assert!((0..N).all(|i| tracker.p[i][i] == first()[i] * first()[i]));
}
