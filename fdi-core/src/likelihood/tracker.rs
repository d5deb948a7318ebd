//! What moves slowly without being a fault yet: power, air flow and both offsets, by a Kalman filter that runs while nothing stirs.

use super::regressor::{LASTING, Regressor, Regressors};
use super::tuning::Tuned;

const N: usize = 4;

/// The filter's memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tracker {
    pub(super) x: [f32; N],
    p: [[f32; N]; N],
    tuning: Tuned,
}

impl Tracker {
    /// Of what has not moved yet.
    pub(super) fn new(tuning: Tuned) -> Self {
        let first = tuning.tracker.first();
        let mut p = [[0.0; N]; N];
        for i in 0..N {
            p[i][i] = first[i] * first[i];
        }
        Self { x: [0.0; N], p, tuning }
    }

    /// The regressors of what it tracks.
    fn regressors(&self) -> [usize; N] {
        let flow = if self.x[1] < 0.0 { Regressor::MoreFlow } else { Regressor::LessFlow };
        [Regressor::Power as usize, flow as usize, Regressor::Offset1 as usize, Regressor::Offset2 as usize]
    }

    /// What it expects of both residuals, degC.
    pub(super) fn expected(&self, regressors: &Regressors<LASTING>) -> [f32; 2] {
        let mut expected = [0.0; 2];
        for (x, regressor) in self.x.iter().zip(self.regressors()) {
            expected[0] += x * regressors[regressor][0];
            expected[1] += x * regressors[regressor][1];
        }
        expected
    }

    /// A quiet tick: whitened regressors, and what is left of the whitened residuals.
    #[inline(never)]
    pub(super) fn step(&mut self, whitened: &Regressors<LASTING>, z: [f32; 2]) {
        let t = &self.tuning.tracker;
        let walk = t.walk();
        for i in 0..N {
            self.p[i][i] += walk[i] * walk[i];
        }
        let regressors = self.regressors();
        for m in 0..2 {
            let phi = regressors.map(|regressor| whitened[regressor][m]);
            let gain: [f32; N] = core::array::from_fn(|i| (0..N).map(|j| self.p[i][j] * phi[j]).sum());
            let variance = t.noise + (0..N).map(|i| phi[i] * gain[i]).sum::<f32>();
            let inverse = 1.0 / variance;
            for i in 0..N {
                self.x[i] += gain[i] * inverse * z[m];
                for j in 0..N {
                    self.p[i][j] -= gain[i] * gain[j] * inverse;
                }
            }
        }
    }

    /// Finite as long as all of it is.
    pub(super) fn sum(&self) -> f32 {
        self.x.iter().chain(self.p.iter().flatten()).sum()
    }

    /// Less sure by these standard deviations.
    pub(super) fn widen(&mut self, by: [f32; N]) {
        for i in 0..N {
            self.p[i][i] += by[i] * by[i];
        }
    }
}

#[cfg(test)]
mod tests;
