//! What the regressors hold beyond the nuisances, and what comes of freeing some of them.

use super::{Estimate, Prior, along, between};
use crate::bounds::larger;
use crate::likelihood::cholesky::Cholesky;
use crate::likelihood::normal::Normal;
use crate::likelihood::regressor::{COUNT, Direction, Regressor};
use crate::vector::dot;

/// The sums of the regression, divided by kappa, less what the nuisances share with them.
pub(in crate::likelihood) struct Beyond {
    /// Standard deviation of the nuisance of each direction; 0 where there is none.
    pub(super) narrow: [f32; Direction::COUNT],
    pub(super) left: Normal,
}

impl Beyond {
    /// Frees one parameter, or two.
    #[inline(never)]
    pub(in crate::likelihood) fn estimate(&self, first: Prior, second: Option<Prior>) -> Estimate {
        let (p, left) = (first.direction, self.left.sums());
        let (mut s12, mut s22, mut r2, mut prior2) = (0.0, 0.0, 0.0, (0.0, 0.0));
        if let Some(second) = second {
            let q = second.direction;
            (s12, s22, r2) = (between(left, p, q), between(left, q, q), along(left, q));
            prior2 = (second.mean, second.sd);
        }
        let information = [larger(0.0, between(left, p, p)), s12, larger(0.0, s22)];
        let estimate = estimate(information, [along(left, p), r2], [(first.mean, first.sd), prior2]);
        let (value, variance) = self.with_nuisance(first, estimate.value, estimate.variance);
        Estimate { value, variance: larger(0.0, variance), ..estimate }
    }

    /// A parameter that is a nuisance as well is the sum of both parts: what the data say of the free one says as much of the sum.
    fn with_nuisance(&self, free: Prior, value: f32, variance: f32) -> (f32, f32) {
        let sd = self.narrow[free.direction.place()];
        if sd == 0.0 {
            return (value, variance);
        }
        let (narrow, wide) = (sd * sd, free.sd * free.sd);
        let share = wide / (narrow + wide);
        let apart = narrow * share;
        let both = (variance - apart) / (share * share);
        // Less than a hundredth of what was subtracted is rounding.
        (value / share, larger(0.01 * apart * 0.01, both))
    }

    /// What some regressors hold beyond the nuisances, for changes that move all of these together.
    #[inline(never)]
    pub(in crate::likelihood) fn among<const M: usize>(&self, regressors: &[Regressor; M]) -> Among<M> {
        let mut among = Among { information: [[0.0; M]; M], score: [0.0; M] };
        for (i, &regressor) in regressors.iter().enumerate() {
            let regressor = regressor as usize;
            among.score[i] = self.left.b[regressor % COUNT];
            // Both halves in the lower one: a product of two regressors counts twice.
            for (j, &other) in regressors.iter().enumerate().take(i) {
                among.information[i][j] = 2.0 * self.left.a(regressor, other as usize);
            }
            among.information[i][i] = self.left.a(regressor, regressor);
        }
        among
    }

    /// By how much each of some regressors has changed, if all may have at once: posterior means, each with a prior of mean 0 and this
    /// standard deviation. With what freeing all of them gains.
    #[inline(never)]
    pub(in crate::likelihood) fn changes<const M: usize>(
        &self,
        regressors: &[(Regressor, f32); M],
    ) -> ([f32; M], f32) {
        let mut rows = [[0.0; M]; M];
        let mut changes = [0.0; M];
        for (i, &(regressor, sd)) in regressors.iter().enumerate() {
            changes[i] = sd * self.left.b[regressor as usize % COUNT];
            for (j, &(other, by)) in regressors.iter().enumerate().take(i + 1) {
                let unit = if i == j { 1.0 } else { 0.0 };
                rows[i][j] = unit + sd * by * self.left.a(regressor as usize, other as usize);
            }
        }
        let factor = Cholesky::new(rows);
        factor.forward(&mut changes);
        let gain = 0.5 * dot(&changes, &changes) - 0.5 * factor.log_determinant();
        factor.backward(&mut changes);
        changes.iter_mut().zip(regressors).for_each(|(change, (_, sd))| *change *= sd);
        (changes, gain)
    }
}

/// Information and score of some regressors: see [`Beyond::among`].
pub(in crate::likelihood) struct Among<const M: usize> {
    information: [[f32; M]; M],
    score: [f32; M],
}

impl<const M: usize> Among<M> {
    /// Frees how large a change is that moves the regressors by these weights where it is 1, with mean and standard deviation of its prior.
    #[inline(never)]
    pub(in crate::likelihood) fn estimate(&self, weights: &[f32; M], prior: (f32, f32)) -> Estimate {
        let (mut information, mut score) = (0.0, 0.0);
        for (i, (weight, row)) in weights.iter().zip(&self.information).enumerate() {
            if *weight != 0.0 {
                score += weight * self.score[i];
                let across: f32 = row.iter().zip(weights).take(i + 1).map(|(a, by)| a * by).sum();
                information += weight * across;
            }
        }
        estimate([larger(0.0, information), 0.0, 0.0], [score, 0.0], [prior, (0.0, 0.0)])
    }
}

/// Frees two parameters that have this information and these scores beyond the nuisances, with mean and standard deviation of their priors.
#[inline]
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
