//! Page's cumulative sum test, two-sided: quick on a lasting shift of a whitened residual, blind to less than its slack.

use crate::bounds::{bounded, larger};

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

#[cfg(test)]
mod tests {
    use super::*;

    /// White Gaussian noise: the sum of twelve uniform numbers, by a 64-bit congruential generator.
    fn noise(seed: &mut u64) -> f32 {
        let mut sum = -6.0;
        for _ in 0..12 {
            *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            sum += (*seed >> 40) as f32 / (1u64 << 24) as f32;
        }
        sum
    }

    /// One side with slack 0.5 and limit 4: 335 samples in the mean (Siegmund's formula 337, tables 336); both: half.
    #[test]
    fn false_alarms_are_as_rare_as_the_formula_says() {
        let chart = Chart { slack: 0.5, limit: 4.0 };
        let (mut seed, runs, mut samples) = (7, 4000, 0u32);
        for _ in 0..runs {
            let mut sums = Sums::default();
            while chart.step(&mut sums, noise(&mut seed), 0.0) <= chart.limit {
                samples += 1;
            }
        }
        let mean = f64::from(samples) / f64::from(runs);
        assert!((150.0..186.0).contains(&mean), "{mean} samples between false alarms, seed 7");
    }

    #[test]
    fn extra_slack_ignores_what_it_covers() {
        let chart = Chart { slack: 1.5, limit: 7.0 };
        let mut sums = Sums::default();
        assert!((0..1000).all(|_| chart.step(&mut sums, 3.0, 2.0) == 0.0));
        assert!((0..10).map(|_| chart.step(&mut sums, 3.0, 0.0)).any(|sum| sum > chart.limit));
        assert_eq!(chart.step(&mut sums, f32::NAN, 0.0), 0.0, "no number starts it afresh");
    }
}
