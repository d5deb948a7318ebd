//! The estimate against batch least squares, and what it must refuse.

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::*;

/// Double-precision batch least squares by Householder reflections, sharing no code with the estimator.
struct Batch {
    theta: Vec<f64>,
    noise_variance: f64,
    /// Inverse of R in `Phi = Q R`.
    r_inverse: Vec<Vec<f64>>,
}

/// Minimises `sum lambda^age (y - phi' theta)^2`.
fn batch(s: &Signals, order: Order, lambda: f64) -> Batch {
    let Order { na, nb, nk } = order;
    let (n, last) = (na + nb, s.y.len() - 1);
    let mut m: Vec<Vec<f64>> = (na.max(nb + nk - 1)..=last)
        .map(|k| {
            let w = lambda.powi((last - k) as i32).sqrt();
            let outputs = (1..=na).map(|i| -s.y[k - i] * w);
            outputs.chain((0..nb).map(|i| s.u[k - nk - i] * w)).chain([s.y[k] * w]).collect()
        })
        .collect();
    for c in 0..n {
        let norm = m[c..].iter().map(|row| row[c] * row[c]).sum::<f64>().sqrt();
        let alpha = if m[c][c] > 0.0 { -norm } else { norm };
        let mut v: Vec<f64> = m[c..].iter().map(|row| row[c]).collect();
        v[0] -= alpha;
        let vv: f64 = v.iter().map(|x| x * x).sum();
        for j in c..=n {
            let dot: f64 = m[c..].iter().zip(&v).map(|(row, x)| row[j] * x).sum();
            m[c..].iter_mut().zip(&v).for_each(|(row, x)| row[j] -= 2.0 * dot / vv * x);
        }
    }
    let solve = |rhs: &dyn Fn(usize) -> f64| {
        let mut x = vec![0.0; n];
        for i in (0..n).rev() {
            let rest: f64 = (i + 1..n).map(|j| m[i][j] * x[j]).sum();
            x[i] = (rhs(i) - rest) / m[i][i];
        }
        x
    };
    let weights: Vec<f64> = (0..m.len()).map(|age| lambda.powi(age as i32)).collect();
    let (sum, squares) = (weights.iter().sum::<f64>(), weights.iter().map(|w| w * w).sum::<f64>());
    let error: f64 = m[n..].iter().map(|row| row[n] * row[n]).sum();
    Batch {
        theta: solve(&|i| m[i][n]),
        noise_variance: error / (sum - squares / sum * n as f64),
        r_inverse: (0..n).map(|column| solve(&|i| f64::from(u8::from(i == column)))).collect(),
    }
}

impl Batch {
    /// Standard deviation of `g' theta` with all weights one.
    fn sd(&self, g: &[f64]) -> f64 {
        let along = |column: &Vec<f64>| column.iter().zip(g).map(|(r, g)| r * g).sum::<f64>();
        (self.noise_variance * self.r_inverse.iter().map(|c| along(c).powi(2)).sum::<f64>()).sqrt()
    }

    fn gain(&self, na: usize) -> Uncertain {
        let a1 = 1.0 + self.theta[..na].iter().sum::<f64>();
        let value = self.theta[na..].iter().sum::<f64>() / a1;
        let slope = |i| if i < na { -value / a1 } else { 1.0 / a1 };
        let direction: Vec<f64> = (0..self.theta.len()).map(slope).collect();
        Uncertain { value, sd: self.sd(&direction) }
    }
}

/// A plant with the poles `poles`, driven by a random binary input, with white equation noise.
struct Plant<'a> {
    poles: &'a [f64],
    b: &'a [f64],
    nk: usize,
    noise: f64,
    /// Added to u and y after the fact.
    offset: (f64, f64),
}

impl Plant<'_> {
    fn a(&self) -> Vec<f64> {
        let mut p = vec![1.0];
        for pole in self.poles {
            p.push(0.0);
            for i in (1..p.len()).rev() {
                p[i] -= p[i - 1] * pole;
            }
        }
        p[1..].to_vec()
    }

    fn order(&self) -> Order {
        Order { na: self.poles.len(), nb: self.b.len(), nk: self.nk }
    }

    fn record(&self, rows: usize, seed: u64) -> Signals {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let a = self.a();
        let (mut u, mut y) = (Vec::with_capacity(rows), Vec::with_capacity(rows));
        let mut level = 40.0;
        for k in 0..rows {
            if rng.random_bool(0.2) {
                level = 80.0 - level + if level == 40.0 { 20.0 } else { 0.0 };
            }
            let past = |x: &Vec<f64>, lag: usize| k.checked_sub(lag).map_or(0.0, |i| x[i]);
            let inputs: f64 = (0..).zip(self.b).map(|(i, b)| b * past(&u, self.nk + i)).sum();
            let outputs: f64 = (1..).zip(&a).map(|(i, a)| a * past(&y, i)).sum();
            y.push(inputs - outputs + self.noise * rng.sample::<f64, _>(StandardNormal));
            u.push(level);
        }
        Signals { u, y }.minus(-self.offset.0, -self.offset.1)
    }
}

const LAG: Plant = Plant { poles: &[0.9], b: &[0.03], nk: 1, noise: 0.1, offset: (0.0, 0.0) };
const SECOND: Plant = Plant { poles: &[0.99, 0.9], b: &[0.01, 0.005], nk: 3, ..LAG };
const THIRD: Plant = Plant { poles: &[0.99, 0.95, 0.5], b: &[0.01, 0.02, -0.005], nk: 2, ..LAG };
const EIGHTH: Plant = Plant {
    poles: &[0.9, 0.8, 0.7, 0.6, 0.5, 0.2, -0.3, -0.5],
    b: &[0.1, 0.05, 0.02, -0.01, 0.03, 0.02, 0.01, -0.02],
    ..LAG
};

fn values(e: &Estimate) -> Vec<f64> {
    e.model.a.iter().chain(&e.model.b).copied().collect()
}

/// Parameters within 1e-3 of themselves or a hundredth of their standard deviation, deviations within 1 %.
fn assert_agrees(s: &Signals, order: Order) {
    let (e, expected) = (estimate(s, order, 1.0).unwrap(), batch(s, order, 1.0));
    for (i, value) in values(&e).into_iter().enumerate() {
        let mut unit = vec![0.0; order.parameters()];
        unit[i] = 1.0;
        let (exact, sd) = (expected.theta[i], expected.sd(&unit));
        let off = (value - exact).abs();
        assert!(
            off < 1e-3 * exact.abs() || off < 0.01 * sd,
            "{order:?} {i}: {value}, expected {exact} +- {sd}"
        );
        let found = e.sd[i].unwrap();
        assert!((found / sd - 1.0).abs() < 0.01, "{order:?} {i}: sd {found}, expected {sd}");
    }
    let (found, exact) = (e.static_gain.unwrap(), expected.gain(order.na));
    assert!((found.value - exact.value).abs() < 1e-3 * exact.value.abs(), "{found:?}, expected {exact:?}");
    assert!((found.sd / exact.sd - 1.0).abs() < 0.01, "{found:?}, expected {exact:?}");
    assert!((e.noise_variance / expected.noise_variance - 1.0).abs() < 1e-3);
}

#[test]
fn agrees_with_batch_least_squares_in_double_precision() {
    for noise in [0.01, 0.1, 1.0] {
        for offset in [(0.0, 0.0), (-10.0, 25.0)] {
            for plant in [LAG, SECOND, THIRD] {
                let plant = Plant { noise, offset, ..plant };
                for rows in [300, 3000] {
                    assert_agrees(&plant.record(rows, 7), plant.order());
                }
            }
        }
    }
    assert_agrees(&EIGHTH.record(3000, 7), EIGHTH.order());
}

#[test]
fn agrees_without_means_too() {
    for plant in [LAG, SECOND, THIRD] {
        let s = Plant { offset: (0.0, 200.0), ..plant }.record(2000, 3);
        assert_agrees(&s.minus(mean(&s.u), mean(&s.y)), plant.order());
    }
}

/// A step from rest that is recorded for 1.5 time constants: no mean is a steady state.
#[test]
fn the_output_at_zero_input_is_found_with_the_model() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
    let (order, rows) = (LAG.order(), 150);
    let u: Vec<f64> = (0..rows).map(|k| if k < 5 { 0.0 } else { 50.0 }).collect();
    let mut rise = vec![0.0];
    for k in 1..rows {
        rise.push(0.99 * rise[k - 1] + 0.004 * u[k - 1] + 0.01 * rng.sample::<f64, _>(StandardNormal));
    }
    let s = Signals { u, y: rise.iter().map(|rise| 23.0 + rise).collect() };
    let e = estimate_with_constant(&s, order, 1.0).unwrap();
    let (gain, zero) = (e.static_gain.unwrap(), e.output_at_zero.unwrap());
    assert!((gain.value - 0.4).abs() < 3.0 * gain.sd && gain.sd < 0.02, "{gain:?}");
    assert!((zero.value - 23.0).abs() < 3.0 * zero.sd && zero.sd < 0.5, "{zero:?}");
    let without = estimate(&s, order, 1.0).unwrap().static_gain.unwrap().value;
    assert!(without > 1.0, "an offset that is passed over falsifies the gain: {without}");
}

#[test]
fn standard_deviations_of_the_output_at_zero_are_those_of_repeated_experiments() {
    let plant = Plant { offset: (0.0, 23.0), ..LAG };
    let zeros: Vec<Uncertain> = (0..200)
        .map(|seed| estimate_with_constant(&plant.record(400, seed), plant.order(), 1.0).unwrap())
        .map(|e| e.output_at_zero.unwrap())
        .collect();
    let off = rms(&zeros.iter().map(|zero| zero.value - 23.0).collect::<Vec<_>>());
    let promised = rms(&zeros.iter().map(|zero| zero.sd).collect::<Vec<_>>());
    assert!((0.8..1.25).contains(&(off / promised)), "{off}, promised {promised}");
}

#[test]
fn forgetting_is_weighted_least_squares() {
    for lambda in [0.9, 0.98] {
        let s = THIRD.record(1000, 5);
        let (e, expected) = (estimate(&s, THIRD.order(), lambda).unwrap(), batch(&s, THIRD.order(), lambda));
        for (value, exact) in values(&e).iter().zip(&expected.theta) {
            assert!((value - exact).abs() < 1e-3 * exact.abs(), "lambda {lambda}: {value}, expected {exact}");
        }
        assert!((e.noise_variance / expected.noise_variance - 1.0).abs() < 1e-3);
    }
}

/// What a standard deviation promises: over many recordings, the estimates scatter by it.
#[test]
fn standard_deviations_are_those_of_repeated_experiments() {
    for lambda in [1.0, 0.95] {
        let estimates: Vec<Estimate> =
            (0..200).map(|seed| estimate(&LAG.record(400, seed), LAG.order(), lambda).unwrap()).collect();
        let scatter = |x: &dyn Fn(&Estimate) -> f64| {
            let x: Vec<f64> = estimates.iter().map(x).collect();
            let average = mean(&x);
            rms(&x.iter().map(|x| x - average).collect::<Vec<_>>())
        };
        let typical = |sd: &dyn Fn(&Estimate) -> f64| rms(&estimates.iter().map(sd).collect::<Vec<_>>());
        let parameter = scatter(&|e| e.model.a[0]) / typical(&|e| e.sd[0].unwrap());
        let gain = scatter(&|e| e.static_gain.unwrap().value) / typical(&|e| e.static_gain.unwrap().sd);
        for ratio in [parameter, gain] {
            assert!((0.8..1.25).contains(&ratio), "lambda {lambda}: {parameter} {gain}");
        }
    }
}

#[test]
fn what_the_data_leave_open_is_undetermined_and_what_they_tell_is_not() {
    let mut s = LAG.record(500, 1);
    s.u.fill(100.0);
    let e = estimate(&s, Order { na: 1, nb: 2, nk: 1 }, 1.0).unwrap();
    assert!(e.sd[0].is_some() && e.sd[1].is_none() && e.sd[2].is_none(), "{:?}", e.sd);
    assert!(e.static_gain.is_some()); // B(1) is told, though b1 and b2 are not
    let e = estimate(&s.minus(100.0, mean(&s.y)), LAG.order(), 1.0).unwrap();
    assert!(e.sd[0].is_some() && e.sd[1].is_none() && e.static_gain.is_none());
}

#[test]
fn a_feedback_without_delay_leaves_the_plant_open() {
    let mut s = LAG.record(500, 1);
    s.u = s.y.iter().map(|y| -0.7 * y).collect();
    let e = estimate(&s, LAG.order(), 1.0).unwrap();
    assert_eq!((&e.sd[..], e.static_gain), (&[None, None][..], None));
}

#[test]
fn differences_are_weighted_sums_of_lags() {
    let x = [5.0, -1.0, 4.0, 2.5, 7.0];
    let expected: Vec<f64> =
        (0..4).map(|i| (0..=i).map(|j| weight_in_difference(i, j) * x[4 - j]).sum()).collect();
    assert_eq!(differences(&x, 4, 4)[..4], expected);
    assert_eq!(expected[..3], [7.0, 4.5, 6.0]);
}

#[test]
fn too_little_is_refused() {
    let s = LAG.record(4, 1);
    let error = |rows: usize, lambda| {
        let s = Signals { u: s.u[..rows].to_vec(), y: s.y[..rows].to_vec() };
        estimate(&s, LAG.order(), lambda).err().map(|e| e.to_string())
    };
    assert_eq!(error(3, 1.0).unwrap(), "3 rows are too few: 2 parameters need at least 4");
    assert_eq!(error(4, 1.0), None);
    let huge = Signals { u: vec![1.0; 9], y: (0..9).map(|k| 1e200 * f64::from(k % 2)).collect() };
    assert!(estimate(&huge, LAG.order(), 1.0).unwrap_err().to_string().contains("too large"));
}
