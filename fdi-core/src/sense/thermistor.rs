//! NTC thermistor in a ratiometric divider: 12-bit code to temperature by the beta equation, and back.
//!
//! The thermistor lies from the ADC input to ground, the pull-up from VDDA to the input, so the code falls as it
//! warms and the supply voltage cancels:
//!
//! ```text
//! code / 4095 = R / (R + Rp)          R = Rp code / (4095 - code)
//! 1/T = 1/T25 + ln(R / R25) / B       T in kelvin, T25 = 298.15 K
//! ```

use super::logarithm::ln;
use crate::error::ConfigError;
use crate::settings::{check, settings};
use crate::units::{AdcCode, Celsius, Ohm};

/// 0 degC in kelvin.
const KELVIN: f32 = 273.15;
/// Reference temperature of an NTC data sheet, 25 degC, in kelvin.
const T25: f32 = 298.15;

settings! {
    /// Thermistor: an NTC from the ADC input to ground, pull-up from VDDA to the input. T0 is in the room, T1 at the outlet in the
    /// loop, T2 at the outlet downstream.
    pub struct ThermistorConfig: T0 "sensors.t0.", T1 "sensors.t1.", T2 "sensors.t2." {
        /// Resistance at 25 degC.
        r25: Ohm = 10e3, 10.0..=10e6;
        /// Beta constant.
        beta: f32 = 3950.0, 500.0..=10e3, in "K";
        /// Pull-up from VDDA to the ADC input.
        pull_up: Ohm = 10e3, 10.0..=10e6;
        /// Calibration: factor on the temperature.
        gain: f32 = 1.0, 0.5..=2.0;
        /// Calibration: added to the temperature after `gain`.
        offset: Celsius = 0.0, -20.0..=20.0;
    }
}

/// A thermistor ready to convert.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thermistor {
    /// 1/T25 + ln(Rp/R25)/B, in 1/K: the constant part of the beta equation.
    inv_t_at_half_scale: f32,
    /// 1/B in 1/K.
    inv_beta: f32,
    gain: f32,
    /// Calibration offset with the step from kelvin to Celsius, in degC.
    offset: f32,
}

impl Thermistor {
    /// Builds the thermistor of channel 0, 1 or 2 (T0, T1, T2), which errors name.
    ///
    /// # Errors
    /// The parameter that is out of bounds.
    pub fn new(c: &ThermistorConfig, channel: usize) -> Result<Self, ConfigError> {
        check(ThermistorConfig::SETTINGS[channel.min(2)], c)?;
        Ok(Self {
            inv_t_at_half_scale: 1.0 / T25 + libm::logf(c.pull_up.0 / c.r25.0) / c.beta,
            inv_beta: 1.0 / c.beta,
            gain: c.gain,
            offset: c.offset.0 - c.gain * KELVIN,
        })
    }

    /// Temperature at a code strictly between 0 and full scale; at or beyond these the result is not meaningful.
    pub fn celsius(&self, code: AdcCode) -> Celsius {
        let r_over_pull_up = code.0 / (AdcCode::FULL_SCALE - code.0);
        let kelvin = 1.0 / (self.inv_t_at_half_scale + ln(r_over_pull_up) * self.inv_beta);
        Celsius(self.gain * kelvin + self.offset)
    }

    /// The (fractional) code that reads as `celsius`: the inverse of [`Thermistor::celsius`].
    pub fn code(&self, celsius: Celsius) -> AdcCode {
        let kelvin = (celsius.0 - self.offset) / self.gain;
        let r_over_pull_up = libm::expf((1.0 / kelvin - self.inv_t_at_half_scale) / self.inv_beta);
        AdcCode(AdcCode::FULL_SCALE * r_over_pull_up / (1.0 + r_over_pull_up))
    }
}
