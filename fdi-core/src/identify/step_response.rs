//! The unit step response of a model, a sample at a time, until it first crosses a level.
//!
//! How many samples that takes depends on the model, from one to dozens. Whoever has to answer in constant time computes
//! a few of them a tick and has the answer a few ticks later.

use super::transfer::Transfer;
use crate::vector::shift;

/// A step response under way.
#[derive(Clone, Copy, Debug)]
pub struct StepResponse<const NA: usize, const NB: usize> {
    model: Transfer<NA, NB>,
    level: f32,
    /// Sum of the coefficients of u that the step has reached.
    forcing: f32,
    /// The last outputs, newest first.
    y: [f32; NA],
    /// Samples computed, those without an output not counted.
    samples: u16,
}

impl<const NA: usize, const NB: usize> StepResponse<NA, NB> {
    const HAS_OUTPUTS: () = assert!(NA > 0, "a model has past outputs");

    /// The response of `model`, at rest, to a step that comes now. `level` is in units of y and positive.
    #[inline]
    pub fn new(model: Transfer<NA, NB>, level: f32) -> Self {
        let () = Self::HAS_OUTPUTS;
        Self { model, level, forcing: 0.0, y: [0.0; NA], samples: 0 }
    }

    /// Samples computed so far, without those before the step reaches the output.
    #[inline]
    pub fn samples(&self) -> u16 {
        self.samples
    }

    /// Computes `COUNT` samples, at the start NB more, but none beyond the first that reaches the level: then the time of
    /// the crossing in samples after the step, linearly interpolated, and the response is over. As all before it lie
    /// below, the crossing is an upward one.
    #[inline(always)]
    pub fn advance<const COUNT: usize>(&mut self) -> Option<f32> {
        let mut ahead = *self; // what has crossed need not be kept, so this can live in registers
        if self.samples == 0 {
            for b in self.model.b {
                ahead.forcing += b;
                if let Some(time) = ahead.sample() {
                    return Some(time);
                }
            }
        }
        for _ in 0..COUNT {
            if let Some(time) = ahead.sample() {
                return Some(time);
            }
        }
        *self = ahead;
        None
    }

    /// Computes one sample.
    #[inline(always)]
    fn sample(&mut self) -> Option<f32> {
        let mut now = self.forcing;
        for i in 0..NA {
            now -= self.model.a[i] * self.y[i];
        }
        let before = self.y[0];
        if now >= self.level {
            let whole = f32::from(self.samples) + (self.model.nk.max(1) - 1) as f32;
            return Some(whole + (self.level - before) / (now - before));
        }
        shift(&mut self.y, now);
        self.samples = self.samples.saturating_add(1);
        None
    }
}

impl<const NA: usize, const NB: usize> Transfer<NA, NB> {
    /// First upward crossing of `level` by the unit step response, in samples after the step, linearly interpolated;
    /// `None` if it does not come within `max_steps` samples. `level` is in units of y and positive.
    pub fn rise_time(&self, level: f32, max_steps: u16) -> Option<f32> {
        let mut response = StepResponse::new(*self, level);
        while response.samples() < max_steps {
            if let Some(time) = response.advance::<1>() {
                return Some(time).filter(|&time| time <= f32::from(max_steps));
            }
        }
        None
    }
}
