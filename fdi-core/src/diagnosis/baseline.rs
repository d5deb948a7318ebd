//! What is normal: mean and standard deviation of each feature over fault-free operation, and the thresholds from them.
//!
//! ```
//! use fdi_core::diagnosis::baseline::Statistics;
//!
//! let mut statistics = Statistics::default();
//! for sample in [[1.0, 10.0], [2.0, 10.0], [3.0, 10.0]] {
//!     statistics.push(&sample);
//! }
//! assert_eq!((statistics.count(), statistics.mean()), (3, [2.0, 10.0]));
//! assert!((statistics.sigma()[0] - (2.0f32 / 3.0).sqrt()).abs() < 1e-6);
//! ```

use super::residual::RESIDUALS;
use crate::error::{ConfigError, in_range};
use crate::root::sqrt;

/// Running mean and variance of `M` signals by Welford's recurrence, which subtracts no large sums.
///
/// Source: B. P. Welford, "Note on a method for calculating corrected sums of squares and products", 1962.
#[derive(Clone, Copy, Debug)]
pub struct Statistics<const M: usize> {
    count: u32,
    mean: [f32; M],
    /// Low-order part of the mean, lost to rounding otherwise in long windows.
    mean_rest: [f32; M],
    /// Sum of squared deviations.
    m2: [f32; M],
}

impl<const M: usize> Default for Statistics<M> {
    fn default() -> Self {
        Self { count: 0, mean: [0.0; M], mean_rest: [0.0; M], m2: [0.0; M] }
    }
}

impl<const M: usize> Statistics<M> {
    /// One sample of each signal; all must be finite.
    pub fn push(&mut self, x: &[f32; M]) {
        self.count = self.count.saturating_add(1);
        let inv_count = 1.0 / self.count as f32;
        for i in 0..M {
            let before = x[i] - self.mean[i];
            let step = before * inv_count + self.mean_rest[i];
            let mean = self.mean[i] + step;
            self.mean_rest[i] = step - (mean - self.mean[i]);
            self.mean[i] = mean;
            self.m2[i] += before * (x[i] - mean);
        }
    }

    /// Samples taken in.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Mean of each signal.
    pub fn mean(&self) -> [f32; M] {
        self.mean
    }

    /// Standard deviation of each signal (divisor n); zero before the second sample.
    pub fn sigma(&self) -> [f32; M] {
        let inv_count = 1.0 / self.count.max(1) as f32;
        self.m2.map(|m2| sqrt(m2 * inv_count))
    }
}

/// Mean and standard deviation of the seven features, of one of the two forms (raw or low-passed).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Normal {
    /// Mean of each feature.
    pub mean: [f32; RESIDUALS],
    /// Standard deviation of each feature.
    pub sigma: [f32; RESIDUALS],
}

impl From<&Statistics<RESIDUALS>> for Normal {
    fn from(s: &Statistics<RESIDUALS>) -> Self {
        Self { mean: s.mean(), sigma: s.sigma() }
    }
}

/// What fault-free operation looks like. The nominal value that a residual subtracts is the mean of the raw feature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Baseline {
    /// Samples that it was learnt from.
    pub samples: u32,
    /// Features as they are.
    pub raw: Normal,
    /// Features after the low-pass filter.
    pub filtered: Normal,
}

impl Baseline {
    /// Checks a baseline that comes from outside, such as from flash.
    ///
    /// # Errors
    /// The part that cannot have been learnt.
    #[inline]
    pub fn validate(&self) -> Result<(), ConfigError> {
        in_range("baseline.samples", self.samples as f32, MIN_SAMPLES, f32::MAX)?;
        for normal in [&self.raw, &self.filtered] {
            normal.mean.iter().try_for_each(|&mean| in_range("baseline.mean", mean, -1e6, 1e6))?;
            normal.sigma.iter().try_for_each(|&sigma| in_range("baseline.sigma", sigma, 0.0, 1e6))?;
        }
        Ok(())
    }
}

/// Fewer samples give no standard deviation worth a threshold.
pub(crate) const MIN_SAMPLES: f32 = 100.0;

/// Learns a [`Baseline`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Learner {
    raw: Statistics<RESIDUALS>,
    filtered: Statistics<RESIDUALS>,
}

impl Learner {
    /// One fault-free sample of the features, raw and low-passed.
    pub fn push(&mut self, raw: &[f32; RESIDUALS], filtered: &[f32; RESIDUALS]) {
        self.raw.push(raw);
        self.filtered.push(filtered);
    }

    /// Samples so far.
    pub fn count(&self) -> u32 {
        self.raw.count()
    }

    /// The baseline as learnt so far.
    pub fn baseline(&self) -> Baseline {
        Baseline { samples: self.count(), raw: (&self.raw).into(), filtered: (&self.filtered).into() }
    }
}
