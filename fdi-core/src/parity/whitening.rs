//! Whitening: what is left of a residual when that which follows from its own past is taken away, in units of its
//! standard deviation. On it, run lengths of sequential tests are what the formulas say.

use super::model::{bounded, dot, shift};
use crate::root::sqrt;

/// Order of the autoregressive noise model.
pub(super) const ORDER: usize = 3;

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
        let mut variance = r[0] * 1.0001;
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
        (sigma > 1e-6).then(|| Self { c, sigma, inv_sigma: 1.0 / sigma, rest })
    }

    /// Takes in a residual; gives its innovation in standard deviations.
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
