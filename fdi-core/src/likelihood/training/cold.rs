//! The rig before its first heat.

use crate::bounds::larger;
use crate::root::sqrt;

/// Standard deviation of the offsets where they were read from the cold rig, degC.
const COLD_SD: f32 = 0.15;
const COLD_LEAST_SD: f32 = 0.05;
/// Samples over which they are read, and those of late.
const COLD_MEMORY: f32 = 100.0;
const COLD_RECENT: f32 = 20.0;
/// A rig whose rises are below this is cold, degC.
pub(super) const COLD: f32 = 3.0;

/// What T1 and T2 read above T0 while nothing heats: what thermistors differ by.
#[derive(Clone, Copy, Debug, Default)]
pub(in super::super) struct Cold {
    pub(super) samples: f32,
    mean: [f32; 2],
    recent: [f32; 2],
}

impl Cold {
    /// A tick; `resting` says that nothing heats.
    pub(in super::super) fn step(&mut self, y: [Option<f32>; 2], resting: bool) {
        let [Some(y1), Some(y2)] = y else { return };
        if !resting || larger(y1.abs(), y2.abs()) > COLD {
            self.samples = 0.0;
            return;
        }
        self.samples = (self.samples + 1.0).min(COLD_MEMORY);
        for (m, y) in [y1, y2].into_iter().enumerate() {
            self.mean[m] += (y - self.mean[m]) / self.samples;
            self.recent[m] += (y - self.recent[m]) / self.samples.min(COLD_RECENT);
        }
    }

    /// What a thermistor differs by from T0, and the standard deviation of that, degC. A trend says that it is not at rest yet.
    pub(super) fn offset(&self, m: usize) -> (f32, f32) {
        let trend = (self.recent[m] - self.mean[m]).abs();
        (self.recent[m], larger(COLD_LEAST_SD, COLD_SD / sqrt(self.samples.min(COLD_RECENT))) + trend)
    }
}
