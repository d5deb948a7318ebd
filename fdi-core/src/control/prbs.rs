//! Pseudo-random binary signal of maximal length, added to the PID's output so that the loop stays identifiable
//! while it is closed (paper, section 2.3).
//!
//! ```
//! use fdi_core::control::prbs::{Prbs, PrbsConfig};
//! use fdi_core::Percent;
//!
//! let prbs = Prbs::new(&PrbsConfig { bits: 3, samples_per_bit: 1, amplitude: Percent(5.0), start: 1 })?;
//! let mut state = prbs.start();
//! let period: Vec<f32> = (0..7).map(|_| prbs.step(&mut state).0).collect(); // 2^3 - 1 samples
//! assert!(period.iter().all(|x| x.abs() == 5.0));
//! assert_eq!(period.iter().sum::<f32>().abs(), 5.0); // one more of one sign than of the other
//! # Ok::<(), fdi_core::ConfigError>(())
//! ```

use crate::error::{ConfigError, in_range};
use crate::settings::{check, settings};
use crate::units::Percent;

settings! {
    /// Excitation, a pseudo-random binary sequence added to the output of the PID.
    pub struct PrbsConfig: Prbs "prbs." {
        /// Length of the shift register; the sequence repeats after `2^bits - 1` bits.
        bits: u8 = 10, 3..=16;
        /// Samples that a bit lasts.
        samples_per_bit: u8 = 2, 1..=100;
        /// Half of the peak-to-peak value.
        amplitude: Percent = 5.1, 0.0..=50.0;
        /// Content of the register at the start, of `bits` bits: where in its sequence it begins. A run of the simulation moves
        /// it with its seed; seed 1 leaves it.
        start: u16 = 1, 1..=65535;
    }
}

/// Shortest register that [`TAPS`] covers.
const MIN_BITS: u8 = 3;

/// Feedback masks of primitive polynomials, from `MIN_BITS` on, one for each length that is allowed: bit i - 1 is set where x^i is tapped.
const TAPS: [u16; 14] = [
    tap(&[3, 2]),
    tap(&[4, 3]),
    tap(&[5, 3]),
    tap(&[6, 5]),
    tap(&[7, 6]),
    tap(&[8, 6, 5, 4]),
    tap(&[9, 5]),
    tap(&[10, 7]),
    tap(&[11, 9]),
    tap(&[12, 11, 10, 4]),
    tap(&[13, 12, 11, 8]),
    tap(&[14, 13, 12, 2]),
    tap(&[15, 14]),
    tap(&[16, 15, 13, 4]),
];

const fn tap(powers: &[u32]) -> u16 {
    let mut mask = 0;
    let mut i = 0;
    while i < powers.len() {
        mask |= 1 << (powers[i] - 1);
        i += 1;
    }
    mask
}

/// A validated generator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prbs {
    taps: u16,
    mask: u16,
    samples_per_bit: u8,
    amplitude: f32,
    start: u16,
}

/// The register and the sample within the current bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrbsState {
    register: u16,
    sample: u8,
}

impl Prbs {
    /// Builds the generator.
    ///
    /// # Errors
    /// The parameter that is out of bounds.
    pub fn new(c: &PrbsConfig) -> Result<Self, ConfigError> {
        check(PrbsConfig::SETTINGS[0], c)?;
        let mask = u16::MAX >> (u16::BITS - u32::from(c.bits));
        in_range("prbs.start", f32::from(c.start), 1.0, f32::from(mask))?;
        Ok(Self {
            taps: TAPS[usize::from(c.bits - MIN_BITS)],
            mask,
            samples_per_bit: c.samples_per_bit,
            amplitude: c.amplitude.0,
            start: c.start,
        })
    }

    /// A generator at the start of its sequence.
    pub fn start(&self) -> PrbsState {
        PrbsState { register: self.start, sample: 0 }
    }

    /// The excitation of this tick: plus or minus the amplitude.
    pub fn step(&self, state: &mut PrbsState) -> Percent {
        if state.sample == 0 {
            let feedback = (state.register & self.taps).count_ones() as u16 & 1;
            state.register = (state.register << 1 | feedback) & self.mask;
            if state.register == 0 {
                state.register = 1; // after a change to fewer bits: zero would stay zero
            }
        }
        state.sample += 1;
        if state.sample >= self.samples_per_bit {
            state.sample = 0;
        }
        Percent(if state.register & 1 == 1 { self.amplitude } else { -self.amplitude })
    }
}
