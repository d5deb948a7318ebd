//! What moves slowly without being a fault yet.

use super::tuning;

tuning! {
    /// The tracker: a Kalman filter of power, air flow and both offsets (docs/diagnosis.md, section 7).
    pub struct TrackerTuning: tracker {
        /// Process noise: random walk in a tick, as a share of the nuisances since an onset, for a rig that answers within about ten ticks.
        walk = 0.01, "1", measured "a faster tracker swallows drifts (docs/evidence/diagnosis-results.md)";
        /// Variance of an innovation in this filter. More than 1 makes the filter slower.
        noise = 3.0, "1", chosen "";
        /// The tracker runs while all charts are below this share of their decision intervals.
        below = 0.4, "1", measured "prototype 1, configuration J";
    }
}

tuning! {
    /// A change of the fan that is announced (docs/diagnosis.md, section 10).
    pub struct FanTuning: fan {
        /// Levels of the fan that differ by less are the same.
        same = 1e-3, "1", chosen "";
    }
}
