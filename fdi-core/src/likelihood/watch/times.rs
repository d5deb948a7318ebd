//! How fast everything goes on a rig: times that suit the reference rig, stretched by the residence time of this one.

use crate::bounds::bounded;
use crate::filter::LowPass;
use crate::likelihood::onset::OnsetConstants;
use crate::likelihood::process::{Parameter, Parameters};
use crate::likelihood::steady::SteadyConstants;
use crate::likelihood::tuning::Tuned;

/// What follows from the model: how fast everything goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Times {
    /// Seconds here for each of the reference rig.
    pub(super) time_scale: f32,
    pub(super) onset: OnsetConstants,
    pub(super) steady: SteadyConstants,
    pub(super) swing: LowPass,
    pub(super) inlet: LowPass,
    pub(super) walk: LowPass,
    pub(super) forgets: f32,
    pub(super) window: f32,
}

impl Times {
    /// Of a rig with these parameters, sampled every `ts` s.
    pub(super) fn new(tuning: Tuned, p: &Parameters, ts: f32) -> Self {
        let t = &tuning.times;
        let time_scale = bounded(p.residence() * ts / t.reference, t.least_scale, t.largest_scale);
        let share = |time: f32| 1.0 - libm::expf(-ts / (time * time_scale));
        let lags = [t.short_lag, t.long_lag].map(share);
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
                reference: (t.model_errors * time_scale / ts) as u32,
                split: LowPass::over(1.0 / share(t.split)),
                mean: LowPass::over(1.0 / share(t.mean)),
            },
            swing: LowPass::over(1.0 / share(t.swing)),
            inlet: LowPass::over(1.0 / share(t.inlet)),
            walk: LowPass::over(1.0 / share(t.walk)),
            forgets: 1.0 - share(t.forgetting),
            window: 1.0 - share(t.window),
        }
    }
}
