//! Several regressors at once: how much of a change that moves them all, each by a weight of its own; and which change it was.

use super::{Estimate, MOST, Nuisances, estimate};
use crate::bounds::larger;
use crate::likelihood::cholesky::Cholesky;
use crate::likelihood::regressor::{Direction, Regressor};
use crate::vector::dot;

impl<const N: usize, const H: usize> Nuisances<'_, N, H> {
    /// Frees how large a change is that moves regressors by these weights where it is 1, with mean and standard deviation of its prior.
    #[inline(never)]
    pub(in crate::likelihood) fn estimate_along<const M: usize>(
        &self,
        weights: &[(Regressor, f32); M],
        prior: (f32, f32),
    ) -> Estimate {
        let mut shared = [0.0; MOST];
        let (mut information, mut score) = (0.0, 0.0);
        for &(regressor, weight) in weights {
            let theirs = self.shared(Direction::Of(regressor));
            shared.iter_mut().zip(&theirs).for_each(|(sum, theirs)| *sum += weight * theirs);
            score += weight * self.normal.b[regressor as usize % N];
            for &(other, by) in weights {
                information += weight * by * self.normal.a(regressor as usize, other as usize);
            }
        }
        let (information, score) =
            self.less_nuisances(&shared, self.inv_kappa * information, self.inv_kappa * score);
        estimate([information, 0.0, 0.0], [score, 0.0], [prior, (0.0, 0.0)])
    }

    /// By how much each of some regressors has changed, if all may have at once: posterior means, each with a prior of mean 0 and this
    /// standard deviation. With what freeing all of them gains.
    #[inline(never)]
    pub(in crate::likelihood) fn changes<const M: usize>(
        &self,
        regressors: &[(Regressor, f32); M],
    ) -> ([f32; M], f32) {
        let shared: [_; M] = core::array::from_fn(|i| self.shared(Direction::Of(regressors[i].0)));
        let mut rows = [[0.0; M]; M];
        let mut changes = [0.0; M];
        for (i, &(regressor, sd)) in regressors.iter().enumerate() {
            let b = self.inv_kappa * self.normal.b[regressor as usize % N];
            changes[i] = sd * (b - dot(&shared[i], &self.score));
            for (j, &(other, by)) in regressors.iter().enumerate().take(i + 1) {
                let a = self.inv_kappa * self.normal.a(regressor as usize, other as usize);
                let unit = if i == j { 1.0 } else { 0.0 };
                rows[i][j] = unit + sd * by * (a - dot(&shared[i], &shared[j]));
            }
        }
        let factor = Cholesky::new(rows, M);
        factor.forward(&mut changes);
        let gain = 0.5 * dot(&changes, &changes) - 0.5 * factor.log_determinant();
        factor.backward(&mut changes);
        changes.iter_mut().zip(regressors).for_each(|(change, (_, sd))| *change *= sd);
        (changes, gain)
    }

    /// What is left of information and score beyond the nuisances, where a regressor shares so much with them.
    #[inline(never)]
    pub(super) fn less_nuisances(
        &self,
        shared: &[f32; MOST],
        mut information: f32,
        mut score: f32,
    ) -> (f32, f32) {
        for (v, y) in shared.iter().zip(&self.score) {
            information -= v * v;
            score -= v * y;
        }
        (larger(0.0, information), score)
    }
}
