//! What is soldered to the board's pins, as docs/wiring.md says or as somebody has got it wrong.

/// What the three thermistors read before the rig starts: a little above ambient temperature.
pub const AT_REST: u16 = 2160;

/// What pulls a pin that nothing drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pull {
    /// A resistor to ground, as docs/wiring.md asks for.
    Down,
    /// A resistor to the supply.
    Up,
    /// Nothing: the gate behind the pin may be anything, so the pin counts as high.
    None,
    /// It touches the supply, and is high whatever drives it.
    Short,
}

impl Pull {
    /// Share of the time that a pin which nothing drives is to be taken for high.
    pub fn level(self) -> f64 {
        match self {
            Self::Down => 0.0,
            Self::Up | Self::None | Self::Short => 1.0,
        }
    }
}

/// The circuit around the chip.
#[derive(Clone, Copy, Debug)]
pub struct Wiring {
    /// At the heater's pin, D7.
    pub heater: Pull,
    /// At the contactor's pin, D2.
    pub contactor: Pull,
    /// A contactor is in series with the heater; without one the heater's pin alone heats.
    pub contactor_fitted: bool,
    /// The power stage has failed: it conducts whatever the pin says.
    pub stage_shorted: bool,
    /// The 100 nF from each thermistor's input to ground are there.
    pub capacitors: bool,
    /// How much the PWM moves the thermistors' inputs, peak, in codes: it rises while the heater's pin is high.
    pub ripple: f64,
    /// Noise of each conversion, peak, in codes.
    pub noise: f64,
    /// What the converter makes of the chip's own reference: its 1.21 V at a supply of 3.3 V.
    pub reference: u16,
}

impl Default for Wiring {
    fn default() -> Self {
        Self {
            heater: Pull::Down,
            contactor: Pull::Down,
            contactor_fitted: true,
            stage_shorted: false,
            capacitors: true,
            ripple: 0.0,
            noise: 0.0,
            reference: 1502,
        }
    }
}

impl Wiring {
    /// Resistance in ohm between a thermistor's input and what holds its voltage during a sample of some hundred ns: the
    /// capacitor where there is one, else the divider (10 kohm to the supply) through the filter's 1 kohm.
    pub fn source(&self, code: f64) -> f64 {
        const PULL_UP: f64 = 10_000.0;
        const FILTER: f64 = 1_000.0;
        if self.capacitors {
            return 0.0;
        }
        FILTER + PULL_UP * (code / 4095.0).clamp(0.0, 1.0)
    }

    /// Deviation by the ripple, in codes: a triangle that rises while the heater's pin is high, with a mean of zero.
    pub fn ripple(&self, phase: f64, high: f64) -> f64 {
        if high <= 0.0 || high >= 1.0 {
            return 0.0;
        }
        let rising = phase / high;
        let falling = (phase - high) / (1.0 - high);
        self.ripple * if phase < high { 2.0 * rising - 1.0 } else { 1.0 - 2.0 * falling }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_divider_is_the_pull_up_beside_the_thermistor() {
        let bare = Wiring { capacitors: false, ..Wiring::default() };
        assert!((bare.source(2047.5) - 6000.0).abs() < 1e-6, "10 kohm beside 10 kohm, and the filter");
        assert_eq!(Wiring::default().source(2047.5), 0.0);
    }

    #[test]
    fn the_ripple_has_no_mean() {
        let wiring = Wiring { ripple: 50.0, ..Wiring::default() };
        for high in [0.1, 0.5, 0.9] {
            let mean =
                (0..1000).map(|i| wiring.ripple((f64::from(i) + 0.5) / 1000.0, high)).sum::<f64>() / 1000.0;
            assert!(mean.abs() < 1e-9, "{mean}");
        }
    }
}
