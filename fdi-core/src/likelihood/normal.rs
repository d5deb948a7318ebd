//! Sums of a linear regression: whitened residuals on whitened signatures, `A = sum phi phi'`, `b = sum phi z`.

use super::regressor::{COUNT, FIRST_FREED, FREED, LASTING, Regressor, Regressors};
use crate::vector::sum;

/// Elements of the lower half of a symmetric matrix of `n` rows.
const fn half(n: usize) -> usize {
    n * (n + 1) / 2
}

/// Row `i` of a lower half whose rows before it have been taken.
#[inline]
fn next_row<'a>(rows: &mut &'a mut [f32], i: usize) -> &'a mut [f32] {
    let (row, rest) = core::mem::take(rows).split_at_mut_checked(i + 1).unwrap_or_default();
    *rows = rest;
    row
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
        Self::NOTHING
    }
}

impl<const N: usize, const H: usize> Normal<N, H> {
    /// Those of no tick.
    pub(super) const NOTHING: Self = {
        assert!(H == half(N));
        Self { a: [0.0; H], b: [0.0; N], energy: 0.0, count: 0.0 }
    };

    /// A tick: residuals and signatures, whitened, with a weight. This share of what was there is kept.
    #[inline(never)]
    pub(super) fn add(&mut self, keep: f32, regressors: &Regressors<N>, z: [f32; 2], weight: f32) {
        let mut rows = &mut self.a[..];
        for (i, phi) in regressors.iter().enumerate() {
            let weighted = [weight * phi[0], weight * phi[1]];
            self.b[i] = self.b[i] * keep + (weighted[0] * z[0] + weighted[1] * z[1]);
            for (other, a) in regressors.iter().zip(next_row(&mut rows, i)) {
                *a = *a * keep + (weighted[0] * other[0] + weighted[1] * other[1]);
            }
        }
        self.energy = self.energy * keep + weight * (z[0] * z[0] + z[1] * z[1]);
        self.count = self.count * keep + 2.0 * weight;
    }

    /// Finite as long as all of them are.
    pub(super) fn sum(&self) -> f32 {
        sum(&self.a) + sum(&self.b) + self.energy + self.count
    }

    /// Takes away what these values of all regressors explain.
    pub(super) fn explain(&mut self, values: &[f32; N]) {
        for i in 0..N {
            let explained: f32 = (0..N).map(|j| self.a(i, j) * values[j]).sum();
            self.b[i] -= explained;
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

    /// Puts sum phi_i phi_j, where j is not above i.
    #[inline]
    pub(super) fn put(&mut self, i: usize, j: usize, sum: f32) {
        if let Some(a) = self.a.get_mut(half(i) + j) {
            *a = sum;
        }
    }

    /// sum phi_i phi_j
    #[inline]
    pub(super) fn a(&self, i: usize, j: usize) -> f32 {
        self.sums().a(i, j)
    }

    /// The sums as they are read.
    #[inline]
    pub(super) fn sums(&self) -> Sums<'_> {
        Sums { a: &self.a, b: &self.b }
    }
}

/// The sums over however many regressors: one code reads all of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums<'a> {
    a: &'a [f32],
    b: &'a [f32],
}

impl Sums<'_> {
    /// sum phi_i phi_j; 0 where there is no such regressor.
    #[inline]
    pub(super) fn a(&self, i: usize, j: usize) -> f32 {
        let (i, j) = if i > j { (i, j) } else { (j, i) };
        self.a.get(half(i) + j).copied().unwrap_or(0.0)
    }

    /// How many regressors.
    #[inline]
    pub(super) fn regressors(&self) -> usize {
        self.b.len()
    }

    /// sum phi_i z
    #[inline]
    pub(super) fn b(&self, i: usize) -> f32 {
        self.b.get(i).copied().unwrap_or(0.0)
    }

    /// The sums of a regressor with those up to itself.
    #[inline]
    pub(super) fn row(&self, i: usize) -> &[f32] {
        self.a.get(half(i)..).and_then(|from| from.get(..i + 1)).unwrap_or_default()
    }

    /// Adds `factor` times the sums of a regressor with each that can be freed.
    #[inline(never)]
    pub(super) fn add_freed(&self, regressor: usize, factor: f32, to: &mut [f32; FREED]) {
        // Up to itself they stand in its row, from there on each in a row of its own.
        let row = self.row(regressor).get(FIRST_FREED..).unwrap_or_default();
        to.iter_mut().zip(row).for_each(|(to, a)| *to += factor * a);
        let mut i = FIRST_FREED + row.len();
        let mut place = half(i) + regressor;
        for to in to.iter_mut().skip(row.len()) {
            *to += factor * self.a.get(place).copied().unwrap_or(0.0);
            i += 1;
            place += i;
        }
    }
}

#[cfg(test)]
mod tests;
