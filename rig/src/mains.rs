//! The mains: their voltage V, relative to the nominal one, wanders and steps. The heater's power goes as V squared.

use crate::constants::constants;
use crate::noise::{Noise, OrnsteinUhlenbeck, Stream};

constants! {
    /// The mains, whose voltage V moves; the heater's power goes as V squared.
    pub struct MainsConfig / MainsChanges in "rig.mains" {
        /// Standard deviation of the voltage's walk, % (0: none).
        walk: f64 = 0.0, 0.0..=10.0;
        /// Correlation time of the walk, s.
        walk_time: f64 = 60.0, 0.1..=1e6;
        /// Steps of the voltage an hour, in the mean (0: none).
        steps: f64 = 0.0, 0.0..=3600.0;
        /// Standard deviation of the level that a step leads to, %.
        step_size: f64 = 1.0, 0.0..=10.0;
        /// The fan's flow goes as the voltage to the power of this.
        fan_exponent: f64 = 0.0, 0.0..=3.0;
        /// Code that the board's input for the supply reads at the nominal voltage (0: it is not measured).
        measured_code: f64 = 0.0, 0.0..=4095.0;
        /// Standard deviation of that input's noise, codes.
        measured_noise: f64 = 1.0, 0.0..=100.0;
    }
}

/// Lowest voltage, relative: some air always flows.
const LOWEST: f64 = 0.1;

/// The mains in motion; they change at ticks.
pub(crate) struct Mains {
    noise: Noise,
    walk: OrnsteinUhlenbeck,
    /// Probability of a step within a tick.
    chance: f64,
    step_size: f64,
    fan_exponent: f64,
    /// What the last step led to, relative.
    level: f64,
}

impl Mains {
    /// None if nothing of it is on.
    pub(crate) fn new(config: &MainsConfig, interval: f64, seed: u64) -> Option<Self> {
        let is_on = config.walk > 0.0 || config.steps > 0.0;
        is_on.then(|| {
            let mut noise = Noise::stream(seed, Stream::Mains);
            Self {
                walk: OrnsteinUhlenbeck::new(config.walk / 100.0, config.walk_time, interval, &mut noise),
                chance: -libm::expm1(-config.steps * interval / 3600.0),
                step_size: config.step_size / 100.0,
                fan_exponent: config.fan_exponent,
                level: 0.0,
                noise,
            }
        })
    }

    /// Relative to the nominal one.
    pub(crate) fn voltage(&self) -> f64 {
        (1.0 + self.walk.value() + self.level).max(LOWEST)
    }

    /// Power of the heater, relative.
    pub(crate) fn power(&self) -> f64 {
        self.voltage() * self.voltage()
    }

    /// Flow of the fan, relative.
    pub(crate) fn flow(&self) -> f64 {
        libm::pow(self.voltage(), self.fan_exponent)
    }

    /// Moves on by one tick. It draws as much whether a step comes or not, so that steps leave the walk alone.
    pub(crate) fn step(&mut self) {
        self.walk.step(&mut self.noise);
        let (chance, level) = (self.noise.uniform(0.0, 1.0), self.noise.normal());
        if chance < self.chance {
            self.level = self.step_size * level;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(config: &MainsConfig, ticks: usize) -> Vec<f64> {
        let mut mains = Mains::new(config, 0.11, 1).unwrap();
        let voltage = |_| {
            mains.step();
            assert!((mains.power() - mains.voltage().powi(2)).abs() < 1e-12);
            mains.voltage()
        };
        (0..ticks).map(voltage).collect()
    }

    #[test]
    fn steps_come_as_often_and_are_as_large_as_set() {
        let config = MainsConfig { steps: 60.0, step_size: 2.0, ..MainsConfig::default() };
        let voltages = run(&config, 2_000_000);
        let levels: Vec<f64> = voltages.windows(2).filter(|v| v[0] != v[1]).map(|v| v[1] - 1.0).collect();
        let hours = 2e6 * 0.11 / 3600.0;
        let rate = levels.len() as f64 / hours;
        assert!((rate - 60.0).abs() < 3.0, "{rate} an hour");
        let sd = (levels.iter().map(|x| x * x).sum::<f64>() / levels.len() as f64).sqrt();
        assert!((sd - 0.02).abs() < 0.001, "{sd}");
    }

    #[test]
    fn the_walk_is_as_wide_as_set_and_steps_leave_it_alone() {
        let config = MainsConfig { walk: 0.5, walk_time: 5.0, ..MainsConfig::default() };
        let walk = run(&config, 500_000);
        let sd = (walk.iter().map(|v| (v - 1.0).powi(2)).sum::<f64>() / walk.len() as f64).sqrt();
        assert!((sd - 0.005).abs() < 0.0002, "{sd}");
        let both = run(&MainsConfig { steps: 60.0, step_size: 0.0, ..config }, 1000);
        assert_eq!(both, walk[..1000]);
    }

    #[test]
    fn the_fan_follows_by_its_exponent() {
        let config = MainsConfig { walk: 2.0, fan_exponent: 0.5, ..MainsConfig::default() };
        let mains = Mains::new(&config, 0.11, 1).unwrap();
        assert!((mains.flow().powi(4) - mains.power()).abs() < 1e-12 && mains.flow() != 1.0);
        assert!(Mains::new(&MainsConfig::default(), 0.11, 1).is_none());
    }
}
