//! Pick-up: the mains' hum on the wires of the thermistors, which sampling folds down to a slow beat.

use std::f64::consts::TAU;

use crate::constants::constants;
use crate::noise::{Noise, Stream};

constants! {
    /// Hum that the thermistors' wires pick up.
    pub struct PickupConfig / PickupChanges in "rig.pickup" {
        /// Amplitude, codes of the 12-bit scale (0: none).
        codes: f64 = 0.0, 0.0..=500.0;
        /// Frequency, Hz; sampling folds it below 1/(2 Ts). The seed sets the phase of each wire.
        frequency: f64 = 50.03, 0.001..=1000.0;
    }
}

/// The hum on the three wires.
pub(crate) struct Pickup {
    config: PickupConfig,
    phases: [f64; 3],
}

impl Pickup {
    /// None if it is off.
    pub(crate) fn new(config: &PickupConfig, seed: u64) -> Option<Self> {
        (config.codes > 0.0).then(|| {
            let mut noise = Noise::stream(seed, Stream::Pickup);
            Self { config: config.clone(), phases: [(); 3].map(|()| noise.uniform(0.0, TAU)) }
        })
    }

    /// What input `i` has too much, codes.
    pub(crate) fn codes(&self, i: usize, t: f64) -> f64 {
        self.config.codes * libm::sin(TAU * self.config.frequency * t + self.phases[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 50.03 Hz sampled every 0.1 s is 0.03 Hz.
    #[test]
    fn sampling_folds_the_hum_down() {
        let hum = |frequency| Pickup::new(&PickupConfig { codes: 3.0, frequency }, 5).unwrap();
        let (fast, slow) = (hum(50.03), hum(0.03));
        for i in 0..3 {
            for n in 0..1000 {
                let t = f64::from(n) * 0.1;
                assert!((fast.codes(i, t) - slow.codes(i, t)).abs() < 1e-6);
            }
        }
        assert!(Pickup::new(&PickupConfig::default(), 5).is_none());
    }
}
