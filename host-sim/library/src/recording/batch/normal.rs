//! Normal equations of the parameters, from which how each stretch began is taken out.

use super::plant::{PARAMETERS, STATES, State, Theta};

/// A matrix of parameters.
pub(super) type Square<const N: usize> = [[f64; N]; N];

/// Normal equations of a stretch without how it began.
pub(super) struct Reduced {
    pub(super) inverse: Square<STATES>,
    pub(super) cross: [[f64; PARAMETERS]; STATES],
    pub(super) score: State,
}

impl Reduced {
    /// Takes what the parameters share with how the stretch began out of their equations.
    pub(super) fn take_out_of(&self, normal: &mut Normal) {
        let Self { inverse, cross, score } = self;
        for i in 0..STATES {
            let part: [f64; PARAMETERS] =
                std::array::from_fn(|p| (0..STATES).map(|j| inverse[i][j] * cross[j][p]).sum());
            for p in 0..PARAMETERS {
                normal.score[p] -= part[p] * score[i];
                for q in 0..PARAMETERS {
                    normal.matrix[p][q] -= cross[i][p] * part[q];
                }
            }
        }
    }
}

/// All of them at a point.
pub(super) struct Normal {
    pub(super) matrix: Square<PARAMETERS>,
    pub(super) score: Theta,
    pub(super) parts: Vec<Reduced>,
}

/// The inverse of a symmetric matrix whose eigenvalues are above 0, by Gauss and Jordan.
pub(super) fn inverse<const N: usize>(mut a: Square<N>) -> Square<N> {
    for i in 0..N {
        let pivot = 1.0 / a[i][i];
        for k in (0..N).filter(|k| *k != i) {
            let factor = a[k][i] * pivot;
            (0..N).filter(|j| *j != i).for_each(|j| a[k][j] -= factor * a[i][j]);
            a[k][i] = -factor;
        }
        a[i].iter_mut().for_each(|x| *x *= pivot);
        a[i][i] = pivot;
    }
    a
}
