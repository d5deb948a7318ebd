//! What a residual's noise is like.

use crate::bounds::{bounded, larger};
use crate::filter::LowPass;
use crate::root::sqrt;

/// A residual is whitened by so much of the one before, and has this standard deviation, degC, until both are known.
const RHO: f32 = 0.6;
const SIGMA: f32 = 0.1;
/// Memories of the residuals' mean and covariances, ticks, and the bounds of what follows from them.
const NOISE_MEMORY: LowPass = LowPass::over(200.0);
const RHOS: (f32, f32) = (0.0, 0.95);
const LEAST_SIGMA: f32 = 0.02;
const NOISE_VARIANCE: f32 = SIGMA * SIGMA / (1.0 - RHO * RHO);

/// What is known of a residual's noise: mean, variance and covariance with the one before.
#[derive(Clone, Copy, Debug)]
pub(super) struct ResidualNoise {
    mean: f32,
    variance: f32,
    covariance: f32,
}

impl ResidualNoise {
    pub(super) const UNKNOWN: Self =
        Self { mean: 0.0, variance: NOISE_VARIANCE, covariance: RHO * NOISE_VARIANCE };

    pub(super) fn follow(&mut self, e: f32, before: f32) {
        NOISE_MEMORY.follow(&mut self.mean, e);
        let (now, then) = (bounded(e - self.mean, -1.0, 1.0), bounded(before - self.mean, -1.0, 1.0));
        NOISE_MEMORY.follow(&mut self.variance, now * now);
        NOISE_MEMORY.follow(&mut self.covariance, now * then);
    }

    /// The share of the residual before that whitens this one, and the standard deviation of what is left, degC.
    pub(super) fn whitening(&self) -> (f32, f32) {
        let rho = bounded(self.covariance / self.variance, RHOS.0, RHOS.1);
        (rho, larger(LEAST_SIGMA, sqrt(self.variance * (1.0 - rho * rho))))
    }
}
