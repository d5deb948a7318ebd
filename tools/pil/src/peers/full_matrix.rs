//! Straight from the formulae, on arrays.

use super::{LAMBDA, P_INITIAL};

/// `k = P phi / (lambda + phi' P phi)`, `theta += k e`, `P = (P - k phi' P) / lambda`, with the whole of P.
#[derive(Clone, Debug)]
pub struct FullMatrix<const N: usize> {
    /// Parameters.
    pub theta: [f32; N],
    p: [[f32; N]; N],
}

impl<const N: usize> Default for FullMatrix<N> {
    fn default() -> Self {
        let p = core::array::from_fn(|i| core::array::from_fn(|j| if i == j { P_INITIAL } else { 0.0 }));
        Self { theta: [0.0; N], p }
    }
}

impl<const N: usize> FullMatrix<N> {
    /// One sample; gives the prediction made before it.
    pub fn step(&mut self, phi: &[f32; N], y: f32) -> f32 {
        let (mut p_phi, mut phi_p) = ([0.0; N], [0.0; N]);
        for i in 0..N {
            for j in 0..N {
                p_phi[i] += self.p[i][j] * phi[j];
                phi_p[j] += phi[i] * self.p[i][j];
            }
        }
        let (mut alpha, mut prediction) = (LAMBDA, 0.0);
        for i in 0..N {
            alpha += phi[i] * p_phi[i];
            prediction += phi[i] * self.theta[i];
        }
        for i in 0..N {
            let gain = p_phi[i] / alpha;
            self.theta[i] += gain * (y - prediction);
            for j in 0..N {
                self.p[i][j] = (self.p[i][j] - gain * phi_p[j]) / LAMBDA;
            }
        }
        prediction
    }
}
