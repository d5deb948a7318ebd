//! Cholesky's factor of small symmetric matrices, and the triangular systems with it.

use crate::root::sqrt;

/// A pivot below this share of its diagonal is rounding.
const LEAST_PIVOT: f32 = 1e-6;

/// Lower triangular factor of a matrix, in place of its lower half; its diagonal is kept inverted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cholesky<const N: usize> {
    l: [[f32; N]; N],
}

impl<const N: usize> Cholesky<N> {
    /// Of nothing yet; factored as it is, the unit matrix.
    pub(super) const NOTHING: Self = Self { l: [[0.0; N]; N] };

    /// Factors the lower half.
    pub(super) fn new(l: [[f32; N]; N]) -> Self {
        let mut factor = Self { l };
        factor.factor();
        factor
    }

    /// The lower half, to be filled before it is factored: where it stays, since a copy would cost as much as filling it.
    pub(super) fn rows(&mut self) -> &mut [[f32; N]; N] {
        &mut self.l
    }

    /// Factors the lower half in its place. Pivots that are lost in rounding are held at the least that is none.
    #[inline(never)]
    pub(super) fn factor(&mut self) {
        let l = &mut self.l;
        for i in 0..N {
            for j in 0..i {
                let mut sum = l[i][j];
                for k in 0..j {
                    sum -= l[i][k] * l[j][k];
                }
                l[i][j] = sum * l[j][j];
            }
            let diagonal = l[i][i];
            let mut pivot = diagonal;
            for k in 0..i {
                pivot -= l[i][k] * l[i][k];
            }
            let least = LEAST_PIVOT * diagonal;
            if !(pivot > least) {
                pivot = if least > 0.0 { least } else { 1.0 };
            }
            l[i][i] = 1.0 / sqrt(pivot);
        }
    }

    /// Logarithm of the determinant of what was factored.
    pub(super) fn log_determinant(&self) -> f32 {
        let diagonal = (0..N).map(|i| self.l[i][i]);
        -2.0 * diagonal.map(libm::logf).sum::<f32>()
    }

    /// `L^-1 x`, in place.
    #[inline(never)]
    pub(super) fn forward(&self, x: &mut [f32; N]) {
        for i in 0..N {
            let mut sum = x[i];
            for k in 0..i {
                sum -= self.l[i][k] * x[k];
            }
            x[i] = sum * self.l[i][i];
        }
    }

    /// The same of the first `columns` of those that stand side by side in rows, `AT_ONCE` at a time: each element of the factor is loaded once for
    /// all of these. The rest of the last block is solved for as well.
    #[inline(never)]
    pub(super) fn forward_all<const AT_ONCE: usize, const C: usize>(
        &self,
        rows: &mut [[f32; C]; N],
        columns: usize,
    ) {
        const { assert!(C.is_multiple_of(AT_ONCE)) };
        for from in (0..C).step_by(AT_ONCE).take_while(|from| *from < columns) {
            for i in 0..N {
                let mut sums: [f32; AT_ONCE] = core::array::from_fn(|m| rows[i][from + m]);
                for k in 0..i {
                    let l = self.l[i][k];
                    for m in 0..AT_ONCE {
                        sums[m] -= l * rows[k][from + m];
                    }
                }
                for m in 0..AT_ONCE {
                    rows[i][from + m] = sums[m] * self.l[i][i];
                }
            }
        }
    }

    /// `L'^-1 x`, in place.
    #[inline(never)]
    pub(super) fn backward(&self, x: &mut [f32; N]) {
        for i in (0..N).rev() {
            let mut sum = x[i];
            for k in i + 1..N {
                sum -= self.l[k][i] * x[k];
            }
            x[i] = sum * self.l[i][i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `A x` with the solution gives the right-hand side back.
    #[test]
    fn it_solves_what_it_factors() {
        let a = [[4.0, 0.0, 0.0], [2.0, 5.0, 0.0], [1.0, 3.0, 6.0]];
        let full = |i: usize, j: usize| if i > j { a[i][j] } else { a[j][i] };
        let factor = Cholesky::new(a);
        let mut x = [1.0, -2.0, 3.0];
        factor.forward(&mut x);
        factor.backward(&mut x);
        for (i, wanted) in [1.0, -2.0, 3.0].into_iter().enumerate() {
            let sum: f32 = (0..3).map(|j| full(i, j) * x[j]).sum();
            assert!((sum - wanted).abs() < 1e-5, "{i}: {sum}");
        }
    }

    #[test]
    fn several_are_solved_as_one_is() {
        let factor = Cholesky::new([[4.0, 0.0, 0.0], [2.0, 5.0, 0.0], [1.0, 3.0, 6.0]]);
        let columns = [[1.0, -2.0, 3.0], [0.5, 4.0, -1.0], [7.0; 3], [9.0; 3]];
        let mut rows = [[0.0; 4]; 3];
        (0..3).for_each(|i| rows[i] = columns.map(|column| column[i]));
        factor.forward_all::<2, 4>(&mut rows, 2);
        for (c, mut column) in columns.into_iter().enumerate() {
            if c < 2 {
                factor.forward(&mut column);
            }
            assert_eq!(rows.map(|row| row[c]), column, "{c}");
        }
    }

    #[test]
    fn what_is_singular_stays_finite() {
        let factor = Cholesky::new([[1.0, 0.0], [1.0, 1.0]]);
        let mut x = [1.0, 2.0];
        factor.forward(&mut x);
        factor.backward(&mut x);
        assert!(x.iter().all(|x| x.is_finite()));
        let none = Cholesky::new([[0.0; 2]; 2]);
        assert!(none.l.iter().flatten().all(|l| l.is_finite()));
    }
}
