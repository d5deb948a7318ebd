//! The unit step response of a model, a sample at a time, until it first crosses a level.
//!
//! How many samples that takes depends on the model, from one to dozens. Whoever has to answer in constant time computes
//! a few of them a tick and has the answer a few ticks later.

use super::transfer::Transfer;

/// A step response under way.
#[derive(Clone, Copy, Debug)]
pub struct StepResponse<const NA: usize, const NB: usize> {
    model: Transfer<NA, NB>,
    level: f32,
    /// Sum of the coefficients of u that the step has reached.
    forcing: f32,
    /// The last outputs, newest first.
    y: [f32; NA],
    /// Samples computed, without the dead time.
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

    /// Time computed so far, in samples since the step.
    #[inline]
    pub fn samples(&self) -> u16 {
        self.samples.saturating_add(u16::try_from(self.model.nk.saturating_sub(1)).unwrap_or(u16::MAX))
    }

    /// Computes `COUNT` samples, at the start NB more, but none beyond the first that reaches the level: then the time of
    /// the crossing in samples after the step, linearly interpolated. As all before it lie below, it is an upward one.
    #[inline(always)]
    pub fn advance<const COUNT: usize>(&mut self) -> Option<f32> {
        for (i, b) in self.model.b.into_iter().enumerate() {
            if usize::from(self.samples) == i {
                self.forcing += b;
                if let Some(time) = self.sample() {
                    return Some(time);
                }
            }
        }
        (0..COUNT).find_map(|_| self.sample())
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
            return Some(f32::from(self.samples()) + (self.level - before) / (now - before));
        }
        for i in (1..NA).rev() {
            self.y[i] = self.y[i - 1];
        }
        self.y[0] = now;
        self.samples = self.samples.saturating_add(1);
        None
    }
}
