//! One sample is the mean of many conversions, placed so that the ripple of the heater's PWM cancels.

use fdi_core::AdcCode;

/// Period of the PWM in µs: 20 kHz, above hearing, and a whole number of microseconds.
pub const PWM_PERIOD_US: u32 = 50;
/// Conversions a channel in one sample.
pub const ROUNDS: u32 = 25;
/// Time from one round of conversions to the next in µs: a PWM period and a 25th of one.
pub const SPACING_US: u32 = 52;

// The rounds meet the PWM at ROUNDS different phases, evenly spread: every harmonic of the ripple below the ROUNDS-th
// has a mean of zero over them.
const _: () = assert!((SPACING_US % PWM_PERIOD_US) * ROUNDS == PWM_PERIOD_US && ROUNDS >= 16);

/// The mean of the conversions of one channel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mean {
    sum: u32,
    count: u32,
    failed: bool,
}

impl Mean {
    /// Adds a conversion; `None` is one that never ended.
    pub fn push(&mut self, code: Option<u16>) {
        match code {
            Some(code) => {
                self.sum = self.sum.saturating_add(u32::from(code));
                self.count = self.count.saturating_add(1);
            }
            None => self.failed = true,
        }
    }

    /// The mean; NaN, "no sample", where any conversion failed: a converter that hangs once is not to be believed.
    pub fn code(&self) -> AdcCode {
        if self.failed || self.count == 0 {
            return AdcCode(f32::NAN);
        }
        AdcCode(self.sum as f32 / self.count as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_code_comes_through_exactly() {
        for code in 0..=4095 {
            let mut mean = Mean::default();
            (0..ROUNDS).for_each(|_| mean.push(Some(code)));
            assert_eq!(mean.code(), AdcCode(f32::from(code)));
        }
    }

    #[test]
    fn every_harmonic_below_the_number_of_rounds_cancels() {
        for harmonic in 1..ROUNDS {
            let sum: f64 = (0..ROUNDS)
                .map(|round| {
                    let phase = f64::from(round * SPACING_US) / f64::from(PWM_PERIOD_US);
                    (core::f64::consts::TAU * f64::from(harmonic) * phase + 0.7).sin()
                })
                .sum();
            assert!(sum.abs() < 1e-9, "harmonic {harmonic}: {sum}");
        }
    }

    #[test]
    fn sampling_in_step_with_the_pwm_would_not_cancel() {
        let ripple = |spacing: u32| -> f64 {
            (0..ROUNDS).map(|r| f64::from((r * spacing) % PWM_PERIOD_US < 20)).sum::<f64>()
                / f64::from(ROUNDS)
        };
        assert!((ripple(SPACING_US) - 0.4).abs() < 1e-9, "40 % duty");
        assert_eq!(ripple(PWM_PERIOD_US), 1.0, "the hazard: always the same phase");
    }

    #[test]
    fn one_failed_conversion_is_no_sample() {
        let mut mean = Mean::default();
        mean.push(Some(100));
        mean.push(None);
        assert!(mean.code().0.is_nan());
        assert!(Mean::default().code().0.is_nan());
    }
}
