//! Sums of a linear regression: whitened residuals on whitened signatures, `A = sum phi phi'`, `b = sum phi z`.

use super::regressor::{COUNT, LASTING, Regressor, Regressors};
use crate::vector::dot;

/// Elements of the lower half of a symmetric matrix of `n` rows.
const fn half(n: usize) -> usize {
    n * (n + 1) / 2
}

/// The sums over `N` regressors, A by its lower half of `H` elements.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normal<const N: usize = COUNT, const H: usize = { half(COUNT) }> {
    a: [f32; H],
    pub(super) b: [f32; N],
    /// sum z z, and of how many z.
    pub(super) energy: f32,
    pub(super) count: f32,
}

/// Those of the regressors that are asked over a minute.
pub(super) type LastingNormal = Normal<LASTING, { half(LASTING) }>;

impl<const N: usize, const H: usize> Default for Normal<N, H> {
    fn default() -> Self {
        const { assert!(H == half(N)) };
        Self { a: [0.0; H], b: [0.0; N], energy: 0.0, count: 0.0 }
    }
}

impl<const N: usize, const H: usize> Normal<N, H> {
    /// A tick: residuals and signatures, whitened, with a weight.
    #[inline(never)]
    pub(super) fn add(&mut self, regressors: &Regressors<N>, z: [f32; 2], weight: f32) {
        let mut place = self.a.iter_mut();
        for (i, phi) in regressors.iter().enumerate() {
            let weighted = [weight * phi[0], weight * phi[1]];
            self.b[i] += weighted[0] * z[0] + weighted[1] * z[1];
            for (other, a) in regressors[..=i].iter().zip(&mut place) {
                *a += weighted[0] * other[0] + weighted[1] * other[1];
            }
        }
        self.energy += weight * (z[0] * z[0] + z[1] * z[1]);
        self.count += 2.0 * weight;
    }

    /// A tick for two sums at once, of each of which this share is kept.
    #[inline(never)]
    pub(super) fn add_to_both(
        both: [&mut Self; 2],
        keep: [f32; 2],
        regressors: &Regressors<N>,
        z: [f32; 2],
        weight: f32,
    ) {
        let [first, second] = both;
        let mut places = first.a.iter_mut().zip(&mut second.a);
        for (i, phi) in regressors.iter().enumerate() {
            let weighted = [weight * phi[0], weight * phi[1]];
            let b = weighted[0] * z[0] + weighted[1] * z[1];
            first.b[i] = first.b[i] * keep[0] + b;
            second.b[i] = second.b[i] * keep[1] + b;
            for (other, (first, second)) in regressors[..=i].iter().zip(&mut places) {
                let product = weighted[0] * other[0] + weighted[1] * other[1];
                *first = *first * keep[0] + product;
                *second = *second * keep[1] + product;
            }
        }
        for (sums, keep) in [(first, keep[0]), (second, keep[1])] {
            sums.energy = sums.energy * keep + weight * (z[0] * z[0] + z[1] * z[1]);
            sums.count = sums.count * keep + 2.0 * weight;
        }
    }

    /// All sums, `factor` times as much.
    #[inline(never)]
    pub(super) fn scale(&mut self, factor: f32) {
        self.a.iter_mut().chain(&mut self.b).for_each(|sum| *sum *= factor);
        self.energy *= factor;
        self.count *= factor;
    }

    /// Finite as long as all of them are.
    pub(super) fn sum(&self) -> f32 {
        self.a.iter().chain(&self.b).sum::<f32>() + self.energy + self.count
    }

    /// Takes away what these values of all regressors explain.
    pub(super) fn explain(&mut self, values: &[f32; N]) {
        for i in 0..N {
            let explained: f32 = (0..N).map(|j| self.a(i, j) * values[j]).sum();
            self.b[i] -= explained;
        }
    }

    /// The sums `factor` times as much, less the products of what regressors share with others and of their score: of those `pairs` only, row by row the bits
    /// of the columns.
    pub(super) fn less<const M: usize>(
        &self,
        factor: f32,
        shared: &[[f32; M]; N],
        score: &[f32; M],
        pairs: &[u32],
    ) -> Self {
        let mut left = Self { energy: self.energy, count: self.count, ..Self::default() };
        let mut row = 0;
        for (i, ((of_regressor, b), pairs)) in shared.iter().zip(&mut left.b).zip(pairs).enumerate() {
            if *pairs != 0 {
                *b = factor * self.b[i] - dot(of_regressor, score);
                let sums = self.a.get(row..).unwrap_or_default();
                let places = left.a.get_mut(row..).unwrap_or_default().iter_mut().zip(sums);
                for (j, (other, (a, all))) in shared.iter().take(i + 1).zip(places).enumerate() {
                    if pairs >> j & 1 != 0 {
                        *a = factor * *all - dot(of_regressor, other);
                    }
                }
            }
            row += i + 1;
        }
        left
    }

    /// Hands on `factor` times each element of a regressor of A, with its row.
    #[inline(always)]
    pub(super) fn add_regressor(&self, regressor: usize, factor: f32, mut to: impl FnMut(usize, f32)) {
        if factor == 0.0 {
            return;
        }
        // Left of the diagonal they stand in a row, below it each in a row of its own.
        let mut place = half(regressor);
        for i in 0..N {
            to(i, factor * self.a.get(place).copied().unwrap_or(0.0));
            place += if i < regressor { 1 } else { i + 1 };
        }
    }

    /// Forgets some regressors wholly.
    pub(super) fn forget(&mut self, regressors: &[Regressor]) {
        let forgotten = |i: usize| regressors.iter().any(|regressor| *regressor as usize == i);
        let mut place = self.a.iter_mut();
        for i in 0..N {
            for (j, a) in (0..=i).zip(&mut place) {
                if forgotten(i) || forgotten(j) {
                    *a = 0.0;
                }
            }
            if forgotten(i) {
                self.b[i] = 0.0;
            }
        }
    }

    /// sum phi_i phi_j
    #[inline]
    pub(super) fn a(&self, i: usize, j: usize) -> f32 {
        let (i, j) = if i > j { (i, j) } else { (j, i) };
        self.a.get(i * (i + 1) / 2 + j).copied().unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests;
