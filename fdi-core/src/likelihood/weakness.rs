//! Where the models are known to be weak, and by how much the charts are to be slackened there.
//!
//! Three causes, each in degC: a share of any swing of the temperature beyond the usual, a share of the distance from
//! where training took place, and the whole of a jump of the room, which the three thermistors do not follow alike. A
//! fault that has just ended leaves a fourth: what is still decaying.

use super::noise::Normal;
use crate::bounds::larger;

/// Swings of T1 up to this size are part of regulation with excitation, degC.
const USUAL_SWING: f32 = 1.5;
/// T0 may depart by so much from its own mean before it counts as moving, degC.
const AMBIENT_NOISE: f32 = 0.15;
/// Memory of swings, of the room's mean, and of what a past fault left, s.
const SWING_TIME: f32 = 2.0;
const AMBIENT_TIME: f32 = 1.0;
const AFTERMATH_TIME: f32 = 0.6;

/// The shares of the memories that are renewed in a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weakness {
    uncertainty: f32,
    swing: f32,
    ambient: f32,
    aftermath: f32,
}

/// The memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct WeaknessState {
    /// Rise of T1 in training.
    trained: f32,
    mean_rise: f32,
    swing: f32,
    ambient: Option<f32>,
    aftermath: [f32; 3],
}

/// By how much to slacken, in standard deviations of each residual.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slack {
    /// By what the models don't know of the rig.
    pub(super) model: [f32; 3],
    /// By that and by the room.
    pub(super) all: [f32; 3],
}

impl Weakness {
    pub(super) fn new(uncertainty: f32, sample_time: f32) -> Self {
        let share = |time: f32| (sample_time / time).min(1.0);
        Self {
            uncertainty,
            swing: share(SWING_TIME),
            ambient: share(AMBIENT_TIME),
            aftermath: share(AFTERMATH_TIME),
        }
    }

    /// `expected` is what y1 should be; `t0` the ambient temperature, if it may be used.
    pub(super) fn step(
        &self,
        s: &mut WeaknessState,
        expected: f32,
        t0: Option<f32>,
        normal: &[Normal; 3],
    ) -> Slack {
        s.mean_rise += self.swing * (expected - s.mean_rise);
        s.swing = larger(s.swing * (1.0 - self.swing), (expected - s.mean_rise).abs());
        let moved = self.uncertainty * larger(0.0, s.swing - USUAL_SWING);
        let away = self.uncertainty * (expected - s.trained).abs();
        let ambient = self.ambient_jump(s, t0);
        let model = core::array::from_fn(|m| {
            let whitener = &normal[m].whitener;
            (moved + away * whitener.rest() + s.aftermath[m]) * whitener.inv_sigma()
        });
        for left in &mut s.aftermath {
            *left -= self.aftermath * *left;
        }
        // T2 answers to the room as slowly as T0 does, T1 faster: only what T1 is part of sees the room jump.
        let all = core::array::from_fn(|m| {
            model[m] + if m == 1 { 0.0 } else { ambient * normal[m].whitener.inv_sigma() }
        });
        Slack { model, all }
    }

    fn ambient_jump(&self, s: &mut WeaknessState, t0: Option<f32>) -> f32 {
        let Some(t0) = t0 else { return 0.0 };
        let mean = s.ambient.get_or_insert(t0);
        let jump = (t0 - *mean).abs();
        *mean += self.ambient * (t0 - *mean);
        larger(0.0, jump - AMBIENT_NOISE)
    }
}

impl WeaknessState {
    /// Right after training at the rise `trained` of T1.
    pub(super) fn new(trained: f32) -> Self {
        Self { trained, mean_rise: trained, swing: 0.0, ambient: None, aftermath: [0.0; 3] }
    }

    /// A fault has ended and left residuals at these levels.
    pub(super) fn fault_ended(&mut self, levels: [f32; 3]) {
        self.aftermath = levels.map(|level| 2.0 * level.abs());
    }
}
