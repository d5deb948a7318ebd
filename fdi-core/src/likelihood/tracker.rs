//! What moves slowly without being a fault yet: power, air flow and both offsets, by a Kalman filter that runs while nothing stirs.

use super::column::{Column, LASTING, Row};
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

    /// The columns of what it tracks.
    fn columns(&self) -> [usize; N] {
        let flow = if self.x[1] < 0.0 { Column::MoreFlow } else { Column::LessFlow };
        [Column::Power as usize, flow as usize, Column::Offset1 as usize, Column::Offset2 as usize]
    }

    /// What it expects of both residuals, degC.
    pub(super) fn expected(&self, row: &Row<LASTING>) -> [f32; 2] {
        let mut expected = [0.0; 2];
        for (x, column) in self.x.iter().zip(self.columns()) {
            expected[0] += x * row[column][0];
            expected[1] += x * row[column][1];
        }
        expected
    }

    /// A quiet tick: whitened columns, and what is left of the whitened residuals.
    #[inline(never)]
    pub(super) fn step(&mut self, whitened: &Row<LASTING>, z: [f32; 2]) {
        let t = &self.tuning.tracker;
        let walk = t.walk();
        for i in 0..N {
            self.p[i][i] += walk[i] * walk[i];
        }
        let columns = self.columns();
        for m in 0..2 {
            let phi = columns.map(|column| whitened[column][m]);
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
