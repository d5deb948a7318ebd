//! The clock of the board against the oscillator of its watchdog (LSI). PWM, tick and tasks all count one clock: at half its
//! speed a tick lasts 220 ms, every limit of time is twice as long, and every watchdog that counts the same clock is content.
//!
//! The LSI is 32 kHz only nominally: 17 to 47 kHz by the data sheet (DS10314), so that its nominal value says nothing about a factor of
//! two. What it is on this chip is therefore measured at each start, by the internal oscillator (HSI), and every later measurement by the
//! clock in use is held against that.

use core::ops::RangeInclusive;

/// Periods of the LSI in a span: what the capturing timer divides its edges by.
pub const PERIODS: u32 = 8;

/// A span of any LSI of the data sheet in µs of the HSI, which is 8 % slow to 4.5 % fast at worst (-40 to 105 °C, DS10314): 8 periods of
/// 47 kHz, less 8 %, to 8 of 17 kHz, and 4.5 % more. A span beyond that is none, or was counted by an HSI that is wrong itself.
const CREDIBLE: RangeInclusive<u32> = 156..=492;

/// Whether two spans, in µs of two clocks, are the same but for what the LSI may drift and the HSI be off. `reference` is that by the HSI; 0 is
/// "no span".
///
/// The tolerance, a third either way, is chosen: a factor of two is 1.5 times beyond it. The LSI of one chip drifts with temperature
/// and supply; DS10314 has a figure of it and no limit. For comparison, the data sheet of the STM32L1 allows one part -10 to +4 % over 0 to 85 °C.
pub fn agree(reference: u32, span: u32) -> bool {
    CREDIBLE.contains(&reference) && (reference * 3 / 4..=reference * 4 / 3).contains(&span)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A span in µs of a clock that runs at `speed` times what it should.
    fn span(lsi_hz: u32, speed: f64) -> u32 {
        (f64::from(PERIODS) * 1e6 / f64::from(lsi_hz) * speed) as u32
    }

    #[test]
    fn every_lsi_of_the_data_sheet_agrees_with_itself_by_every_hsi_of_the_data_sheet() {
        for lsi in (17_000..=47_000).step_by(100) {
            for hsi in [0.92, 1.0, 1.045] {
                for drift in [0.9, 1.0, 1.1] {
                    let later = (f64::from(lsi) * drift) as u32;
                    assert!(agree(span(lsi, hsi), span(later, 1.0)), "{lsi} Hz, {later} later, HSI {hsi}");
                }
            }
        }
    }

    #[test]
    fn a_clock_of_half_or_double_speed_agrees_with_no_lsi_of_the_data_sheet() {
        for lsi in (17_000..=47_000).step_by(100) {
            for hsi in [0.92, 1.0, 1.045] {
                for drift in [0.9, 1.0, 1.1] {
                    let later = (f64::from(lsi) * drift) as u32;
                    for speed in [0.0, 0.1, 0.5, 2.0, 10.0] {
                        assert!(!agree(span(lsi, hsi), span(later, speed)), "{lsi} Hz, {later}, {speed}");
                    }
                }
            }
        }
    }

    #[test]
    fn an_oscillator_that_stands_still_or_is_absurd_agrees_with_nothing() {
        for reference in [0, 1, 155, 493, u32::MAX] {
            assert!(!agree(reference, reference), "{reference}");
        }
        assert!(!agree(250, 0) && !agree(250, u32::MAX));
    }
}
