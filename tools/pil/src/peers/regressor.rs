//! What every estimator is fed: the recorded rise of T1 and the power, in the instrument's scale.

use crate::recording::Row;

/// A typical rise in degC and a typical power in %: the instrument's.
const SCALES: (f32, f32) = (12.5, 41.7);

/// Past outputs, negative, then past inputs, half of each: the regressor of an ARX model of order n/2.
#[derive(Clone, Debug)]
pub struct Regressor<const N: usize> {
    /// As the estimators take it.
    pub phi: [f32; N],
}

impl<const N: usize> Default for Regressor<N> {
    fn default() -> Self {
        Self { phi: [0.0; N] }
    }
}

impl<const N: usize> Regressor<N> {
    /// y of this tick, scaled; 0 where there is none.
    pub fn output(&self, row: &Row) -> f32 {
        if row.rise[0].is_finite() { row.rise[0] / SCALES.0 } else { 0.0 }
    }

    /// Makes this tick the newest of the past.
    pub fn shift(&mut self, row: &Row) {
        let newest = -self.output(row);
        self.phi.rotate_right(1);
        self.phi[0] = newest;
        self.phi[N / 2] = row.power / SCALES.1;
    }
}
