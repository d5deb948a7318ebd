//! Page's cumulative sum test, two-sided: quick on a lasting shift of a whitened residual, blind to less than its allowance.

use crate::bounds::larger;

/// A validated chart: `g <- max(0, g +- z - k)` on either side, alarm above h.
///
/// Mean time between false alarms of one side, in samples of white Gaussian noise (Siegmund 1985):
/// `(exp(2 k (h + 1.166)) - 1 - 2 k (h + 1.166)) / (2 k^2)` with allowance k and decision interval h.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    /// Allowance k: lasting shifts of less are ignored, standard deviations.
    pub(super) allowance: f32,
    /// Decision interval h, standard deviations.
    pub(super) interval: f32,
}

/// Both sums.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    up: f32,
    down: f32,
}

impl Chart {
    /// The larger sum, with z in it; `extra` widens the allowance where the model may be wrong.
    #[inline(never)]
    pub(super) fn step(&self, sums: &mut Sums, z: f32, extra: f32) -> f32 {
        let allowance = self.allowance + extra;
        sums.up = larger(0.0, sums.up + z - allowance);
        sums.down = larger(0.0, sums.down - z - allowance);
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

    /// One side with k = 0.5 and h = 4: 335 samples in the mean (Siegmund's formula 337, tables 336); both: half.
    #[test]
    fn false_alarms_are_as_rare_as_the_formula_says() {
        let chart = Chart { allowance: 0.5, interval: 4.0 };
        let (mut seed, runs, mut samples) = (7, 4000, 0u32);
        for _ in 0..runs {
            let mut sums = Sums::default();
            while chart.step(&mut sums, noise(&mut seed), 0.0) <= chart.interval {
                samples += 1;
            }
        }
        let mean = f64::from(samples) / f64::from(runs);
        assert!((150.0..186.0).contains(&mean), "{mean} samples between false alarms, seed 7");
    }

    /// Page's own definition: either sum is how far the random walk of z - k has risen above its lowest point so far.
    #[test]
    fn a_sum_is_the_rise_above_the_lowest_point() {
        let chart = Chart { allowance: 0.5, interval: 100.0 };
        let (mut seed, mut sums) = (3, Sums::default());
        let mut walks = [[0.0f64; 2]; 2]; // where it is, and its lowest
        for k in 0..2000 {
            let z = noise(&mut seed) + if k > 1900 { 1.0 } else { 0.0 };
            for (walk, z) in walks.iter_mut().zip([z, -z]) {
                walk[0] += f64::from(z) - 0.5;
                walk[1] = walk[1].min(walk[0]);
            }
            let [up, down] = walks.map(|[now, lowest]| now - lowest);
            let larger = f64::from(chart.step(&mut sums, z, 0.0));
            assert!((larger - up.max(down)).abs() < 1e-3, "{larger} at {k}: {up} {down}");
        }
        assert!(sums.up > 20.0, "the shift is seen");
    }

    #[test]
    fn extra_allowance_ignores_what_it_covers() {
        let chart = Chart { allowance: 1.5, interval: 7.0 };
        let mut sums = Sums::default();
        assert!((0..1000).all(|_| chart.step(&mut sums, 3.0, 2.0) == 0.0));
        assert!((0..10).map(|_| chart.step(&mut sums, 3.0, 0.0)).any(|sum| sum > chart.interval));
        assert_eq!(chart.step(&mut sums, f32::NAN, 0.0), 0.0, "no number starts it afresh");
    }
}
