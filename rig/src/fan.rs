//! The fan: its flow takes its time and hunts, and how rough the air is goes with it.

use std::f64::consts::TAU;

use crate::constants::constants;
use crate::noise::{Noise, Stream};

constants! {
    /// The fan, whose flow hunts and takes its time.
    pub struct FanConfig / FanChanges in "rig.fan" {
        /// Amplitude of the flow's hunting, relative (0: none).
        hunting: f64 = 0.0, 0.0..=0.5;
        /// Period of the hunting, s; the seed sets its phase.
        period: f64 = 3.0, 0.05..=1000.0;
        /// Time constant with which the flow follows a change, s (0: at once).
        lag: f64 = 0.0, 0.0..=100.0;
        /// The turbulence's standard deviation goes with the flow to the power of this.
        turbulence_exponent: f64 = 0.0, -3.0..=3.0;
        /// Flow by free convection when the fan stands still, relative (our choice: 0.1 m/s against some 4 m/s).
        free_flow: f64 = 0.03, 0.001..=0.2;
        /// What the housing takes by conduction and radiation while the fan stands still: of the heat exp(-housing / flow) reaches T1.
        housing: f64 = 0.06, 0.0..=1.0;
    }
}

/// The fan in motion.
pub(crate) struct Fan {
    config: FanConfig,
    phase: f64,
    /// Flow without hunting, relative.
    flow: f64,
}

impl Fan {
    pub(crate) fn new(config: &FanConfig, seed: u64) -> Self {
        let hunts = config.hunting > 0.0;
        let phase = if hunts { Noise::stream(seed, Stream::Fan).uniform(0.0, TAU) } else { 0.0 };
        Self { config: config.clone(), phase, flow: 1.0 }
    }

    /// Whether the flow changes within a tick.
    pub(crate) fn is_restless(&self) -> bool {
        self.config.hunting > 0.0 || self.config.lag > 0.0
    }

    /// The mean flow over a short stretch of time in which the flow `asked` would come at once.
    pub(crate) fn blow(&mut self, asked: f64, (from, to): (f64, f64)) -> f64 {
        let mean = if self.config.lag > 0.0 {
            let (span, before) = (to - from, self.flow);
            self.flow = asked + (before - asked) * libm::exp(-span / self.config.lag);
            asked + (before - self.flow) * self.config.lag / span
        } else {
            self.flow = asked;
            asked
        };
        mean * self.hunting(0.5 * (from + to))
    }

    /// The flow with what moves by itself, and the share of the heat that reaches T1: the rest goes into the housing. Both fade as soon as the fan blows.
    pub(crate) fn with_free_convection(&self, flow: f64) -> (f64, f64) {
        let c = &self.config;
        let still = libm::exp(-flow / c.free_flow);
        let flow = flow + c.free_flow * still;
        (flow, libm::exp(-c.housing * still / flow))
    }

    /// The flow at the end of the last stretch, time `t`.
    pub(crate) fn flow(&self, asked: f64, t: f64) -> f64 {
        (if self.config.lag > 0.0 { self.flow } else { asked }) * self.hunting(t)
    }

    fn hunting(&self, t: f64) -> f64 {
        if self.config.hunting > 0.0 {
            1.0 + self.config.hunting * libm::sin(TAU * t / self.config.period + self.phase)
        } else {
            1.0
        }
    }

    /// Standard deviation of the turbulence at a flow, relative.
    pub(crate) fn roughness(&self, flow: f64) -> f64 {
        let exponent = self.config.turbulence_exponent;
        if exponent == 0.0 { 1.0 } else { libm::pow(flow, exponent) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hunting_is_a_sine_of_its_amplitude_and_period_about_the_flow() {
        let config = FanConfig { hunting: 0.03, period: 2.0, ..FanConfig::default() };
        let mut fan = Fan::new(&config, 7);
        let flows: Vec<f64> =
            (0..2000).map(|n| fan.blow(1.2, (f64::from(n) * 0.01, f64::from(n + 1) * 0.01))).collect();
        let mean = flows.iter().sum::<f64>() / 2000.0;
        let largest = flows.iter().copied().fold(0.0, f64::max);
        assert!((mean - 1.2).abs() < 1e-9 && (largest - 1.236).abs() < 1e-4, "{mean} {largest}");
        assert!(flows[..1800].iter().zip(&flows[200..]).all(|(a, b)| (a - b).abs() < 1e-9));
        assert!(Fan::new(&config, 8).phase != fan.phase);
    }

    /// What has been blown in all is the integral of the exponential, whatever the stretches.
    #[test]
    fn the_flow_follows_with_its_lag() {
        let mut fan = Fan::new(&FanConfig { lag: 0.2, ..FanConfig::default() }, 1);
        let stretches = [(0.0, 0.03), (0.03, 0.11), (0.11, 0.5)];
        let blown: f64 = stretches.iter().map(|&s| fan.blow(1.5, s) * (s.1 - s.0)).sum();
        let left = (-0.5_f64 / 0.2).exp();
        assert!((fan.flow(1.5, 0.5) - (1.5 - 0.5 * left)).abs() < 1e-12);
        assert!((blown - (0.75 - 0.5 * 0.2 * (1.0 - left))).abs() < 1e-12);
    }

    #[test]
    fn off_it_gives_what_is_asked_bit_by_bit() {
        let mut fan = Fan::new(&FanConfig::default(), 1);
        assert!(
            fan.blow(1.26, (0.0, 0.11)) == 1.26 && fan.flow(0.3, 1.0) == 0.3 && fan.roughness(0.3) == 1.0
        );
        let rough = Fan::new(&FanConfig { turbulence_exponent: 2.0, ..FanConfig::default() }, 1);
        assert!((rough.roughness(0.5) - 0.25).abs() < 1e-12);
    }
}
