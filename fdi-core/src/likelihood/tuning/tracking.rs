//! What moves slowly without being a fault yet.

use super::tuning;

tuning! {
    /// The tracker: a Kalman filter of power, air flow and both offsets (docs/diagnosis.md, section 7).
    pub struct TrackerTuning: tracker {
        /// Standard deviation of the power at the start, and after the tracker has taken over a step.
        first_power = 0.01, "1", measured "with 0.005 an alarm outlived dirt by 512 s in place of 173 (cleaned/air flow @ harsh)";
        /// Standard deviation of the air flow then, 1/f - 1.
        first_flow = 0.005, "1", chosen "";
        /// Standard deviation of both offsets then.
        first_offset = 0.1, "degC", chosen "";
        /// Process noise: random walk of the power in a tick, for a rig that answers within about ten ticks.
        walk_power = 0.0002, "1", measured "a faster tracker swallows drifts (docs/diagnosis.md, section 16)";
        /// Random walk of the air flow in a tick, 1/f - 1.
        walk_flow = 0.00008, "1", measured "the same";
        /// Random walk of both offsets in a tick.
        walk_offset = 0.0008, "degC", measured "the same";
        /// Variance of an innovation in this filter. More than 1 makes the filter slower.
        noise = 3.0, "1", chosen "";
        /// The tracker runs while all charts are below this share of their decision intervals.
        below = 0.4, "1", measured "prototype 1, configuration J";
        /// Share of a new step of the power in the mean square of the steps.
        step_share = 0.2, "1", chosen "";
        /// A slow change that goes away by itself counts as usual up to this share of power, and of air flow.
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
        /// Levels of the fan that differ by less are the same.
        same = 1e-3, "1", chosen "";
        /// After an announced change of the fan nothing is judged for this time.
        settles = 10.0, "s", chosen "";
    }
}
