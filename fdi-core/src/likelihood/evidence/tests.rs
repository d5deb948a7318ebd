extern crate std;

use std::vec;
use std::vec::Vec;

use super::super::hypothesis::{ALL_PAIRS, HYPOTHESES, PAIRS, SINCE_ONSET, SINCE_TRAINING, TAUGHT_PAIRS};
use super::super::reference::{Matrix, Random, identity, inverse, solve};
use super::super::regressor::{COUNT, Regressor, Regressors};
use super::super::taught::{EFFECTS, REGRESSORS};
use super::*;
use crate::root::sqrt;

/// Whitened residuals and signatures of some ticks.
struct Problem {
    rows: Vec<Regressors>,
    z: Vec<[f32; 2]>,
    kappa: f64,
}

/// A parameter with its prior.
#[derive(Clone, Copy)]
struct Gaussian {
    direction: Direction,
    mean: f64,
    sd: f64,
}

fn narrow(list: &[Nuisance]) -> Vec<Gaussian> {
    list.iter().map(|&(direction, sd)| Gaussian { direction, mean: 0.0, sd: f64::from(sd) }).collect()
}

fn wide(free: Prior) -> Gaussian {
    Gaussian { direction: free.direction, mean: f64::from(free.mean), sd: f64::from(free.sd) }
}

/// A direction's regressor: what it does to each residual.
fn regressor(row: &Regressors, direction: Direction, m: usize) -> f64 {
    let of = |regressor: Regressor| f64::from(row[regressor as usize][m]);
    match direction {
        Direction::Of(which) => of(which),
        Direction::Offset0 => -of(Regressor::Offset1) - of(Regressor::Offset2),
        Direction::Ramp0 => -of(Regressor::Ramp1) - of(Regressor::Ramp2),
        Direction::MidLag => 0.5 * (of(Regressor::ShortLag) + of(Regressor::LongLag)),
        Direction::MidLoss => 0.5 * (of(Regressor::ShortLoss) + of(Regressor::LongLoss)),
    }
}

/// How many standard deviations a unit of a regressor is at most on the reference rig: a rise of 12 degC in innovations of 0.03 degC.
fn largest(regressor: usize) -> f64 {
    let is = |which: &[Regressor]| which.iter().any(|which| *which as usize == regressor);
    if is(&[Regressor::Power, Regressor::LessFlow, Regressor::MoreFlow, Regressor::Gain1, Regressor::Gain2])
        || is(&[Regressor::ShortLoss, Regressor::LongLoss])
    {
        400.0
    } else if is(&[Regressor::ShortLag, Regressor::LongLag, Regressor::Wall]) {
        100.0
    } else {
        30.0
    }
}

impl Problem {
    /// Signatures with slow content, as those of faults have, and residuals with some of each; `size` times those of the reference rig.
    fn new(random: &mut Random, ticks: usize, size: f64, kappa: f64) -> Self {
        let scale: [f64; COUNT] = core::array::from_fn(|i| size * random.between(0.3, 1.0) * largest(i));
        let mut slow = [[0.0f64; 2]; COUNT];
        let (mut rows, mut z) = (Vec::new(), Vec::new());
        let truth: [f64; COUNT] = core::array::from_fn(|i| random.gaussian() / (1.0 + scale[i]));
        for _ in 0..ticks {
            let row: Regressors = core::array::from_fn(|i| {
                core::array::from_fn(|m| {
                    slow[i][m] += 0.1 * (2.0 + random.gaussian() - slow[i][m]);
                    (scale[i] * (0.4 * slow[i][m] + 0.05 * random.gaussian())) as f32
                })
            });
            z.push(core::array::from_fn(|m| {
                let seen: f64 = (0..COUNT).map(|i| truth[i] * f64::from(row[i][m])).sum();
                (random.gaussian() + seen) as f32
            }));
            rows.push(row);
        }
        Self { rows, z, kappa }
    }

    fn normal(&self) -> Normal {
        let mut normal = <Normal>::default();
        self.rows.iter().zip(&self.z).for_each(|(row, z)| normal.add(1.0, row, *z, 1.0));
        normal
    }

    /// All residuals one below the other, and the regressors of the parameters, both divided by the square root of kappa.
    fn stacked(&self, priors: &[Gaussian]) -> (Vec<f64>, Matrix) {
        let scale = 1.0 / self.kappa.sqrt();
        let places = (0..self.z.len()).flat_map(|k| [(k, 0), (k, 1)]);
        let z = places.clone().map(|(k, m)| scale * f64::from(self.z[k][m])).collect();
        let phi = places
            .map(|(k, m)| priors.iter().map(|p| scale * regressor(&self.rows[k], p.direction, m)).collect())
            .collect();
        (z, phi)
    }

    /// Quadratic forms of all residuals without parameters and with them, and the logarithm of the determinant: the joint normal
    /// distribution of all samples, its covariance built, inverted and its determinant taken as they stand.
    fn joint(&self, priors: &[Gaussian]) -> [f64; 3] {
        let (z, phi) = self.stacked(priors);
        let n = z.len();
        let mut covariance = identity(n);
        for i in 0..n {
            for j in 0..n {
                covariance[i][j] +=
                    (0..priors.len()).map(|p| phi[i][p] * priors[p].sd.powi(2) * phi[j][p]).sum::<f64>();
            }
        }
        let left: Vec<f64> = (0..n)
            .map(|i| z[i] - priors.iter().zip(&phi[i]).map(|(p, phi)| phi * p.mean).sum::<f64>())
            .collect();
        let (solved, log_det) = solve(&covariance, &left);
        [z.iter().map(|z| z * z).sum(), left.iter().zip(&solved).map(|(a, b)| a * b).sum(), log_det]
    }

    /// Log density of all residuals under the priors, less that under no parameter at all.
    fn log_evidence(&self, priors: &[Gaussian]) -> f64 {
        let [plain, quadratic, log_det] = self.joint(priors);
        0.5 * (plain - quadratic - log_det)
    }

    /// What the parameters take from the residuals' sum of squares.
    fn explained(&self, priors: &[Gaussian]) -> f64 {
        let [plain, quadratic, _] = self.joint(priors);
        self.kappa * (plain - quadratic)
    }

    /// What single precision makes of the largest numbers that a gain is the difference of: what the prior means and spreads would explain.
    fn rounding(&self, first: Prior, second: Option<Prior>) -> f64 {
        let priors: Vec<Gaussian> = [Some(first), second].into_iter().flatten().map(wide).collect();
        let (_, phi) = self.stacked(&priors);
        let square = |p: &Gaussian, phi: f64| phi * phi * (p.mean * p.mean + p.sd * p.sd);
        5e-6 * phi.iter().flat_map(|phi| priors.iter().zip(phi)).map(|(p, phi)| square(p, *phi)).sum::<f64>()
    }

    /// The same in the space of the parameters, for many samples (matrix inversion lemma); with posterior means and standard deviations.
    fn posterior(&self, priors: &[Gaussian]) -> (f64, Vec<f64>, Vec<f64>) {
        let (z, phi) = self.stacked(priors);
        let n = priors.len();
        let left: Vec<f64> = z
            .iter()
            .zip(&phi)
            .map(|(z, phi)| z - priors.iter().zip(phi).map(|(p, phi)| phi * p.mean).sum::<f64>())
            .collect();
        let (mut a, mut b) = (vec![vec![0.0; n]; n], vec![0.0; n]);
        for (left, phi) in left.iter().zip(&phi) {
            for i in 0..n {
                b[i] += phi[i] * left;
                (0..n).for_each(|j| a[i][j] += phi[i] * phi[j]);
            }
        }
        // I + S A S with S the standard deviations.
        let q: Matrix = (0..n)
            .map(|i| {
                (0..n).map(|j| f64::from(u8::from(i == j)) + priors[i].sd * a[i][j] * priors[j].sd).collect()
            })
            .collect();
        let scaled: Vec<f64> = (0..n).map(|i| priors[i].sd * b[i]).collect();
        let (solved, log_det) = solve(&q, &scaled);
        let squares = |z: &[f64]| z.iter().map(|z| z * z).sum::<f64>();
        let explained: f64 = scaled.iter().zip(&solved).map(|(a, b)| a * b).sum();
        let log_evidence = 0.5 * (squares(&z) - squares(&left) + explained - log_det);
        let covariance = inverse(&q);
        let mean = (0..n).map(|i| priors[i].mean + priors[i].sd * solved[i]).collect();
        let sd = (0..n).map(|i| priors[i].sd * covariance[i][i].sqrt()).collect();
        (log_evidence, mean, sd)
    }
}

const fn free(direction: Direction, mean: f32, sd: f32) -> Prior {
    Prior { direction, mean, sd }
}

/// T0's place among the nuisances.
const T0: usize = SINCE_ONSET.len() - 1;

/// What hypotheses free, one or two, with and without prior means.
const FREED: [(Prior, Option<Prior>); 8] = [
    (free(Direction::Of(Regressor::Gain1), 0.0, 0.25), None),
    (free(Direction::Of(Regressor::Gain1), -0.7, 0.2), None),
    (free(Direction::MidLoss, 0.0, 0.25), None),
    (free(Direction::MidLoss, 0.0, 0.25), Some(free(Direction::MidLag, 1.0, 0.15))),
    (free(Direction::Ramp0, 0.0, 3.0), None),
    (free(Direction::Of(Regressor::Constant), 40.0, 40.0), None),
    (
        free(Direction::Of(Regressor::ShortLoss), -0.7, 0.2),
        Some(free(Direction::Of(Regressor::ShortLag), 1.0, 0.15)),
    ),
    (free(Direction::Of(Regressor::Ramp1), 0.0, 3.0), Some(free(Direction::Of(Regressor::Gain2), 0.3, 0.2))),
];

fn with(list: &[Nuisance], first: Prior, second: Option<Prior>) -> Vec<Gaussian> {
    narrow(list).into_iter().chain([wide(first)]).chain(second.map(wide)).collect()
}

/// Within a share of the numbers that are subtracted.
fn close(what: &str, got: f32, wanted: f64, tolerance: f64) {
    assert!((f64::from(got) - wanted).abs() <= tolerance, "{what}: {got}, not {wanted}");
}

/// The references agree with each other: the covariance of all samples, and the space of the parameters.
#[test]
fn the_matrix_inversion_lemma_holds() {
    for seed in 1..4 {
        let problem = Problem::new(&mut Random::new(seed), 30, 0.3, 1.5);
        for (first, second) in FREED {
            let priors = with(&SINCE_ONSET, first, second);
            let (dense, (small, ..)) = (problem.log_evidence(&priors), problem.posterior(&priors));
            assert!((dense - small).abs() < 1e-6 * (1.0 + dense.abs()), "seed {seed}: {dense} {small}");
        }
    }
}

/// Log evidence of the nuisances and what each freed parameter gains, against the joint distribution of all samples.
#[test]
fn the_evidence_is_that_of_the_joint_distribution() {
    for seed in 1..25 {
        let mut random = Random::new(seed);
        let problem = Problem::new(&mut random, 25, 1.0, 1.5);
        let normal = problem.normal();
        let list: &[Nuisance] =
            [&SINCE_ONSET[..], &SINCE_TRAINING[..], &SINCE_ONSET[..3], &[]][seed as usize % 4];
        let nuisances = Nuisances::new(normal.sums(), list, 1.5);
        let alone = problem.log_evidence(&narrow(list));
        let explained = problem.explained(&narrow(list));
        close("explained", nuisances.explained, explained, 1e-4 * (1.0 + explained));
        let beyond = nuisances.beyond(&ALL_PAIRS);
        for (first, second) in FREED {
            let wanted = problem.log_evidence(&with(list, first, second)) - alone;
            let tolerance = 1e-3 * (1.0 + wanted.abs() + alone.abs()) + problem.rounding(first, second);
            close("gain", beyond.estimate(first, second).gain, wanted, tolerance);
        }
    }
}

/// Mean and standard deviation of what is freed, the second's mean, and what the nuisances are thought to be.
#[test]
fn values_are_those_of_the_posterior() {
    for seed in 31..61 {
        let problem = Problem::new(&mut Random::new(seed), 60, 1.0, 3.0);
        let normal = problem.normal();
        let nuisances = Nuisances::new(normal.sums(), &SINCE_ONSET, 3.0);
        let values = nuisances.values();
        let beyond = nuisances.beyond(&ALL_PAIRS);
        for (first, second) in FREED {
            let (_, mean, sd) = problem.posterior(&with(&SINCE_ONSET, first, second));
            let estimate = beyond.estimate(first, second);
            let [mean1, sd1] = [mean[SINCE_ONSET.len()], sd[SINCE_ONSET.len()]];
            close("value", estimate.value, mean1, 0.01 * sd1 + 1e-3 * mean1.abs());
            close("sd", sqrt(estimate.variance), sd1, 0.01 * sd1);
            if second.is_some() {
                let (mean2, sd2) = (mean[SINCE_ONSET.len() + 1], sd[SINCE_ONSET.len() + 1]);
                close("second", estimate.second, mean2, 0.01 * sd2 + 1e-3 * mean2.abs());
            }
        }
        let (_, mean, sd) = problem.posterior(&narrow(&SINCE_ONSET));
        for (i, value) in values.into_iter().enumerate() {
            // T0's error lowers both offsets.
            let (direction, _) = SINCE_ONSET[i];
            let offset =
                [Direction::Of(Regressor::Offset1), Direction::Of(Regressor::Offset2)].contains(&direction);
            let wanted = if offset { mean[i] - mean[T0] } else { mean[i] };
            close("nuisance", value, wanted, 0.02 * sd[i]);
        }
    }
}

/// A freed parameter that is a nuisance as well: what is reported is the sum of both, as the data have it.
#[test]
fn a_parameter_that_is_a_nuisance_as_well_is_the_sum_of_both() {
    for seed in 61..81 {
        let problem = Problem::new(&mut Random::new(seed), 60, 1.0, 1.5);
        let normal = problem.normal();
        let beyond = Nuisances::new(normal.sums(), &SINCE_ONSET, 1.5).beyond(&ALL_PAIRS);
        for row in HYPOTHESES.iter().filter(|row| row.second.is_none() && row.first.mean == 0.0) {
            let first = row.first;
            let Some(which) = SINCE_ONSET.iter().position(|(direction, _)| *direction == first.direction)
            else {
                continue;
            };
            // One parameter with both variances in place of the two.
            let mut priors = narrow(&SINCE_ONSET);
            let sd = priors[which].sd;
            priors[which].sd = sd.hypot(f64::from(first.sd));
            let (log_evidence, mean, sds) = problem.posterior(&priors);
            let (alone, ..) = problem.posterior(&narrow(&SINCE_ONSET));
            let estimate = beyond.estimate(first, None);
            let wanted = log_evidence - alone;
            close("gain", estimate.gain, wanted, 2e-3 * (1.0 + wanted.abs()));
            close("value", estimate.value, mean[which], 0.02 * sds[which] + 1e-3 * mean[which].abs());
            close("sd", sqrt(estimate.variance), sds[which], 0.05 * sds[which] + 0.01 * sd);
        }
    }
}

/// A thousand ticks and regressors of 400 standard deviations: f32 tells gains to a share of a unit or a per mille, sizes to a twentieth of their
/// standard deviation or a per mille.
#[test]
fn single_precision_is_enough_for_long_and_large_sums() {
    let (mut worst, mut worst_value) = (0.0f64, 0.0f64);
    for seed in 101..131 {
        let problem = Problem::new(&mut Random::new(seed), 1000, 1.0, 1.5);
        let normal = problem.normal();
        let beyond = Nuisances::new(normal.sums(), &SINCE_ONSET, 1.5).beyond(&ALL_PAIRS);
        let (alone, ..) = problem.posterior(&narrow(&SINCE_ONSET));
        for (first, second) in FREED {
            let (log_evidence, mean, sd) = problem.posterior(&with(&SINCE_ONSET, first, second));
            let estimate = beyond.estimate(first, second);
            let wanted = log_evidence - alone;
            let tolerance = 1.0 + 1e-3 * wanted.abs() + problem.rounding(first, second);
            worst = worst.max((f64::from(estimate.gain) - wanted).abs() / tolerance);
            let i = SINCE_ONSET.len();
            worst_value = worst_value
                .max((f64::from(estimate.value) - mean[i]).abs() / (0.05 * sd[i] + 1e-3 * mean[i].abs()));
        }
    }
    assert!(worst < 1.0 && worst_value < 1.0, "{worst} {worst_value}");
}

/// More nuisances than there is room for are left out, not written beside; nothing seen gains nothing but its cost.
#[test]
fn nothing_seen_gains_nothing() {
    let normal = <Normal>::default();
    let eleven = [SINCE_ONSET[0]; MOST + 2];
    let nuisances = Nuisances::new(normal.sums(), &eleven, 1.5);
    assert_eq!(nuisances.explained, 0.0);
    let beyond = nuisances.beyond(&ALL_PAIRS);
    for (first, second) in FREED {
        let estimate = beyond.estimate(first, second);
        assert_eq!(
            (estimate.gain, estimate.value, estimate.variance),
            (0.0, first.mean, first.sd * first.sd)
        );
    }
}

mod beyond;

/// Of the products of regressors only those that are asked for are formed: what hypotheses and taught faults free has the bits that it has with all.
#[test]
fn no_product_that_is_asked_for_is_left_out() {
    let normal = Problem::new(&mut Random::new(91), 60, 1.0, 1.5).normal();
    let beyond = |pairs| Nuisances::new(normal.sums(), &SINCE_ONSET, 1.5).beyond(pairs);
    let (all, asked, taught) = (beyond(&ALL_PAIRS), beyond(&PAIRS), beyond(&TAUGHT_PAIRS));
    for row in &HYPOTHESES {
        let gain = |beyond: &Beyond| beyond.estimate(row.first, row.second).gain;
        assert_eq!((gain(&asked), gain(&taught)), (gain(&all), gain(&all)), "{row:?}");
    }
    let gain = |beyond: &Beyond| beyond.among(&REGRESSORS).estimate(&[0.1; EFFECTS], (1.0, 0.2)).gain;
    assert_eq!(gain(&taught), gain(&all));
    assert!(gain(&asked) != gain(&all), "taught faults ask for more");
}
