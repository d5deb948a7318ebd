//! Time update of the Kalman filter for parameters that walk at random, on the factors: `U D U' <- U D U' + r1 I`.
//!
//! Modified weighted Gram-Schmidt on the rows of `[U I]` with the weights `(D, r1)`; no subtraction of covariances, so D
//! stays positive. Source: C. L. Thornton, G. J. Bierman, "Gram-Schmidt algorithms for covariance propagation", 1975.

/// Adds `r1` to each parameter's variance.
pub(crate) fn propagate<const N: usize>(u: &mut [[f32; N]; N], d: &mut [f32; N], r1: f32) {
    let mut left = *u; // the rows of U, its unit diagonal made explicit
    let mut right = [[0.0; N]; N]; // the rows of I
    for i in 0..N {
        left[i][i] = 1.0;
        right[i][i] = 1.0;
        for j in 0..i {
            left[i][j] = 0.0;
        }
    }
    let weight = *d;
    for j in (0..N).rev() {
        let mut norm = 0.0;
        for k in 0..N {
            norm += left[j][k] * left[j][k] * weight[k] + right[j][k] * right[j][k] * r1;
        }
        d[j] = norm;
        let inv_norm = 1.0 / norm;
        for i in 0..j {
            let mut dot = 0.0;
            for k in 0..N {
                dot += left[i][k] * weight[k] * left[j][k] + right[i][k] * r1 * right[j][k];
            }
            let factor = dot * inv_norm;
            u[i][j] = factor;
            for k in 0..N {
                left[i][k] -= factor * left[j][k];
                right[i][k] -= factor * right[j][k];
            }
        }
    }
}
