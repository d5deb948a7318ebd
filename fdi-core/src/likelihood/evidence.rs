//! How well does a hypothesis explain the residuals, when everything else may have moved a little, too?
//!
//! The whitened residuals are `z = sum theta_i phi_i + noise`. Nuisances have narrow priors N(0, d_i), what a hypothesis frees a wide
//! one, and all are integrated out. With A and b from [`Normal`], both divided by kappa:
//!
//! ```text
//! log evidence = b' (A + D^-1)^-1 b / 2 - log det(I + D A) / 2
//! ```
//!
//! The nuisances' part is factored once. A hypothesis borders it by its own regressors: with the information s that they hold beyond the nuisances
//! and the score r, both corrected for them, freeing one parameter with the prior N(0, v) gains
//!
//! ```text
//! r^2 / 2 (s + 1/v) - log(1 + v s) / 2
//! ```
//!
//! It is a bank of Kalman filters with Schmidt's nuisances in information form (S. F. Schmidt 1966; Bayesian linear regression). kappa is
//! above one, since residuals are never as independent as the sums take them for.

mod along;

use super::cholesky::Cholesky;
use super::hypothesis::{model_errors, nuisances_since_onset, nuisances_since_training};
use super::normal::Normal;
use super::regressor::Direction;
use super::tuning::NuisanceTuning;
use crate::bounds::larger;

/// At most so many nuisances: their cost grows with the square of this.
pub(super) const MOST: usize = 10;

// What is beyond would be left out.
const _: () = {
    let t = &NuisanceTuning::DEFAULT;
    let longest = [nuisances_since_onset(t).len(), nuisances_since_training(t).len(), model_errors(t).len()];
    assert!(
        longest[0] <= MOST && longest[1] <= MOST && longest[2] <= MOST,
        "more nuisances than there is room for: raise `MOST`"
    );
};

/// A nuisance: what may move without being a fault, and its standard deviation.
pub(super) type Nuisance = (Direction, f32);

/// The residuals as the nuisances explain them.
pub(super) struct Nuisances<'a, const N: usize, const H: usize> {
    normal: &'a Normal<N, H>,
    list: &'a [Nuisance],
    inv_kappa: f32,
    /// `L^-1` times what each regressor shares with each nuisance, where many are asked for.
    shared: Option<[[f32; MOST]; N]>,
    factor: Cholesky<MOST>,
    /// `L^-1` times the scaled b.
    score: [f32; MOST],
    /// What the nuisances alone take from the residual sum of squares.
    pub(super) explained: f32,
}

/// What a hypothesis frees: the direction, with mean and standard deviation of its prior.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prior {
    pub(super) direction: Direction,
    pub(super) mean: f32,
    pub(super) sd: f32,
}

/// What comes of freeing one or two.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Estimate {
    /// By how much the log evidence exceeds that of the nuisances alone.
    pub(super) gain: f32,
    /// The first parameter: posterior mean and variance. The second's mean.
    pub(super) value: f32,
    pub(super) variance: f32,
    pub(super) second: f32,
}

impl<'a, const N: usize, const H: usize> Nuisances<'a, N, H> {
    pub(super) fn new(normal: &'a Normal<N, H>, list: &'a [Nuisance], kappa: f32) -> Self {
        let list = if list.len() > MOST { &list[..MOST] } else { list };
        let inv_kappa = 1.0 / kappa;
        let mut rows = [[0.0; MOST]; MOST];
        let mut score = [0.0; MOST];
        for (i, ((&(p, sd), row), score)) in list.iter().zip(&mut rows).zip(&mut score).enumerate() {
            *score = sd * inv_kappa * along(&normal.b, p);
            for (j, (&(q, other), element)) in list.iter().zip(row).enumerate().take(i + 1) {
                let unit = if i == j { 1.0 } else { 0.0 };
                *element = unit + sd * other * inv_kappa * between(normal, p, q);
            }
        }
        let factor = Cholesky::new(rows, list.len());
        factor.forward(&mut score);
        let quadratic: f32 = score.iter().map(|x| x * x).sum();
        Self { normal, list, inv_kappa, shared: None, factor, score, explained: kappa * quadratic }
    }

    /// Works out once what all regressors share with the nuisances: cheaper where many hypotheses are asked.
    #[inline(never)]
    pub(super) fn for_many(mut self) -> Self {
        let mut all = [[0.0; MOST]; N];
        for (regressor, shared) in all.iter_mut().enumerate() {
            for (shared, &(q, sd)) in shared.iter_mut().zip(self.list) {
                let ([i, j], [first, second]) = (q.regressors(), q.weights());
                let mut sum = first * self.normal.a(regressor, i);
                if second != 0.0 {
                    sum += second * self.normal.a(regressor, j);
                }
                *shared = sd * self.inv_kappa * sum;
            }
            self.factor.forward(shared);
        }
        self.shared = Some(all);
        self
    }

    /// `L^-1` times what a direction shares with each nuisance.
    #[inline(never)]
    fn shared(&self, p: Direction) -> [f32; MOST] {
        let mut shared = [0.0; MOST];
        if let Some(all) = &self.shared {
            let ([i, j], [first, second]) = (p.regressors(), p.weights());
            if second == 0.0 {
                return all[i % N];
            }
            for (k, shared) in shared.iter_mut().enumerate() {
                *shared = first * all[i % N][k] + second * all[j % N][k];
            }
            return shared;
        }
        for (shared, &(q, sd)) in shared.iter_mut().zip(self.list) {
            *shared = sd * self.inv_kappa * between(self.normal, p, q);
        }
        self.factor.forward(&mut shared);
        shared
    }

    /// Information and score of a direction beyond the nuisances, with what it shares with them.
    fn beyond(&self, p: Direction) -> ([f32; MOST], f32, f32) {
        let shared = self.shared(p);
        let (information, score) = self.less_nuisances(
            &shared,
            self.inv_kappa * between(self.normal, p, p),
            self.inv_kappa * along(&self.normal.b, p),
        );
        (shared, information, score)
    }

    /// The gain in log evidence if parameters have just these values.
    pub(super) fn fixed(&self, at: &[(Direction, f32)]) -> f32 {
        let (mut gain, mut before): (f32, Option<(Direction, f32, [f32; MOST])>) = (0.0, None);
        for &(p, value) in at {
            let (shared, information, score) = self.beyond(p);
            gain += value * score - 0.5 * value * value * information;
            if let Some((q, other, theirs)) = before {
                gain -= value * other * self.common(p, &shared, q, &theirs);
            }
            before = Some((p, value, shared));
        }
        gain
    }

    fn common(&self, p: Direction, v: &[f32; MOST], q: Direction, w: &[f32; MOST]) -> f32 {
        let mut common = self.inv_kappa * between(self.normal, p, q);
        for (v, w) in v.iter().zip(w) {
            common -= v * w;
        }
        common
    }

    /// Frees one parameter, or two.
    #[inline(never)]
    pub(super) fn estimate(&self, first: Prior, second: Option<Prior>) -> Estimate {
        let (shared, s11, r1) = self.beyond(first.direction);
        let (mut s12, mut s22, mut r2) = (0.0, 0.0, 0.0);
        let (mean2, sd2) = second.map_or((0.0, 0.0), |second| (second.mean, second.sd));
        if let Some(second) = second {
            let (others, information, score) = self.beyond(second.direction);
            (s22, r2) = (information, score);
            s12 = self.common(first.direction, &shared, second.direction, &others);
        }
        let estimate = estimate([s11, s12, s22], [r1, r2], [(first.mean, first.sd), (mean2, sd2)]);
        let (value, variance) = self.with_nuisance(first, estimate.value, estimate.variance);
        Estimate { value, variance: larger(0.0, variance), ..estimate }
    }

    /// A parameter that is a nuisance as well is the sum of both parts: what the data say of the free one says as much of the sum.
    fn with_nuisance(&self, free: Prior, value: f32, variance: f32) -> (f32, f32) {
        let Some(&(_, sd)) = self.list.iter().find(|(p, _)| *p == free.direction) else {
            return (value, variance);
        };
        let (narrow, wide) = (sd * sd, free.sd * free.sd);
        let share = wide / (narrow + wide);
        let apart = narrow * share;
        let both = (variance - apart) / (share * share);
        // Less than a hundredth of what was subtracted is rounding.
        (value / share, larger(0.01 * apart * 0.01, both))
    }

    /// What the nuisances are thought to be.
    pub(super) fn values(&self) -> [f32; MOST] {
        let mut values = self.score;
        self.factor.backward(&mut values);
        for (value, (_, sd)) in values.iter_mut().zip(self.list) {
            *value *= sd;
        }
        values
    }
}

/// Frees two parameters that have this information and these scores beyond the nuisances, with mean and standard deviation of their priors.
fn estimate([s11, s12, s22]: [f32; 3], [r1, r2]: [f32; 2], priors: [(f32, f32); 2]) -> Estimate {
    let [(mean1, sd1), (mean2, sd2)] = priors;
    // What the prior means explain by themselves, and what is left to the departure from them.
    let at_means = mean1 * r1 + mean2 * r2
        - 0.5 * (mean1 * mean1 * s11 + 2.0 * mean1 * mean2 * s12 + mean2 * mean2 * s22);
    let left = [r1 - s11 * mean1 - s12 * mean2, r2 - s12 * mean1 - s22 * mean2];
    // Q = I + T S T with T the standard deviations of the priors.
    let (q11, q22, q12) = (1.0 + sd1 * sd1 * s11, 1.0 + sd2 * sd2 * s22, sd1 * sd2 * s12);
    let determinant = larger(1.0, q11 * q22 - q12 * q12);
    let scaled = [sd1 * left[0], sd2 * left[1]];
    let departure = [
        (q22 * scaled[0] - q12 * scaled[1]) / determinant,
        (q11 * scaled[1] - q12 * scaled[0]) / determinant,
    ];
    let gain = at_means + 0.5 * (departure[0] * scaled[0] + departure[1] * scaled[1])
        - 0.5 * libm::logf(determinant);
    let (value, variance) = (mean1 + sd1 * departure[0], sd1 * sd1 * q22 / determinant);
    Estimate { gain, value, variance, second: mean2 + sd2 * departure[1] }
}

/// phi_p' phi_q, summed.
#[inline(never)]
fn between<const N: usize, const H: usize>(normal: &Normal<N, H>, p: Direction, q: Direction) -> f32 {
    if let (Direction::Of(p), Direction::Of(q)) = (p, q) {
        return normal.a(p as usize, q as usize);
    }
    let mut sum = 0.0;
    for (i, weight) in p.regressors().into_iter().zip(p.weights()) {
        for (j, other) in q.regressors().into_iter().zip(q.weights()) {
            sum += weight * other * normal.a(i, j);
        }
    }
    sum
}

/// b along a direction.
#[inline]
fn along<const N: usize>(b: &[f32; N], p: Direction) -> f32 {
    let ([i, j], [first, second]) = (p.regressors(), p.weights());
    first * b[i % N] + second * b[j % N]
}

#[cfg(test)]
mod tests;
