//! How fast everything goes on a rig: times that suit the reference rig, stretched by the residence time of this one.

use super::steady::SteadyConstants;
use crate::bounds::{bounded, larger};
use crate::filter::LowPass;
use crate::likelihood::inputs::Inputs;
use crate::likelihood::onset::OnsetConstants;
use crate::likelihood::process::Parameter;
use crate::likelihood::training::Trained;
use crate::likelihood::tuning::Tuned;

/// What follows from the model: how fast everything goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Times {
    /// Seconds of this rig for each of the reference rig.
    pub(super) time_scale: f32,
    pub(super) onset: OnsetConstants,
    pub(super) steady: SteadyConstants,
    pub(super) swing: LowPass,
    pub(super) inlet: LowPass,
    pub(super) walk: LowPass,
    /// Ticks within which a change of the process begins anywhere, where that is asked.
    pub(super) late: f32,
    pub(super) forgets: f32,
    /// Share that is kept of what "as trained" is asked of.
    pub(super) recent: f32,
    /// The surroundings move as slowly as the rig answers, so that a residual that lasts says hardly anything.
    pub(super) slow_surroundings: bool,
}

impl Times {
    /// Ticks of this rig in `seconds` of the reference rig.
    pub(super) fn ticks(&self, seconds: f32, sample_time: f32) -> u32 {
        (seconds * self.time_scale / sample_time) as u32
    }

    /// Of a rig as it was trained, with these inputs, sampled every `ts` s.
    pub(super) fn new(tuning: Tuned, trained: &Trained, inputs: Inputs, ts: f32) -> Self {
        let p = &trained.parameters;
        let t = &tuning.times;
        let time_scale = bounded(p.residence() * ts / t.reference, 1.0 / t.largest_scale, t.largest_scale);
        let share = |time: f32| 1.0 - libm::expf(-ts / (time * time_scale));
        let lags = [share(t.short_lag), share(t.reference)];
        Self {
            time_scale,
            onset: OnsetConstants {
                lead: (p.get(Parameter::Delay1) + tuning.model.shows_after) as usize,
                lags,
                fan: ts / (t.fan_lag * time_scale),
                minutes: ts / 60.0,
            },
            steady: SteadyConstants {
                keep: 1.0 - share(t.minute),
                reference: (t.minute * time_scale / ts) as u32,
                split: LowPass::over(1.0 / share(t.split)),
                mean: LowPass::over(1.0 / share(t.mean)),
            },
            swing: LowPass::over(1.0 / share(t.swing)),
            inlet: LowPass::over(1.0 / share(t.reference)),
            walk: LowPass::over(1.0 / share(t.walk)),
            late: larger(1.0, tuning.hypotheses.late * p.residence()),
            forgets: 1.0 - share(t.forgetting),
            recent: 1.0 - share(t.split),
            slow_surroundings: inputs != Inputs::ALL && trained.whitening.dc_gain()[0] < tuning.slow.dc_gain,
        }
    }
}
