//! From percent of heater power to the compare value of the PWM.

use fdi_core::Percent;

/// The compare value for `drive` on a timer that counts `period` steps: nearest step, never above `period`, 0 for
/// whatever is no number.
pub fn compare(drive: Percent, period: u16) -> u16 {
    // A cast from float to integer saturates and makes NaN 0.
    let steps = (drive.0 * 0.01 * f32::from(period) + 0.5) as u16;
    steps.min(period)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: u16 = 5000;

    #[test]
    fn ends_middle_and_nonsense() {
        for (drive, steps) in [
            (0.0, 0),
            (100.0, PERIOD),
            (50.0, 2500),
            (0.011, 1),
            (0.009, 0),
            (-3.0, 0),
            (1e9, PERIOD),
            (f32::INFINITY, PERIOD),
            (f32::NEG_INFINITY, 0),
            (f32::NAN, 0),
        ] {
            assert_eq!(compare(Percent(drive), PERIOD), steps, "{drive} %");
        }
    }

    #[test]
    fn is_within_half_a_step_everywhere() {
        for i in 0..=100_000u32 {
            let drive = i as f32 / 1000.0;
            let back = f32::from(compare(Percent(drive), PERIOD)) * 100.0 / f32::from(PERIOD);
            assert!((back - drive).abs() <= 0.0101, "{drive} % became {back} %");
        }
    }
}
