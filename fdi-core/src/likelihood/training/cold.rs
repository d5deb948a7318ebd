//! The rig before its first heat.

use crate::bounds::larger;
use crate::likelihood::tuning::Tuning;
use crate::root::sqrt;

/// What T1 and T2 read above T0 while nothing heats: what thermistors differ by.
#[derive(Clone, Copy, Debug, Default)]
pub(in super::super) struct Cold {
    pub(super) samples: f32,
    mean: [f32; 2],
    recent: [f32; 2],
}

impl Cold {
    /// A tick; `resting` says that nothing heats.
    pub(in super::super) fn step(&mut self, t: &Tuning, y: [Option<f32>; 2], resting: bool) {
        let [Some(y1), Some(y2)] = y else { return };
        if !resting || larger(y1.abs(), y2.abs()) > t.cold.below {
            self.samples = 0.0;
            return;
        }
        self.samples = (self.samples + 1.0).min(t.cold.memory);
        for (m, y) in [y1, y2].into_iter().enumerate() {
            self.mean[m] += (y - self.mean[m]) / self.samples;
            self.recent[m] += (y - self.recent[m]) / self.samples.min(t.cold.recent);
        }
    }

    /// What a thermistor differs by from T0, and the standard deviation of that, degC. A trend says that it is not at rest yet.
    pub(super) fn offset(&self, t: &Tuning, m: usize) -> (f32, f32) {
        let trend = (self.recent[m] - self.mean[m]).abs();
        (self.recent[m], t.sensors.noise / sqrt(self.samples.min(t.cold.recent)) + trend)
    }
}
