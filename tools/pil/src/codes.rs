//! Inputs: the codes of a recorded run, and bit patterns that no converter gives.

use fdi_core::{AdcCode, RawSample};

/// The codes of T0, T1 and T2 at one tick.
pub type Codes = [f32; 3];

/// As the instrument takes them.
pub fn sample(codes: Codes) -> RawSample {
    let [t0, t1, t2] = codes.map(AdcCode);
    RawSample { t0, t1, t2, ..RawSample::default() }
}

/// Numbers that have broken other people's filters: zeros, subnormals, the edges of the limits, infinities, NaNs.
pub const AWKWARD: [f32; 22] = [
    0.0,
    -0.0,
    f32::from_bits(1),
    f32::from_bits(0x8000_0001),
    1e-40,
    -1e-40,
    f32::MIN_POSITIVE,
    f32::EPSILON,
    1.0,
    -1.0,
    40.0,
    40.000004,
    4054.9998,
    4055.0,
    4094.9998,
    4095.0,
    f32::MAX,
    f32::MIN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    f32::from_bits(0xFFA5_5A5A),
];

/// A fixed sequence of numbers (xorshift64), the same on every machine.
#[derive(Clone, Debug)]
pub struct Generator(u64);

impl Generator {
    /// Begins at `seed`, which must not be zero.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 32 bits.
    pub fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 32) as u32
    }

    /// Uniform in `low..high`.
    pub fn uniform(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * ((self.bits() >> 8) as f32 / (1u32 << 24) as f32)
    }

    /// One of [`AWKWARD`].
    pub fn awkward(&mut self) -> f32 {
        AWKWARD[self.bits() as usize % AWKWARD.len()]
    }

    /// Any bit pattern: as often a plausible code, an awkward number, and 32 bits that mean nothing.
    pub fn anything(&mut self) -> f32 {
        match self.bits() % 4 {
            0 | 1 => self.uniform(0.0, 4095.0),
            2 => self.awkward(),
            _ => f32::from_bits(self.bits()),
        }
    }
}
