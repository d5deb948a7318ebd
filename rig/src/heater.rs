//! The heater before the air: a drive that is not straight, and a wire with a heat capacity.

use crate::constants::constants;

constants! {
    /// The heater: its drive and its wire.
    pub struct HeaterConfig / HeaterChanges in "rig.heater" {
        /// Bend q of the drive: asked for u %, it gives u (1 + q (u - 50)/50), never less than 0.
        bend: f64 = 0.0, -0.5..=0.5;
        /// Time constant of the wire at nominal flow, s (0: no heat capacity).
        wire_time: f64 = 0.0, 0.0..=1000.0;
    }
}

/// The heater in motion.
pub(crate) struct Heater {
    config: HeaterConfig,
    /// The wire's temperature above the air, as the power that it gives at nominal flow, % of the power.
    wire: f64,
}

impl Heater {
    pub(crate) fn new(config: &HeaterConfig) -> Self {
        Self { config: config.clone(), wire: 0.0 }
    }

    /// Whether the power given changes within a tick.
    pub(crate) fn is_restless(&self) -> bool {
        self.config.wire_time > 0.0
    }

    /// The power of the drive that is asked for `asked` %.
    pub(crate) fn driven(&self, asked: f64) -> f64 {
        if self.config.bend == 0.0 {
            return asked;
        }
        (asked * (1.0 + self.config.bend * (asked - 50.0) / 50.0)).max(0.0)
    }

    /// The mean of what the wire gives to the air over a short stretch of time with constant power. The film coefficient
    /// goes against `slowness`, and the wire's time constant against the coefficient.
    pub(crate) fn warm(&mut self, power: f64, slowness: f64, span: f64) -> f64 {
        if self.config.wire_time == 0.0 {
            return power;
        }
        let (time, before) = (self.config.wire_time * slowness, self.wire / slowness);
        let given = power + (before - power) * libm::exp(-span / time);
        self.wire = given * slowness;
        power + (before - given) * time / span
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_drive_bends_between_its_ends() {
        let bent = |bend, asked| Heater::new(&HeaterConfig { bend, ..HeaterConfig::default() }).driven(asked);
        for (bend, asked, given) in
            [(0.3, 0.0, 0.0), (0.3, 50.0, 50.0), (0.3, 100.0, 130.0), (0.3, 25.0, 21.25), (-0.5, 100.0, 50.0)]
        {
            assert!((bent(bend, asked) - given).abs() < 1e-12, "bend {bend}, {asked} %");
        }
        assert!(bent(0.0, 41.7) == 41.7);
    }

    /// All energy arrives, late: what is missing at the end is in the wire.
    #[test]
    fn the_wire_keeps_what_it_does_not_give() {
        let mut heater = Heater::new(&HeaterConfig { wire_time: 0.3, ..HeaterConfig::default() });
        let slowness = 0.8;
        let spans = [0.01, 0.1, 0.02, 0.37];
        let arrived: f64 = spans.iter().map(|&span| heater.warm(40.0, slowness, span) * span).sum();
        let stored = heater.wire * 0.3;
        assert!((arrived + stored - 40.0 * 0.5).abs() < 1e-12);
        assert!((heater.wire / slowness - 40.0 * (1.0 - (-0.5_f64 / 0.24).exp())).abs() < 1e-12);
        // Less air takes less from a wire of the same temperature, until it is hotter.
        let before = heater.wire;
        assert!((heater.warm(40.0, 1.6, 1e-6) - before / 1.6).abs() < 1e-3);
        assert!(Heater::new(&HeaterConfig::default()).warm(41.7, 1.0, 0.11) == 41.7);
    }
}
