//! First-order low-pass.

use crate::units::Seconds;

/// First-order low-pass `x_f += (1 - a)(x - x_f)`, `a = exp(-wc Ts)`, that starts at its first input.
#[derive(Clone, Copy, Debug)]
pub struct LowPass {
    share: f32,
}

/// The memory of a bank of `M` low-passes; `None` until the first input.
pub type LowPassState<const M: usize> = Option<[f32; M]>;

impl LowPass {
    /// A filter with the cut-off in rad/s; both arguments must be positive and finite.
    pub fn new(cutoff: f32, sample_time: Seconds) -> Self {
        Self { share: 1.0 - libm::expf(-cutoff * sample_time.0) }
    }

    /// Filters `M` signals at once.
    pub fn step<const M: usize>(&self, state: &mut LowPassState<M>, input: &[f32; M]) -> [f32; M] {
        let before = state.unwrap_or(*input);
        let after = core::array::from_fn(|i| before[i] + self.share * (input[i] - before[i]));
        *state = Some(after);
        after
    }
}
