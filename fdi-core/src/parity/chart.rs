//! Page's cumulative sum test, two-sided: quick on a lasting shift of a whitened residual, blind to less than its slack.

use super::model::{bounded, larger};

/// A validated chart: `g <- max(0, g +- z - slack)` on either side, alarm above `limit`.
///
/// Mean time between false alarms of one side, in samples of white Gaussian noise (Siegmund 1985):
/// `(exp(2 k (h + 1.166)) - 1 - 2 k (h + 1.166)) / (2 k^2)` with slack k and limit h.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    pub(super) slack: f32,
    pub(super) limit: f32,
}

/// Both sums.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    up: f32,
    down: f32,
}

/// A sum stops growing at so many limits, so that it comes back soon after a long fault.
const CEILING: f32 = 2.5;

impl Chart {
    /// Takes in z; `extra` widens the slack where the model is known to be weak. Gives the larger sum.
    #[inline(never)]
    pub(super) fn step(&self, sums: &mut Sums, z: f32, extra: f32) -> f32 {
        let slack = self.slack + extra;
        let ceiling = CEILING * self.limit;
        sums.up = bounded(sums.up + z - slack, 0.0, ceiling);
        sums.down = bounded(sums.down - z - slack, 0.0, ceiling);
        larger(sums.up, sums.down)
    }
}
