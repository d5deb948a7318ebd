//! First-order low-pass.
//!
//! ```
//! use fdi_core::Seconds;
//! use fdi_core::filter::LowPass;
//!
//! let filter = LowPass::new(1.0, Seconds(0.1)); // cut-off at 1 rad/s: a time constant of 1 s
//! let mut state = None;
//! filter.step(&mut state, &[0.0]);
//! let after_a_second = (0..10).map(|_| filter.step(&mut state, &[1.0])[0]).last();
//! assert!(after_a_second.is_some_and(|x| (x - 0.632).abs() < 0.001));
//! ```

use crate::units::Seconds;

/// First-order low-pass `x_f += share (x - x_f)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowPass {
    share: f32,
}

/// The memory of a bank of `M` low-passes; `None` until the first input.
pub type LowPassState<const M: usize> = Option<[f32; M]>;

impl LowPass {
    /// Exact for an input that is held between samples: `share = 1 - exp(-wc Ts)`, with the cut-off in rad/s. Both arguments must be positive
    /// and finite.
    pub fn new(cutoff: f32, sample_time: Seconds) -> Self {
        Self { share: 1.0 - libm::expf(-cutoff * sample_time.0) }
    }

    /// Forward Euler: `share = Ts / time`, with the time constant in s. Good for means over many samples; a time shorter than a
    /// sample gives no filter at all.
    pub(crate) fn euler(time: f32, sample_time: f32) -> Self {
        Self { share: (sample_time / time).min(1.0) }
    }

    /// With a memory of `samples`, whatever their distance.
    pub(crate) const fn over(samples: f32) -> Self {
        Self { share: 1.0 / samples }
    }

    /// The share that is renewed in a sample, 0..=1.
    pub(crate) fn share(&self) -> f32 {
        self.share
    }

    /// Moves `mean` towards `x` by one sample.
    #[inline]
    pub(crate) fn follow(&self, mean: &mut f32, x: f32) {
        *mean += self.share * (x - *mean);
    }

    /// Filters `M` signals at once, from their first values on.
    pub fn step<const M: usize>(&self, state: &mut LowPassState<M>, input: &[f32; M]) -> [f32; M] {
        let mut mean = state.unwrap_or(*input);
        for (mean, x) in mean.iter_mut().zip(input) {
            self.follow(mean, *x);
        }
        *state = Some(mean);
        mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The answer to a step, `1 - (1 - share)^k`, and the continuous one, `1 - exp(-t / time)`.
    #[test]
    fn both_forms_are_that_of_a_first_order_lag() {
        let (time, ts) = (2.0, 0.11);
        let [exact, euler] = [LowPass::new(1.0 / time, Seconds(ts)), LowPass::euler(time, ts)];
        let (mut x, mut y) = (Some([0.0]), 0.0);
        for k in 1..100 {
            let wanted = 1.0 - libm::exp(f64::from(-ts / time * k as f32));
            assert!((f64::from(exact.step(&mut x, &[1.0])[0]) - wanted).abs() < 1e-5);
            euler.follow(&mut y, 1.0);
            let wanted = 1.0 - libm::pow(1.0 - f64::from(ts / time), f64::from(k));
            assert!((f64::from(y) - wanted).abs() < 1e-5);
        }
    }

    #[test]
    fn a_time_below_a_sample_gives_no_filter() {
        assert_eq!(LowPass::euler(0.05, 0.11).share(), 1.0);
        assert_eq!(LowPass::over(20.0).share(), 0.05);
    }
}
