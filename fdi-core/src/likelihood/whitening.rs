//! Whitening: what is left of a residual when that which follows from its own past is taken away, in units of its
//! standard deviation. On it, run lengths of sequential tests are what the formulas say.

use crate::bounds::bounded;
use crate::root::sqrt;
use crate::vector::{dot, shift};

/// Order of the autoregressive noise model. Chosen on the reference rig (docs/diagnosis.md, section 3).
pub(super) const ORDER: usize = 3;

/// White noise that is added to the autocovariance, as a factor on its variance: a residual that its past explains wholly has no innovation
/// to judge by.
const RIDGE: f32 = 1.0001;
/// The smallest standard deviation of an innovation, degC: far below one step of the converter, so it is rounding.
const MIN_SIGMA: f32 = 1e-6;

/// Autoregressive model of a residual in fault-free operation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Whitener {
    /// `e[k] = c1 e[k-1] + .. + c3 e[k-3] + w[k]`.
    c: [f32; ORDER],
    /// Standard deviation of w, degC, and its inverse.
    sigma: f32,
    inv_sigma: f32,
    /// What is left of a constant residual: 1 - c1 - c2 - c3.
    rest: f32,
}

/// Past residuals, newest first, degC.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Past([f32; ORDER]);

impl Past {
    /// Values that are remembered.
    pub(super) const LENGTH: usize = ORDER;

    /// A ramp of one a tick that would be at `next` on the next tick.
    pub(super) fn ramp(next: f32) -> Self {
        Self(core::array::from_fn(|i| next - 1.0 - i as f32))
    }

    /// As if every value had been lower by `change`.
    pub(super) fn lower(&mut self, change: f32) {
        for e in &mut self.0 {
            *e -= change;
        }
    }
}

impl Whitener {
    /// From autocovariances at lags 0 to 3 by the Levinson recursion; `None` where they are those of no process.
    pub(super) fn from_autocovariance(r: &[f32; ORDER + 1]) -> Option<Self> {
        let mut c = [0.0; ORDER];
        let mut variance = r[0] * RIDGE;
        for m in 0..ORDER {
            if !(variance > 0.0 && variance.is_finite()) {
                return None;
            }
            let mut k = r[m + 1];
            for i in 0..m {
                k -= c[i] * r[m - i];
            }
            k /= variance;
            let before = c;
            for i in 0..m {
                c[i] = before[i] - k * before[m - 1 - i];
            }
            c[m] = k;
            variance *= 1.0 - k * k;
        }
        let sigma = sqrt(variance);
        let rest = 1.0 - c.iter().sum::<f32>();
        (sigma > MIN_SIGMA).then(|| Self { c, sigma, inv_sigma: 1.0 / sigma, rest })
    }

    /// The innovation of a residual, in standard deviations.
    #[inline(never)]
    pub(super) fn step(&self, past: &mut Past, e: f32) -> f32 {
        let w = e - self.expected(past);
        shift(&mut past.0, e);
        w * self.inv_sigma
    }

    /// The same for charts: an innovation counts and is remembered only up to `limit` standard deviations, so that a
    /// single outlier leaves no echo.
    #[inline(never)]
    pub(super) fn step_clipped(&self, past: &mut Past, e: f32, limit: f32) -> f32 {
        let expected = self.expected(past);
        let z = bounded((e - expected) * self.inv_sigma, -limit, limit);
        shift(&mut past.0, expected + z * self.sigma);
        z
    }

    /// Goes on without a sample: what was expected is taken as seen.
    #[inline(never)]
    pub(super) fn skip(&self, past: &mut Past) {
        let expected = self.expected(past);
        shift(&mut past.0, expected);
    }

    /// Standard deviation of the innovation, degC, and its inverse.
    pub(super) fn sigma(&self) -> f32 {
        self.sigma
    }

    pub(super) fn inv_sigma(&self) -> f32 {
        self.inv_sigma
    }

    /// What is left of a constant residual: 1 - c1 - c2 - c3.
    pub(super) fn rest(&self) -> f32 {
        self.rest
    }

    /// The residual that its past lets expect.
    #[inline]
    pub(super) fn expected(&self, past: &Past) -> f32 {
        dot(&self.c, &past.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::reference::yule_walker;
    use super::*;

    /// An autoregressive process of order 2 with coefficients 1.2 and -0.5 and innovations of variance 1 has the
    /// autocovariances 3.704 (1, 0.8, 0.46, 0.152) (Yule-Walker by hand).
    #[test]
    fn coefficients_come_back_from_autocovariances() {
        let r0 = 1.0 / ((1.0 - 0.8 * 1.2 + 0.46 * 0.5) as f32);
        let whitener = Whitener::from_autocovariance(&[r0, 0.8 * r0, 0.46 * r0, 0.152 * r0]).unwrap();
        for (c, wanted) in whitener.c.iter().zip([1.2, -0.5, 0.0]) {
            assert!((c - wanted).abs() < 5e-3, "{:?}", whitener.c);
        }
        assert!((whitener.sigma() - 1.0).abs() < 5e-3 && (whitener.rest() - 0.3).abs() < 5e-3);
    }

    /// Levinson's recursion against the Yule-Walker equations solved directly.
    #[test]
    fn the_recursion_solves_the_equations_of_yule_and_walker() {
        for r in
            [[1.0, 0.9, 0.75, 0.6], [0.01, 0.006, 0.003, 0.001], [4.0, -2.0, 1.5, -1.0], [2.0, 0.0, 0.0, 1.0]]
        {
            let whitener = Whitener::from_autocovariance(&r).unwrap();
            let (c, sigma) = yule_walker(&r);
            for (c, wanted) in whitener.c.iter().zip(c) {
                assert!((f64::from(*c) - wanted).abs() < 2e-3, "{r:?}: {:?}", whitener.c);
            }
            assert!((f64::from(whitener.sigma()) / sigma - 1.0).abs() < 1e-3, "{r:?}");
        }
    }

    #[test]
    fn what_is_no_autocovariance_is_refused() {
        for r in [
            [0.0; 4],
            [-1.0, 0.0, 0.0, 0.0],
            [f32::NAN; 4],
            [1.0, 2.0, 0.0, 0.0],
            [f32::INFINITY, 0.0, 0.0, 0.0],
        ] {
            assert!(Whitener::from_autocovariance(&r).is_none(), "{r:?}");
        }
    }

    #[test]
    fn one_outlier_leaves_no_echo_in_the_charts() {
        let r = [1.0, 0.5, 0.25, 0.125];
        let whitener = Whitener::from_autocovariance(&r).unwrap();
        let mut past = Past::default();
        assert_eq!(whitener.step_clipped(&mut past, 1000.0, 6.0), 6.0);
        let echo = whitener.step_clipped(&mut past, 0.0, 6.0);
        assert!((-6.0..0.0).contains(&echo) && echo > -3.7, "{echo}");
        let later = whitener.step_clipped(&mut past, 0.0, 6.0);
        assert!(later.abs() < 1e-3, "{later}");
    }
}
