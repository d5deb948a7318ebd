//! What is normal for one residual: mean, noise model, slow disturbance; learnt after the models are frozen.

use super::verdict::RejectReason;
use super::whitening::{ORDER, Whitener};
use crate::filter::LowPass;
use crate::root::sqrt;
use crate::vector::shift;

/// What is normal for one residual.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NoiseModel {
    /// Mean, degC.
    pub(super) mean: f32,
    /// Standard deviation, degC.
    pub(super) sd: f32,
    /// Standard deviation of the mean over 20 samples, degC: disturbance that the noise model does not know of.
    pub(super) slow_sd: f32,
    /// Its noise model.
    pub(super) whitener: Whitener,
}

/// Sums over one residual and the output that it belongs to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ResidualStatistics {
    count: f32,
    sum: f32,
    /// Sums of e\[k\] e\[k-i\], i from 0, over pairs.
    products: [f32; ORDER + 1],
    past: [f32; ORDER],
    slow: f32,
    slow_squares: f32,
    first: f32,
    departure: f32,
    departure_squares: f32,
}

/// A mean over 20 samples: slower than what the noise model of order 3 knows of, faster than the means that follow (`mean_time`).
const SLOW: LowPass = LowPass::over(20.0);
/// The largest share of an output's variance that a model may leave unexplained. Tuned: one training of the prototype
/// in 200 had not converged, and led to a wrong name (docs/diagnosis.md, sections 2 and 14).
const MAX_UNEXPLAINED: f32 = 0.6;

impl ResidualStatistics {
    /// One residual and the output that it belongs to, degC.
    #[inline(never)]
    pub(super) fn push(&mut self, e: f32, y: f32) {
        if self.count == 0.0 {
            self.first = y;
        }
        let departure = y - self.first;
        self.departure += departure;
        self.departure_squares += departure * departure;
        SLOW.follow(&mut self.slow, e);
        self.slow_squares += self.slow * self.slow;
        self.count += 1.0;
        self.sum += e;
        self.products[0] += e * e;
        for (product, past) in self.products[1..].iter_mut().zip(&self.past) {
            *product += e * past;
        }
        shift(&mut self.past, e);
    }

    /// Mean of the output, degC.
    pub(super) fn level(&self) -> f32 {
        self.first + self.departure / self.count.max(1.0)
    }

    /// What is normal, or why it can't be trusted.
    pub(super) fn finish(&self) -> Result<NoiseModel, RejectReason> {
        let n = self.count.max(1.0);
        let mean = self.sum / n;
        let r = self.products.map(|product| product / n - mean * mean);
        let departure = self.departure / n;
        let variance = self.departure_squares / n - departure * departure;
        if !(r[0] < MAX_UNEXPLAINED * variance) {
            return Err(RejectReason::PoorFit);
        }
        let whitener = Whitener::from_autocovariance(&r).ok_or(RejectReason::PoorFit)?;
        let slow_sd = sqrt(self.slow_squares / n - mean * mean);
        Ok(NoiseModel { mean, sd: sqrt(r[0]), slow_sd, whitener })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A residual that is correlated, with a mean and slow disturbance, and an output that moves much more.
    fn sequence(k: usize) -> (f32, f32) {
        let hash = (k as u32).wrapping_mul(2654435761);
        let jitter = (hash >> 16) as f32 / 65536.0 - 0.5;
        (
            0.2 + 0.1 * libm::sinf(0.7 * k as f32) + 0.2 * libm::sinf(0.03 * k as f32) + 0.1 * jitter,
            20.0 + 2.0 * libm::sinf(0.2 * k as f32),
        )
    }

    /// Mean, standard deviation and slow disturbance by their definitions, in f64.
    #[test]
    fn statistics_are_those_of_the_definitions() {
        const N: usize = 640;
        let mut statistics = ResidualStatistics::default();
        (0..N).for_each(|k| statistics.push(sequence(k).0, sequence(k).1));
        let noise = statistics.finish().unwrap();
        let e = |k: usize| f64::from(sequence(k).0);
        let mean = (0..N).map(e).sum::<f64>() / N as f64;
        let variance = (0..N).map(|k| (e(k) - mean).powi(2)).sum::<f64>() / N as f64;
        let (mut slow, mut squares) = (0.0, 0.0);
        for k in 0..N {
            slow += (e(k) - slow) / 20.0;
            squares += slow * slow;
        }
        let slow_sd = libm::sqrt(squares / N as f64 - mean * mean);
        let level = (0..N).map(|k| f64::from(sequence(k).1)).sum::<f64>() / N as f64;
        let near =
            |x: f32, wanted: f64| assert!((f64::from(x) - wanted).abs() < 1e-3, "{x} instead of {wanted}");
        near(noise.mean, mean);
        near(noise.sd, libm::sqrt(variance));
        near(noise.slow_sd, slow_sd);
        near(statistics.level(), level);
        assert!(noise.whitener.sigma() < noise.sd, "what is correlated can be foreseen");
    }

    #[test]
    fn a_model_that_explains_little_is_refused() {
        let mut statistics = ResidualStatistics::default();
        (0..640).for_each(|k| statistics.push(sequence(k).1 - 20.0, sequence(k).1));
        assert_eq!(statistics.finish().err(), Some(RejectReason::PoorFit));
        assert_eq!(ResidualStatistics::default().finish().err(), Some(RejectReason::PoorFit), "nothing seen");
    }
}
