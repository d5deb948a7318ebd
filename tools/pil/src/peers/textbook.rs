//! As a textbook prints it, with a matrix library.

use nalgebra::{RealField, SMatrix, SVector};

use super::{LAMBDA, P_INITIAL};

/// `k = P phi / (lambda + phi' P phi)`, `theta += k e`, `P = (I - k phi') P / lambda`, in single or double precision.
#[derive(Clone, Debug)]
pub struct Textbook<T, const N: usize> {
    /// Parameters.
    pub theta: SVector<T, N>,
    p: SMatrix<T, N, N>,
    lambda: T,
}

impl<T: RealField + Copy, const N: usize> Default for Textbook<T, N> {
    fn default() -> Self {
        let number = |x: f32| nalgebra::convert::<f64, T>(f64::from(x));
        Self { theta: SVector::zeros(), p: SMatrix::identity() * number(P_INITIAL), lambda: number(LAMBDA) }
    }
}

impl<T: RealField + Copy, const N: usize> Textbook<T, N> {
    /// One sample; gives the prediction made before it.
    pub fn step(&mut self, phi: &[T; N], y: T) -> T {
        let phi = SVector::<T, N>::from_column_slice(phi);
        let prediction = phi.dot(&self.theta);
        let p_phi = self.p * phi;
        let gain = p_phi / (self.lambda + phi.dot(&p_phi));
        self.theta += gain * (y - prediction);
        self.p = (SMatrix::identity() - gain * phi.transpose()) * self.p / self.lambda;
        prediction
    }
}
