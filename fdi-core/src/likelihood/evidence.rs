//! How well does a hypothesis explain the residuals, when everything else may have moved a little, too?
//!
//! The whitened residuals are `z = sum theta_i phi_i + noise`. Nuisances have narrow priors N(0, d_i), what a hypothesis frees a wide
//! one, and all are integrated out. With A and b from [`Normal`], both divided by kappa:
//!
//! ```text
//! log evidence = b' (A + D^-1)^-1 b / 2 - log det(I + D A) / 2
//! ```
//!
//! The nuisances' part is factored once, and what they share with all regressors is taken out of A and b (a Schur complement). What is left
//! is the information s of each direction beyond the nuisances, and its score r. Freeing one parameter with the prior N(0, v) gains
//!
//! ```text
//! r^2 / 2 (s + 1/v) - log(1 + v s) / 2
//! ```
//!
//! It is a bank of Kalman filters with Schmidt's nuisances in information form (S. F. Schmidt 1966; Bayesian linear regression). kappa is
//! above one, since residuals are never as independent as the sums take them for.

mod beyond;

use super::cholesky::Cholesky;
use super::hypothesis::{Pairs, model_errors, nuisances_since_onset, nuisances_since_training};
use super::normal::Normal;
use super::regressor::Direction;
use super::tuning::NuisanceTuning;
use crate::bounds::larger;
use crate::vector::dot;
pub(super) use beyond::Beyond;

/// At most so many nuisances: their cost grows with the square of this.
pub(super) const MOST: usize = 10;

/// Regressors that are solved for at once: as many sums as there are registers for.
const AT_ONCE: usize = 4;

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
    /// What each regressor shares with each nuisance, scaled by that one's standard deviation.
    shared: [[f32; MOST]; N],
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
        let inv_kappa = 1.0 / kappa;
        let mut shared = [[0.0; MOST]; N];
        let mut score = [0.0; MOST];
        for (k, (&(p, sd), score)) in list.iter().zip(&mut score).enumerate() {
            *score = sd * inv_kappa * along(&normal.b, p);
            for (regressor, weight) in p.regressors().into_iter().zip(p.weights()) {
                normal.add_regressor(regressor, sd * inv_kappa * weight, |i, a| shared[i][k] += a);
            }
        }
        // I + D A D by its lower half.
        let mut rows = [[0.0; MOST]; MOST];
        rows.iter_mut().enumerate().for_each(|(k, row)| row[k] = 1.0);
        for (k, (&(q, sd), row)) in list.iter().zip(&mut rows).enumerate() {
            for (regressor, weight) in q.regressors().into_iter().zip(q.weights()) {
                if weight != 0.0 {
                    let ours = shared[regressor % N].iter().take(k + 1);
                    row.iter_mut().zip(ours).for_each(|(element, a)| *element += sd * weight * a);
                }
            }
        }
        let factor = Cholesky::new(rows);
        factor.forward(&mut score);
        Self { normal, list, inv_kappa, shared, factor, score, explained: kappa * dot(&score, &score) }
    }

    /// What regressors hold beyond the nuisances, of these pairs: [`Pairs`](super::hypothesis::Pairs).
    #[inline(always)]
    pub(super) fn beyond(mut self, pairs: &Pairs) -> Beyond<N, H> {
        let mut narrow = [0.0; Direction::COUNT];
        self.list.iter().for_each(|(direction, sd)| narrow[direction.place()] = *sd);
        Beyond { narrow, left: self.left(pairs) }
    }

    /// The sums less what the nuisances share with them. It uses up what they share.
    #[inline(never)]
    fn left(&mut self, pairs: &Pairs) -> Normal<N, H> {
        let (blocks, rest) = self.shared.as_chunks_mut::<AT_ONCE>();
        blocks.iter_mut().for_each(|block| self.factor.forward_all(block));
        rest.iter_mut().for_each(|shared| self.factor.forward(shared));
        self.normal.less(self.inv_kappa, &self.shared, &self.score, pairs)
    }

    /// The gain in log evidence if parameters have just these values: of one direction that moves all of them.
    #[inline(never)]
    pub(super) fn fixed(&self, at: &[(Direction, f32)]) -> f32 {
        let (mut shared, mut score, mut information) = ([0.0; MOST], 0.0, 0.0);
        for &(p, value) in at {
            score += value * along(&self.normal.b, p);
            for &(q, other) in at {
                information += value * other * between(self.normal, p, q);
            }
            for (regressor, weight) in p.regressors().into_iter().zip(p.weights()) {
                let theirs = &self.shared[regressor % N];
                shared.iter_mut().zip(theirs).for_each(|(sum, a)| *sum += value * weight * a);
            }
        }
        self.factor.forward(&mut shared);
        let information = larger(0.0, self.inv_kappa * information - dot(&shared, &shared));
        self.inv_kappa * score - dot(&shared, &self.score) - 0.5 * information
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
