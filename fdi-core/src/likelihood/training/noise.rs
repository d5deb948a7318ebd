//! What a residual's noise is like.

use crate::bounds::{bounded, larger};
use crate::filter::LowPass;
use crate::likelihood::tuning::Tuned;
use crate::root::sqrt;

/// What is known of a residual's noise: mean, variance and covariance with the one before.
#[derive(Clone, Copy, Debug)]
pub(super) struct ResidualNoise {
    mean: f32,
    variance: f32,
    covariance: f32,
    tuning: Tuned,
}

impl ResidualNoise {
    /// Nothing has been seen yet.
    pub(super) fn new(tuning: Tuned) -> Self {
        let (rho, sigma) = (tuning.filter.rho, tuning.filter.sigma);
        let variance = sigma * sigma / (1.0 - rho * rho);
        Self { mean: 0.0, variance, covariance: rho * variance, tuning }
    }

    pub(super) fn follow(&mut self, e: f32, before: f32) {
        let memory = LowPass::over(self.tuning.filter.noise_memory);
        memory.follow(&mut self.mean, e);
        let (now, then) = (e - self.mean, before - self.mean);
        memory.follow(&mut self.variance, now * now);
        memory.follow(&mut self.covariance, now * then);
    }

    /// The share of the residual before that whitens this one, and the standard deviation of what is left, degC.
    pub(super) fn whitening(&self) -> (f32, f32) {
        let rho = bounded(self.covariance / self.variance, 0.0, self.tuning.filter.largest_rho);
        (rho, larger(self.tuning.whitening.least_sigma, sqrt(self.variance * (1.0 - rho * rho))))
    }
}
