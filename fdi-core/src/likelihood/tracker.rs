//! What moves slowly without being a fault yet: power, air flow and both offsets, by a Kalman filter that runs while nothing stirs.

use super::class::Quantity;
use super::regressor::{LASTING, Regressor, Regressors};
use super::tuning::Tuned;
use crate::bounds::{bounded, larger, smaller};
use crate::filter::LowPass;
use crate::vector::sum;

const N: usize = 4;

/// The filter's memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tracker {
    x: [f32; N],
    p: [[f32; N]; N],
    /// Means of what it has followed, power, air flow and both offsets, and mean squares of what came and went around them.
    level: [f32; N],
    walk: [f32; N],
    /// Mean squares of the steps of the power that it took over, up and down.
    steps: [f32; 2],
    tuning: Tuned,
}

impl Tracker {
    /// Of what has not moved yet.
    pub(super) fn new(tuning: Tuned) -> Self {
        let first = tuning.nuisances.tracked();
        let mut p = [[0.0; N]; N];
        for i in 0..N {
            p[i][i] = first[i] * first[i];
        }
        let step = tuning.nuisances.onset_power;
        Self { x: [0.0; N], p, level: [0.0; N], walk: [0.0; N], steps: [step * step; 2], tuning }
    }

    /// Begins anew; how much things move here stays known.
    pub(super) fn resume(&mut self) {
        *self = Self { level: self.level, walk: self.walk, steps: self.steps, ..Self::new(self.tuning) };
    }

    /// Mean squares of what it has followed around their means, which excuse nothing: power, air flow and both offsets.
    pub(super) fn walk(&self) -> [f32; N] {
        self.walk
    }

    /// Mean square of the steps of the power that it took over: those one way only are no mains, but a fault that grows.
    pub(super) fn steps(&self) -> f32 {
        smaller(self.steps[0], self.steps[1])
    }

    /// All is as trained but for this: power, air flow, offsets of T1 and T2. Gives by how much it expects more of the residuals for it, degC.
    pub(super) fn return_to(&mut self, x: [f32; N], regressors: &Regressors<LASTING>) -> [f32; 2] {
        let before = self.expected(regressors);
        self.resume();
        self.x = x;
        let after = self.expected(regressors);
        [after[0] - before[0], after[1] - before[1]]
    }

    /// A tick without an alarm: how far it has gone counts for what is usual here.
    pub(super) fn remember(&mut self, mean: &LowPass) {
        for ((level, square), x) in self.level.iter_mut().zip(&mut self.walk).zip(self.x) {
            mean.follow(level, x);
            let away = x - *level;
            mean.follow(square, away * away);
        }
    }

    /// A change of this size has come and gone by itself, seen against the trained state.
    pub(super) fn learn(&mut self, quantity: Quantity, size: f32) {
        let square = match quantity {
            Quantity::Power => &mut self.walk[0],
            Quantity::Flow => &mut self.walk[1],
            Quantity::Nothing | Quantity::Offset | Quantity::Ramp | Quantity::Rise => return,
        };
        let size = bounded(size, 0.0, self.tuning.alarm.least_flow);
        *square = larger(*square, size * size);
    }

    /// Takes over what the nuisances since an onset are thought to be: power, air flow, offsets of T1 and T2. Gives by how much it expects more of the
    /// residuals for it, degC.
    pub(super) fn take_over(&mut self, by: [f32; N], regressors: &Regressors<LASTING>) -> [f32; 2] {
        let before = self.expected(regressors);
        let (t, power) = (self.tuning, by[0]);
        let square = &mut self.steps[usize::from(power < 0.0)];
        *square += t.alarm.mean_share * (power * power - *square);
        *square = larger(t.nuisances.onset_power * t.nuisances.onset_power, *square);
        for (x, by) in self.x.iter_mut().zip(by) {
            *x += by;
        }
        let [power, _, offset, _] = t.nuisances.tracked();
        self.widen([power, 0.0, offset, offset]);
        let after = self.expected(regressors);
        [after[0] - before[0], after[1] - before[1]]
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
        for (i, size) in self.tuning.nuisances.tracked().into_iter().enumerate() {
            self.p[i][i] += t.walk * size * (t.walk * size);
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
        sum(&self.x) + sum(self.p.as_flattened()) + sum(&self.level) + sum(&self.walk) + sum(&self.steps)
    }

    /// Adds process noise with these standard deviations.
    pub(super) fn widen(&mut self, by: [f32; N]) {
        for i in 0..N {
            self.p[i][i] += by[i] * by[i];
        }
    }
}

#[cfg(test)]
impl Tracker {
    /// Steps of the power are known to be so large, a share.
    pub(super) fn know_steps(&mut self, size: f32) {
        self.steps = [size * size; 2];
    }

    /// Places of the memory that a bit may flip in.
    pub(super) fn places(&mut self) -> [&mut f32; 3] {
        [&mut self.x[2], &mut self.walk[3], &mut self.steps[0]]
    }
}

#[cfg(test)]
mod tests;
