//! What moves slowly without being a fault yet.

use super::tuning;

tuning! {
    /// The tracker: a Kalman filter of power, air flow and both offsets (docs/diagnosis.md, section 7).
    pub struct TrackerTuning: tracker {
        /// Standard deviation of the power at the start, and when it has taken over what nuisances explain.
        first_power = 0.01, "1", chosen "";
        /// The same of the air flow at the start, 1/f - 1.
        first_flow = 0.005, "1", chosen "";
        /// The same of both offsets, as of the power.
        first_offset = 0.1, "degC", chosen "";
        /// Process noise: random walk of the power in a tick, for a rig that answers within some ten ticks.
        walk_power = 0.0002, "1", measured "a faster tracker swallows drifts (docs/diagnosis.md, section 16)";
        /// The same of the air flow, 1/f - 1.
        walk_flow = 0.00008, "1", measured "the same";
        /// The same of both offsets.
        walk_offset = 0.0008, "degC", measured "the same";
        /// Variance of a whitened residual, as the filter takes it: it is slower for it.
        noise = 3.0, "1", chosen "";
        /// It runs while all charts are below this share of their decision intervals.
        below = 0.4, "1", measured "prototype 1, configuration J";
        /// Share of a new step of the power in what is known of their size.
        step_share = 0.2, "1", chosen "";
        /// What creeps in and goes by itself is usual here up to this share of power, and of air flow.
        passing = 0.06, "1", chosen "mains within 3 %";
    }
}

impl TrackerTuning {
    /// Standard deviations at the start: power, air flow, both offsets.
    #[inline(always)]
    pub(in crate::likelihood) fn first(&self) -> [f32; 4] {
        [self.first_power, self.first_flow, self.first_offset, self.first_offset]
    }

    /// Process noise of each.
    #[inline(always)]
    pub(in crate::likelihood) fn walk(&self) -> [f32; 4] {
        [self.walk_power, self.walk_flow, self.walk_offset, self.walk_offset]
    }
}

tuning! {
    /// A change of the fan that is announced (docs/diagnosis.md, section 10).
    pub struct FanTuning: fan {
        /// Levels that differ by less are one.
        same = 1e-3, "1", chosen "";
        /// So long after a change nothing is judged.
        settles = 10.0, "s", chosen "";
    }
}
