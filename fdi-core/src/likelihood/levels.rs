//! Where the residuals are now: means over a few ticks, by which an alarm is seen to end.

use super::fit::NA;
use crate::filter::LowPass;
use crate::vector::{dot, shift};

/// Memory of the means: two ticks and a half, a compromise of noise and delay. Tuned.
const MEMORY: LowPass = LowPass::over(2.5);

/// The means.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Levels {
    /// Of the residuals, degC.
    pub(super) residual: [f32; 3],
    /// Of A(z) times the residual of y1, degC: what drives it, without what is only decaying.
    pub(super) drive: f32,
    past: [f32; NA],
}

impl Levels {
    /// Residuals of a tick, where valid, degC; `a` is A of the model of y1.
    pub(super) fn step(&mut self, e: &[Option<f32>; 3], a: &[f32; NA]) {
        for (level, e) in self.residual.iter_mut().zip(e) {
            if let Some(e) = e {
                MEMORY.follow(level, *e);
            }
        }
        if let Some(e) = e[0] {
            let drive = e + dot(a, &self.past);
            MEMORY.follow(&mut self.drive, drive);
            shift(&mut self.past, e);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A residual that decays as the model does is driven by nothing; one that is held is.
    #[test]
    fn what_only_decays_has_no_drive() {
        let (a, mut levels, mut e) = ([-0.8, 0.0, 0.0], Levels::default(), 1.0);
        for _ in 0..20 {
            levels.step(&[Some(e), None, None], &a);
            e *= 0.8;
        }
        assert!(levels.drive.abs() < 1e-4 && levels.residual[0] > 0.01, "{levels:?}");
        for _ in 0..20 {
            levels.step(&[Some(1.0), None, None], &a);
        }
        assert!((levels.drive - 0.2).abs() < 1e-4 && levels.residual[1..] == [0.0; 2], "{levels:?}");
    }
}
