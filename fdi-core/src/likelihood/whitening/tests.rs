extern crate std;

use std::vec;
use std::vec::Vec;

use super::super::reference::{Random, solve};
use super::*;

/// Coefficients of the process that makes the residuals, and the standard deviations of what drives it, degC.
const A: [f64; 3] = [0.7, -0.2, 0.1];
const B: [f64; 3] = [0.5, 0.1, -0.1];
const C: [f64; 5] = [0.3, 0.4, -0.2, 0.1, 0.05];
const S: [f64; 2] = [0.09, 0.05];
const MEAN: [f64; 2] = [0.05, -0.03];

/// Residuals as coloured as those of a rig, with means.
fn coloured(random: &mut Random, n: usize) -> Vec<[f64; 2]> {
    let mut e: Vec<[f64; 2]> = vec![[0.0; 2]; n + 5];
    for k in 5..n + 5 {
        let own1: f64 = (0..3).map(|i| A[i] * e[k - 1 - i][0]).sum();
        e[k][0] = own1 + S[0] * random.gaussian();
        let own2: f64 = (0..3).map(|i| B[i] * e[k - 1 - i][1]).sum();
        let other: f64 = (0..5).map(|j| C[j] * e[k - j][0]).sum();
        e[k][1] = own2 + other + S[1] * random.gaussian();
    }
    e[5..].iter().map(|e| [e[0] + MEAN[0], e[1] + MEAN[1]]).collect()
}

/// Outputs that vary so much that any residual is small beside them.
fn output(k: usize) -> [f32; 2] {
    [if k % 20 < 10 { 10.0 } else { 14.0 }; 2]
}

fn statistics(e: impl IntoIterator<Item = [f32; 2]>) -> ResidualStatistics {
    let mut statistics = ResidualStatistics::default();
    e.into_iter().enumerate().for_each(|(k, e)| statistics.push(e, output(k)));
    statistics
}

fn learnt(e: &[[f64; 2]]) -> WhiteningFilter {
    statistics(e.iter().map(|e| e.map(|e| e as f32)))
        .finish(&WhiteningTuning::DEFAULT, 2)
        .expect("a noise model")
}

/// Least squares over the sequence itself, its means taken away and the ridge added, in f64: coefficients and standard deviation of what is left.
fn least_squares(
    e: &[[f64; 2]],
    n: usize,
    regressor: impl Fn(&[[f64; 2]], usize) -> (Vec<f64>, f64),
) -> (Vec<f64>, f64) {
    let count = e.len() as f64;
    let mean: [f64; 2] = core::array::from_fn(|m| e.iter().map(|e| e[m]).sum::<f64>() / count);
    let e: Vec<[f64; 2]> = e.iter().map(|e| [e[0] - mean[0], e[1] - mean[1]]).collect();
    let (mut a, mut b) = (vec![vec![0.0; n]; n], vec![0.0; n]);
    for k in 5..e.len() {
        let (phi, y) = regressor(&e, k);
        for i in 0..n {
            b[i] += phi[i] * y;
            (0..n).for_each(|j| a[i][j] += phi[i] * phi[j]);
        }
    }
    (0..n).for_each(|i| a[i][i] *= f64::from(WhiteningTuning::DEFAULT.ridge));
    let (c, _) = solve(&a, &b);
    let left = |k: usize| {
        let (phi, y) = regressor(&e, k);
        y - (0..n).map(|i| c[i] * phi[i]).sum::<f64>()
    };
    let squares: f64 = (5..e.len()).map(|k| left(k) * left(k)).sum();
    (c, (squares / (count - 5.0)).sqrt())
}

#[test]
fn the_coefficients_are_those_of_least_squares() {
    let e = coloured(&mut Random::new(1), 20_000);
    let whitening = learnt(&e);
    let own = |e: &[[f64; 2]], k: usize| ((1..=3).map(|i| e[k - i][0]).collect::<Vec<_>>(), e[k][0]);
    let joint = |e: &[[f64; 2]], k: usize| {
        let phi = (1..=3).map(|i| e[k - i][1]).chain((0..5).map(|j| e[k - j][0]));
        (phi.collect::<Vec<_>>(), e[k][1])
    };
    let (c1, s1) = least_squares(&e, 3, own);
    let (c2, s2) = least_squares(&e, 8, joint);
    let got1 = whitening.own1;
    let got2: Vec<f32> = whitening.own2.into_iter().chain(whitening.other).collect();
    for (got, wanted) in got1.iter().zip(&c1).chain(got2.iter().zip(&c2)) {
        assert!((f64::from(*got) - wanted).abs() < 1e-3, "{got1:?} {got2:?}, not {c1:?} {c2:?}");
    }
    for (sigma, wanted) in whitening.sigma.into_iter().zip([s1, s2]) {
        assert!((f64::from(sigma) / wanted - 1.0).abs() < 2e-3, "{sigma}, not {wanted}");
    }
    // And those that made it, as far as so many samples tell.
    for (got, wanted) in got1.iter().zip(A).chain(got2.iter().zip(B.into_iter().chain(C))) {
        assert!((f64::from(*got) - wanted).abs() < 0.04, "{got1:?} {got2:?}");
    }
    for m in 0..2 {
        assert_eq!(whitening.inv_sigma[m], 1.0 / whitening.sigma[m]);
    }
}

/// Samples that the model has not seen: variance one, white, and z2 knows nothing of z1 now and lately.
#[test]
fn what_comes_out_is_white_and_uncorrelated() {
    let whitening = learnt(&coloured(&mut Random::new(2), 20_000));
    let (mut past, n) = (Past::default(), 20_000);
    let z: Vec<[f64; 2]> = coloured(&mut Random::new(3), n + 10)
        .iter()
        .map(|e| whitening.step(&mut past, [(e[0] - MEAN[0]) as f32, (e[1] - MEAN[1]) as f32]).map(f64::from))
        .skip(10)
        .collect();
    let correlation =
        |a: usize, b: usize, lag: usize| (lag..n).map(|k| z[k][a] * z[k - lag][b]).sum::<f64>() / n as f64;
    let most = 4.0 / (n as f64).sqrt();
    for m in 0..2 {
        assert!((correlation(m, m, 0) - 1.0).abs() < 0.04, "variance {}", correlation(m, m, 0));
        for lag in 1..8 {
            assert!(
                correlation(m, m, lag).abs() < most,
                "z{} at lag {lag}: {}",
                m + 1,
                correlation(m, m, lag)
            );
        }
    }
    for lag in 0..8 {
        assert!(correlation(1, 0, lag).abs() < most, "at lag {lag}: {}", correlation(1, 0, lag));
    }
}

/// Residuals that are nothing, constant, equal, or one a multiple of the other: a model that is given is finite.
#[test]
fn what_is_singular_stays_finite() {
    let mut random = Random::new(4);
    let noise: Vec<f32> = (0..2000).map(|_| 0.1 * random.gaussian() as f32).collect();
    let cases: [(&str, Vec<[f32; 2]>); 5] = [
        ("nothing", vec![[0.0; 2]; 2000]),
        ("constants", vec![[3.0, -0.7]; 2000]),
        ("equal", noise.iter().map(|e| [*e; 2]).collect()),
        ("opposite", noise.iter().map(|e| [*e, -2.0 * e]).collect()),
        ("a sine", (0..2000u16).map(|k| [(0.3 * f32::from(k)).sin(); 2]).collect()),
    ];
    for (name, e) in cases {
        let Ok(whitening) = statistics(e.iter().copied()).finish(&WhiteningTuning::DEFAULT, 2) else {
            assert_eq!(name, "constants", "refused");
            continue;
        };
        let mut past = Past::default();
        for e in &e {
            let z = whitening.step(&mut past, *e);
            assert!(z.iter().all(|z| z.abs() < 1e4), "{name}: {z:?}");
        }
        assert!(whitening.sigma.iter().all(|sigma| *sigma >= WhiteningTuning::DEFAULT.least_sigma), "{name}");
    }
}

/// Nothing learnt, no numbers, an output that does not move, residuals as large as it: none is a noise model.
#[test]
fn what_explains_too_little_is_refused() {
    assert_eq!(
        ResidualStatistics::default().finish(&WhiteningTuning::DEFAULT, 2).err(),
        Some(RejectReason::PoorFit)
    );
    let mut random = Random::new(5);
    let mut still = ResidualStatistics::default();
    (0..500).for_each(|_| still.push([random.gaussian() as f32; 2], [12.0; 2]));
    assert_eq!(still.finish(&WhiteningTuning::DEFAULT, 2).err(), Some(RejectReason::PoorFit));
    // The output's standard deviation is 2 degC: 0.6 of its variance is the bound.
    for (sd, refused) in [(1.4, false), (1.7, true)] {
        let e = (0..5000).map(|_| [sd * random.gaussian() as f32, 0.1]);
        assert_eq!(statistics(e).finish(&WhiteningTuning::DEFAULT, 2).is_err(), refused, "{sd} degC");
    }
    for wild in [f32::NAN, f32::INFINITY, f32::MAX] {
        let e = (0..500).map(|k| [if k == 250 { wild } else { 0.1 }; 2]);
        assert!(statistics(e).finish(&WhiteningTuning::DEFAULT, 2).is_err(), "{wild}");
    }
}

/// A spike of a thousand standard deviations counts once: what follows differs by no more than the limit's echo.
#[test]
fn a_clipped_spike_leaves_no_echo() {
    let whitening = learnt(&coloured(&mut Random::new(6), 20_000));
    let limit = 6.0;
    let without_mean = |e: &[f64; 2]| [(e[0] - MEAN[0]) as f32, (e[1] - MEAN[1]) as f32];
    let e: Vec<[f32; 2]> = coloured(&mut Random::new(7), 60).iter().map(without_mean).collect();
    let run = |spike: f32, clipped: bool| -> Vec<[f32; 2]> {
        let mut past = Past::default();
        let spiked =
            e.iter().enumerate().map(|(k, e)| if k == 30 { [e[0] + spike, e[1] + spike] } else { *e });
        let step = |e| {
            if clipped {
                whitening.step_clipped(&mut past, e, [limit; 2])
            } else {
                whitening.step(&mut past, e)
            }
        };
        spiked.map(step).collect()
    };
    let (quiet, spiked, plain) = (run(0.0, true), run(100.0, true), run(100.0, false));
    assert!(spiked[30][0] == limit, "{:?}", spiked[30]);
    for k in 31..60 {
        for m in 0..2 {
            assert!((spiked[k][m] - quiet[k][m]).abs() < 2.5 * limit, "{k}: {:?} {:?}", spiked[k], quiet[k]);
        }
    }
    assert!((31..34).any(|k| plain[k][0].abs() > 100.0), "unclipped it does");
    for (clipped, plain) in quiet.iter().zip(&run(0.0, false)) {
        let apart = (clipped[0] - plain[0]).abs() + (clipped[1] - plain[1]).abs();
        assert!(apart < 1e-3, "within the limit nothing is changed: {clipped:?} {plain:?}");
    }
}

/// A level that is taken out of the past as well is gone without a step.
#[test]
fn lowering_the_past_takes_a_level_out() {
    let whitening = learnt(&coloured(&mut Random::new(8), 20_000));
    let e: Vec<[f32; 2]> = coloured(&mut Random::new(9), 40).iter().map(|e| e.map(|e| e as f32)).collect();
    let level = [0.8f32, -0.5];
    let (mut never, mut taken) = (Past::default(), Past::default());
    for (k, e) in e.iter().enumerate() {
        if k == 20 {
            taken.lower(level);
        }
        let above = |m: usize| if k < 20 { e[m] + level[m] } else { e[m] };
        let wanted = whitening.step(&mut never, *e);
        let z = whitening.step(&mut taken, [above(0), above(1)]);
        if k >= 20 {
            assert!((z[0] - wanted[0]).abs() + (z[1] - wanted[1]).abs() < 1e-3, "{k}: {z:?} {wanted:?}");
        }
    }
}

#[test]
fn means_and_levels_are_those_of_the_samples() {
    let statistics = statistics((0..400u16).map(|k| [0.01 * f32::from(k), -0.5]));
    assert!((statistics.mean()[0] - 1.995).abs() < 1e-4 && (statistics.mean()[1] + 0.5).abs() < 1e-5);
    assert!((statistics.level(0) - 12.0).abs() < 1e-4, "{}", statistics.level(0));
}
