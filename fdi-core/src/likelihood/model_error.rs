//! The model-error bound: how far the residuals may be from zero although nothing is wrong. The charts' allowance is widened by it.
//!
//! Three causes, each in degC: a share of any swing of the temperature beyond the usual, a share of the distance from
//! where training took place, and the whole of a jump of the ambient, which the three thermistors do not follow alike. A
//! fault that has just ended leaves a fourth: what is still decaying.

use super::noise::NoiseModel;
use crate::bounds::larger;
use crate::filter::LowPass;

// Tuned on seeds 1 to 99999 of the reference rig, lively, with steps and ramps of the set-point (docs/diagnosis.md, section 12).
/// Swings of T1 up to this size are part of regulation with excitation, degC.
const USUAL_SWING: f32 = 1.5;
/// T0 may depart by so much from its own mean before it counts as moving, degC: its noise.
const AMBIENT_NOISE: f32 = 0.15;
/// Memory of swings, s.
const SWING_TIME: f32 = 2.0;
/// Memory of the ambient's mean, s.
const AMBIENT_TIME: f32 = 1.0;
/// What a past fault left dies out with this time constant, s.
const AFTERMATH_TIME: f32 = 0.6;
/// It is bounded by this multiple of the residual at the end of the fault.
const AFTERMATH: f32 = 2.0;

/// The bound, validated.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModelError {
    uncertainty: f32,
    swing: LowPass,
    ambient: LowPass,
    aftermath: LowPass,
}

/// Its memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModelErrorState {
    /// Rise of T1 in training, degC.
    trained: f32,
    mean_rise: f32,
    swing: f32,
    ambient: Option<f32>,
    aftermath: [f32; 3],
}

/// The bound for each residual, in standard deviations of its innovation.
#[derive(Clone, Copy, Debug)]
pub(super) struct ErrorBound {
    /// Of the models.
    pub(super) model: [f32; 3],
    /// Of the models and the ambient.
    pub(super) all: [f32; 3],
}

impl ModelError {
    /// `uncertainty` is the share of a swing that the models may get wrong; Ts in s.
    pub(super) fn new(uncertainty: f32, sample_time: f32) -> Self {
        let over = |time| LowPass::euler(time, sample_time);
        Self {
            uncertainty,
            swing: over(SWING_TIME),
            ambient: over(AMBIENT_TIME),
            aftermath: over(AFTERMATH_TIME),
        }
    }

    /// The bound on this tick: `expected` is what y1 should be, `t0` the ambient temperature if it may be used, degC.
    pub(super) fn step(
        &self,
        s: &mut ModelErrorState,
        expected: f32,
        t0: Option<f32>,
        noise: &[NoiseModel; 3],
    ) -> ErrorBound {
        self.swing.follow(&mut s.mean_rise, expected);
        s.swing = larger(s.swing * (1.0 - self.swing.share()), (expected - s.mean_rise).abs());
        let moved = self.uncertainty * larger(0.0, s.swing - USUAL_SWING);
        let away = self.uncertainty * (expected - s.trained).abs();
        let ambient = self.ambient_jump(s, t0);
        let model = core::array::from_fn(|m| {
            let whitener = &noise[m].whitener;
            (moved + away * whitener.rest() + s.aftermath[m]) * whitener.inv_sigma()
        });
        for left in &mut s.aftermath {
            self.aftermath.follow(left, 0.0);
        }
        // T2 answers to the ambient as slowly as T0 does, T1 faster: only what T1 is part of sees the ambient jump.
        let all = core::array::from_fn(|m| {
            model[m] + if m == 1 { 0.0 } else { ambient * noise[m].whitener.inv_sigma() }
        });
        ErrorBound { model, all }
    }

    fn ambient_jump(&self, s: &mut ModelErrorState, t0: Option<f32>) -> f32 {
        let Some(t0) = t0 else { return 0.0 };
        let mean = s.ambient.get_or_insert(t0);
        let jump = (t0 - *mean).abs();
        self.ambient.follow(mean, t0);
        larger(0.0, jump - AMBIENT_NOISE)
    }
}

impl ModelErrorState {
    /// Right after training at the rise `trained` of T1, degC.
    pub(super) fn new(trained: f32) -> Self {
        Self { trained, mean_rise: trained, swing: 0.0, ambient: None, aftermath: [0.0; 3] }
    }

    /// A fault has ended and left residuals at these levels, degC.
    pub(super) fn fault_ended(&mut self, levels: [f32; 3]) {
        self.aftermath = levels.map(|level| AFTERMATH * level.abs());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::likelihood::whitening::Whitener;

    const TS: f32 = 0.11;

    /// Innovations of 0.1 degC, and half of a constant residual left after whitening.
    fn noise() -> [NoiseModel; 3] {
        let r0 = 0.01 / (1.0 - 0.25);
        let whitener = Whitener::from_autocovariance(&[1.0, 0.5, 0.25, 0.125].map(|r| r0 * r)).unwrap();
        [NoiseModel { whitener, ..NoiseModel::default() }; 3]
    }

    #[test]
    fn at_rest_where_it_was_trained_nothing_is_allowed_for() {
        let (error, mut s) = (ModelError::new(0.02, TS), ModelErrorState::new(20.0));
        for _ in 0..100 {
            assert_eq!(error.step(&mut s, 20.0, Some(22.0), &noise()).all, [0.0; 3]);
        }
    }

    /// 10 degC away from training, at rest again: 2 % of it, whitened, in standard deviations.
    #[test]
    fn a_share_of_the_distance_from_training_stays() {
        let (error, mut s) = (ModelError::new(0.02, TS), ModelErrorState::new(20.0));
        let mut step = || error.step(&mut s, 30.0, None, &noise()).model[0];
        let first = step();
        let last = (0..400).map(|_| step()).last().unwrap();
        assert!(first > last + 1.0, "the step itself is a swing: {first} {last}");
        assert!((last - 0.02 * 10.0 * 0.5 / 0.1).abs() < 1e-2, "{last}");
    }

    #[test]
    fn a_jump_of_the_ambient_counts_for_what_t1_is_part_of() {
        let (error, mut s) = (ModelError::new(0.02, TS), ModelErrorState::new(20.0));
        error.step(&mut s, 20.0, Some(22.0), &noise());
        let bound = error.step(&mut s, 20.0, Some(24.0), &noise());
        assert_eq!((bound.model, bound.all[1]), ([0.0; 3], 0.0));
        assert!((bound.all[0] - (2.0 - AMBIENT_NOISE) / 0.1).abs() < 0.1, "{bound:?}");
    }

    #[test]
    fn what_a_fault_left_dies_out() {
        let (error, mut s) = (ModelError::new(0.02, TS), ModelErrorState::new(20.0));
        s.fault_ended([1.0, -1.0, 0.0]);
        let first = error.step(&mut s, 20.0, None, &noise()).model;
        assert!((first[0] - 20.0).abs() < 0.01 && first[0] == first[1] && first[2] == 0.0, "{first:?}");
        let after = (0..50).map(|_| error.step(&mut s, 20.0, None, &noise()).model[0]).last().unwrap();
        assert!(after < 0.01, "{after}");
    }
}
