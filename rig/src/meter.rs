//! The input at which the board reads the heater's supply: a divider against the converter's reference, noise and steps.

use crate::config::RigConfig;
use crate::noise::{Noise, Stream};
use crate::sensor::quantized;

/// The input, where there is one.
pub(crate) struct Meter {
    /// Code at the nominal voltage.
    nominal: f64,
    /// Standard deviation of its noise, codes.
    white: f64,
    bits: u32,
    noise: Noise,
}

impl Meter {
    /// None if the supply is not measured.
    pub(crate) fn new(config: &RigConfig, seed: u64) -> Option<Self> {
        let (nominal, white) = (config.mains.measured_code, config.mains.measured_noise);
        let noise = || Noise::stream(seed, Stream::Meter);
        (nominal > 0.0).then(|| Self { nominal, white, bits: config.adc_bits, noise: noise() })
    }

    /// The code at a voltage, relative to the nominal one.
    pub(crate) fn code(&mut self, voltage: f64) -> f64 {
        quantized(self.nominal * voltage + self.white * self.noise.normal(), self.bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_code_goes_with_the_voltage_up_to_full_scale() {
        let mut config = RigConfig::default();
        assert!(Meter::new(&config, 1).is_none());
        config.mains.measured_code = 3000.0;
        config.mains.measured_noise = 0.0;
        let mut meter = Meter::new(&config, 1).unwrap();
        assert_eq!(
            [0.0, 0.9, 1.0001, 1.0003, 2.0].map(|v| meter.code(v)),
            [0.0, 2700.0, 3000.0, 3001.0, 4095.0]
        );
    }

    #[test]
    fn its_noise_is_as_large_as_set() {
        let mut config = RigConfig::default();
        (config.mains.measured_code, config.mains.measured_noise) = (3000.0, 2.0);
        let mut meter = Meter::new(&config, 1).unwrap();
        let codes: Vec<f64> = (0..10_000).map(|_| meter.code(1.0) - 3000.0).collect();
        let variance = codes.iter().map(|x| x * x).sum::<f64>() / codes.len() as f64;
        assert!((variance - 4.0 - 1.0 / 12.0).abs() < 0.3, "{variance}");
    }
}
