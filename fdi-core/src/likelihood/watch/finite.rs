//! What of the watch would stay for ever if it were no number.

use super::{Gathered, WatchState};
use crate::likelihood::process::Motion;

impl WatchState {
    /// Finite as long as all of it is.
    pub(in crate::likelihood) fn sum(&self) -> f32 {
        let lists = [&self.expected, &self.z_mean, &self.swing, &self.mean, &self.stays, &self.ladder.inv_sigma];
        let lists: f32 = lists.into_iter().flatten().sum();
        let all = self.parameters.0.iter().chain(&self.wander).chain(&self.tracker.x).sum::<f32>();
        let inlet = self.inlet.map_or(0.0, |(before, mean, _)| before + mean);
        let alone = self.fan + self.steps + self.trained + self.curvature_error + inlet + self.beside.added();
        lists + all + alone + self.motion.sum() + self.tracker.sum() + self.steady.sum() + self.heat.sum()
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
