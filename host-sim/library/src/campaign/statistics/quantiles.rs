//! Quantiles that count what never happened, and intervals of a rate and of a share.

use serde::Serialize;

/// Median, 95th and 99th percentile over all runs. What never happened in a run counts as infinitely late; null: more
/// runs than that never saw it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quantiles {
    /// Median.
    pub median: Option<f64>,
    /// 95th percentile.
    pub p95: Option<f64>,
    /// 99th percentile.
    pub p99: Option<f64>,
}

impl Quantiles {
    /// Of values that may not exist.
    pub fn of(values: impl Iterator<Item = Option<f64>>) -> Self {
        let mut all: Vec<f64> = values.map(|x| x.unwrap_or(f64::INFINITY)).collect();
        all.sort_by(f64::total_cmp);
        Self { median: quantile(&all, 0.5), p95: quantile(&all, 0.95), p99: quantile(&all, 0.99) }
    }
}

/// The smallest value that at least `share` of the sorted values do not exceed.
pub(in crate::campaign) fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let rank = (share * sorted.len() as f64 - 1e-9).ceil().max(1.0) as usize;
    sorted.get(rank - 1).copied().filter(|x| x.is_finite())
}

/// Exact 95 % interval of the mean of a Poisson count (Garwood 1936).
pub fn poisson_interval(count: u32) -> [f64; 2] {
    const TAIL: f64 = 0.025;
    let k = f64::from(count);
    // P(X >= k) = P(k, mean), P(X <= k) = 1 - P(k + 1, mean), P the regularised incomplete gamma function.
    let low = if count == 0 { 0.0 } else { bisect(k + 1.0, |mean| lower_gamma(k, mean) > TAIL) };
    let high = bisect(2.0 * k + 20.0, |mean| lower_gamma(k + 1.0, mean) > 1.0 - TAIL);
    [low, high]
}

/// 95 % interval of a share of which `count` of `of` are the sample (Wilson 1927).
pub fn wilson_interval(count: u64, of: u64) -> [f64; 2] {
    const Z: f64 = 1.959_963_984_540_054;
    let n = of as f64;
    let (p, z2) = (count as f64 / n, Z * Z / n);
    let middle = (p + 0.5 * z2) / (1.0 + z2);
    let half = Z / (1.0 + z2) * libm::sqrt(p * (1.0 - p) / n + 0.25 * z2 / n);
    [(middle - half).max(0.0), (middle + half).min(1.0)]
}

/// Where `above` becomes true between 0 and `end`.
fn bisect(end: f64, above: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, end);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if above(middle) { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// Regularised lower incomplete gamma function P(a, x): a series below the mean, a continued fraction (Lentz) above it.
fn lower_gamma(a: f64, x: f64) -> f64 {
    const ENOUGH: f64 = 1e-15;
    const STEPS: u32 = 100_000;
    if x <= 0.0 {
        return 0.0;
    }
    let front = libm::exp(a * libm::log(x) - x - libm::lgamma(a));
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        for _ in 0..STEPS {
            n += 1.0;
            term *= x / n;
            sum += term;
            if term < sum * ENOUGH {
                break;
            }
        }
        return front * sum;
    }
    let tiny = 1e-300;
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / tiny;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for i in 1..STEPS {
        let factor = -f64::from(i) * (f64::from(i) - a);
        b += 2.0;
        d = 1.0 / (factor * d + b).abs().max(tiny).copysign(factor * d + b);
        c = (b + factor / c).abs().max(tiny).copysign(b + factor / c);
        fraction *= c * d;
        if (c * d - 1.0).abs() < ENOUGH {
            break;
        }
    }
    1.0 - front * fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference: means at which the Poisson probabilities, summed term by term, leave 2.5 % on either side.
    #[test]
    fn poisson_intervals_are_exact() {
        for (count, low, high) in [
            (0, 0.0, 3.6889),
            (1, 0.0253, 5.5716),
            (2, 0.2422, 7.2247),
            (3, 0.6187, 8.7673),
            (10, 4.7954, 18.3904),
            (30, 20.2409, 42.8269),
            (100, 81.3640, 121.6268),
        ] {
            let interval = poisson_interval(count);
            assert!((interval[0] - low).abs() < 1e-4, "{count}: {interval:?}");
            assert!((interval[1] - high).abs() < 1e-4, "{count}: {interval:?}");
        }
    }

    #[test]
    fn a_large_count_has_the_interval_of_a_normal_distribution() {
        let [low, high] = poisson_interval(40_000);
        assert!((low - (40_000.0 - 1.96 * 200.0)).abs() < 3.0, "{low}");
        assert!((high - (40_000.0 + 1.96 * 200.0)).abs() < 4.0, "{high}");
    }

    /// Reference: the two roots of (x - p)^2 = z^2 x (1 - x)/n, which is what Wilson's interval is.
    #[test]
    fn a_share_has_wilsons_interval() {
        for (count, of) in [(0, 10), (1, 10), (50, 100), (999, 1000), (10, 10)] {
            let (n, p) = (of as f64, count as f64 / of as f64);
            for x in wilson_interval(count, of) {
                let gap = (x - p) * (x - p) - 1.959_964 * 1.959_964 * x * (1.0 - x) / n;
                assert!(gap.abs() < 1e-7, "{count} of {of}: {x}");
            }
        }
    }

    #[test]
    fn what_never_happened_counts_as_infinitely_late() {
        let of = |missed: usize| Quantiles::of((0..100).map(|i| (i >= missed).then_some(f64::from(i as u8))));
        assert_eq!(of(0), Quantiles { median: Some(49.0), p95: Some(94.0), p99: Some(98.0) });
        assert_eq!(of(5).p95, Some(99.0));
        assert_eq!((of(6).p95, of(6).median), (None, Some(55.0)));
        assert_eq!(Quantiles::of([None, None].into_iter()), Quantiles::default());
        assert_eq!(Quantiles::of(std::iter::empty()), Quantiles::default());
    }
}
