//! Thermistor, divider and converter: from a temperature to what the ADC says, with what can go wrong on the wire.

use crate::config::RigConfig;
use crate::fault::ConverterOutput;
use crate::noise::Noise;
use crate::thermistor::{KELVIN, T25};

/// Largest 12-bit code.
const FULL_SCALE: f64 = 4095.0;

/// The three converters.
pub(crate) struct Digitizer {
    r25_over_pull_up: f64,
    pull_up: f64,
    beta: f64,
    steps: f64,
    /// Code that each channel gave last: what a stuck one repeats. None before the first.
    last: [Option<f64>; 3],
}

/// What the wires make of a thermistor.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wiring {
    /// Resistance across it, ohm.
    pub(crate) shunt: Option<f64>,
    /// Its end at ground lies so much of the reference above it.
    pub(crate) raised: f64,
}

impl Digitizer {
    pub(crate) fn new(config: &RigConfig) -> Self {
        Self {
            r25_over_pull_up: config.r25_over_pull_up(),
            pull_up: config.pull_up,
            beta: config.beta,
            steps: f64::from((1u32 << config.adc_bits) - 1),
            last: [None; 3],
        }
    }

    /// The share of the reference at the thermistors' common end, where the return wire that they share has so many ohm.
    pub(crate) fn raised(&self, celsius: [f64; 3], common_return: f64) -> f64 {
        if common_return == 0.0 {
            return 0.0;
        }
        let each = celsius.map(|celsius| common_return / self.pull_up / (1.0 + self.resistance(celsius)));
        let sum: f64 = each.iter().sum();
        sum / (1.0 + sum)
    }

    /// The code of channel `i` at a temperature, with a resistance of so many ohm across its thermistor, the thermistor's other end `raised` by a share
    /// of the reference, and a hum of so many codes.
    pub(crate) fn code(
        &mut self,
        i: usize,
        celsius: f64,
        wiring: Wiring,
        hum: f64,
        reading: &ConverterOutput,
        noise: &mut Noise,
    ) -> f64 {
        let code = match *reading {
            ConverterOutput::Open => FULL_SCALE,
            ConverterOutput::Short => 0.0,
            ConverterOutput::Stuck { noise: sd } => {
                return self.stuck(i, self.convert(celsius, wiring, hum), sd, noise);
            }
            ConverterOutput::Missing { probability } if noise.uniform(0.0, 1.0) < probability => {
                return f64::NAN;
            }
            ConverterOutput::Missing { .. } | ConverterOutput::True => self.convert(celsius, wiring, hum),
        };
        self.last[i] = Some(code);
        code
    }

    /// What channel `i` said last, with noise of `sd` codes; what it says `now` if it has said nothing yet.
    fn stuck(&mut self, i: usize, now: f64, sd: f64, noise: &mut Noise) -> f64 {
        let held = self.last[i].unwrap_or(now);
        self.last[i] = Some(held);
        let off = if sd > 0.0 { sd * noise.normal() } else { 0.0 };
        let step = FULL_SCALE / self.steps;
        (held + (off / step).round() * step).clamp(0.0, FULL_SCALE)
    }

    /// The temperature that a code stands for, degC; far below any for a code at either end.
    pub(crate) fn celsius(&self, code: f64) -> f64 {
        let r = code / (FULL_SCALE - code) / self.r25_over_pull_up;
        1.0 / (1.0 / T25 + libm::log(r) / self.beta) - KELVIN
    }

    /// Beta equation: resistance of a thermistor over that of the pull-up.
    fn resistance(&self, celsius: f64) -> f64 {
        self.r25_over_pull_up * libm::exp(self.beta * (1.0 / (celsius + KELVIN) - 1.0 / T25))
    }

    /// Ratiometric conversion; the thermistor lies to ground.
    fn convert(&self, celsius: f64, wiring: Wiring, hum: f64) -> f64 {
        let r = self.resistance(celsius);
        let r = wiring.shunt.map_or(r, |ohm| r * ohm / (r * self.pull_up + ohm));
        let ratio = wiring.raised + (1.0 - wiring.raised) * (r / (1.0 + r));
        let step = FULL_SCALE / self.steps;
        (ratio * self.steps + hum / step + 0.5).floor().clamp(0.0, self.steps) * step
    }
}

/// What a converter of so many bits makes of a voltage given as a code.
pub(crate) fn quantized(code: f64, bits: u32) -> f64 {
    let step = FULL_SCALE / f64::from((1u32 << bits) - 1);
    (code.clamp(0.0, FULL_SCALE) / step).round() * step
}
