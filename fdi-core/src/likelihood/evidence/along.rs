//! Several columns at once: how much of a change that moves them all, each by a weight of its own; and which change it was.

use super::{Freed, MOST, Nuisances, freed};
use crate::bounds::larger;
use crate::likelihood::cholesky::Cholesky;
use crate::likelihood::column::{Column, Direction};
use crate::vector::dot;

impl<const N: usize, const H: usize> Nuisances<'_, N, H> {
    /// Frees how large a change is that moves columns by these weights where it is 1, with mean and standard deviation of its prior.
    #[inline(never)]
    pub(in crate::likelihood) fn free_along<const M: usize>(
        &self,
        weights: &[(Column, f32); M],
        prior: (f32, f32),
    ) -> Freed {
        let mut shared = [0.0; MOST];
        let (mut information, mut score) = (0.0, 0.0);
        for &(column, weight) in weights {
            let theirs = self.shared(Direction::Of(column));
            shared.iter_mut().zip(&theirs).for_each(|(sum, theirs)| *sum += weight * theirs);
            score += weight * self.normal.b[column as usize % N];
            for &(other, by) in weights {
                information += weight * by * self.normal.a(column as usize, other as usize);
            }
        }
        let (information, score) =
            self.less_nuisances(&shared, self.inv_kappa * information, self.inv_kappa * score);
        freed([information, 0.0, 0.0], [score, 0.0], [prior, (0.0, 0.0)])
    }

    /// By how much each of some columns has changed, if all may have at once: posterior means, each with a prior of mean 0 and this
    /// standard deviation.
    #[inline(never)]
    pub(in crate::likelihood) fn changes<const M: usize>(&self, columns: &[(Column, f32); M]) -> [f32; M] {
        let shared: [_; M] = core::array::from_fn(|i| self.shared(Direction::Of(columns[i].0)));
        let mut rows = [[0.0; M]; M];
        let mut changes = [0.0; M];
        for (i, &(column, sd)) in columns.iter().enumerate() {
            let b = self.inv_kappa * self.normal.b[column as usize % N];
            changes[i] = sd * (b - dot(&shared[i], &self.score));
            for (j, &(other, by)) in columns.iter().enumerate().take(i + 1) {
                let a = self.inv_kappa * self.normal.a(column as usize, other as usize);
                let unit = if i == j { 1.0 } else { 0.0 };
                rows[i][j] = unit + sd * by * (a - dot(&shared[i], &shared[j]));
            }
        }
        let factor = Cholesky::new(rows, M);
        factor.forward(&mut changes);
        factor.backward(&mut changes);
        changes.iter_mut().zip(columns).for_each(|(change, (_, sd))| *change *= sd);
        changes
    }

    /// What is left of information and score beyond the nuisances, where a column shares so much with them.
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
