//! What of the watch would stay for ever if it were no number.

use super::{Gathered, WatchState};
use crate::likelihood::process::Motion;

impl WatchState {
    /// Finite as long as all of it is.
    pub(in crate::likelihood) fn sum(&self) -> f32 {
        let lists = [
            &self.expected,
            &self.z_mean,
            &self.swing,
            &self.mean,
            &self.at_onset,
            &self.whitening.inv_sigma,
        ];
        let lists: f32 = lists.into_iter().flatten().sum();
        let all = self.parameters.0.iter().chain(&self.walk_variance).chain(&self.tracker.x).sum::<f32>();
        let inlet = self.inlet.map_or(0.0, |(before, mean, _)| before + mean);
        let alone = self.fan + self.steps + self.trained + self.curvature_error + inlet + self.beside.added();
        lists + all + alone + self.motion.sum() + self.tracker.sum() + self.steady.sum() + self.heat.sum()
    }
}

#[cfg(test)]
impl WatchState {
    /// A bit of the memory has flipped, and what was a number is none; how many such places there are to choose from.
    pub(in crate::likelihood) fn spoil(&mut self, which: usize) -> usize {
        let places = [
            &mut self.motion.x,
            &mut self.motion.m[1],
            &mut self.motion.w[0],
            &mut self.parameters.0[3],
            &mut self.process.gain[0],
            &mut self.flows[1].lag[0],
            &mut self.whitening.inv_sigma[1],
            &mut self.mean[0],
            &mut self.power,
            &mut self.tracker.x[2],
            &mut self.walk_variance[3],
            &mut self.steps,
            &mut self.swing[0],
            &mut self.steady.mean_e[1],
            &mut self.fan,
        ];
        let count = places.len();
        if let Some(place) = places.into_iter().nth(which) {
            *place = f32::NAN;
        }
        count
    }
}

impl Gathered {
    /// Finite as long as all of it is.
    pub(in crate::likelihood) fn sum(&self) -> f32 {
        self.since.sum()
    }
}

impl Motion {
    /// Finite as long as all of it is; the air brings the rest of it to these.
    pub(in crate::likelihood) fn sum(&self) -> f32 {
        self.x + self.m[0] + self.m[1] + self.w[0] + self.w[1]
    }
}
