//! How fast everything goes on a rig: times that suit the reference rig, stretched by the residence time of this one.

use crate::bounds::bounded;
use crate::filter::LowPass;
use crate::likelihood::onset::OnsetConstants;
use crate::likelihood::process::{Parameter, Parameters};
use crate::likelihood::steady::SteadyConstants;

/// Residence time of the reference rig, s: what all times here were tuned on.
const REFERENCE: f32 = 1.1;
/// Memories of a swing of the temperature, of what an alarm is, and of the window in which its end is looked for, s.
const SWING_TIME: f32 = 2.0;
/// Memory of T0's mean, s: what the inlet moves has passed T1 and T2 by then.
const INLET_TIME: f32 = 1.0;
/// Memory of how far power, flow and offsets wander, s.
const WANDER_TIME: f32 = 7200.0;
const FORGETS_WITH: f32 = 10.0;
const WINDOW: f32 = 0.7;
/// The fast band learns for so long where the model is wrong, s.
const REFERENCE_TIME: f32 = 90.0;

/// What follows from the model: how fast everything goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// Seconds here for each of the reference rig.
    pub(super) stretch: f32,
    pub(super) onset: OnsetConstants,
    pub(super) steady: SteadyConstants,
    pub(super) swing: LowPass,
    pub(super) inlet: LowPass,
    pub(super) wander: LowPass,
    pub(super) forgets: f32,
    pub(super) window: f32,
}

impl Pace {
    /// Of a rig with these parameters, sampled every `ts` s.
    pub(super) fn new(p: &Parameters, ts: f32) -> Self {
        let stretch = bounded(p.residence() * ts / REFERENCE, 0.5, 100.0);
        let share = |time: f32| 1.0 - libm::expf(-ts / (time * stretch));
        let lags = [0.35, 1.0].map(share);
        Self {
            stretch,
            onset: OnsetConstants {
                lead: (p.get(Parameter::Delay1) + 1.5) as usize,
                lags,
                fan: ts / (0.2 * stretch),
                minutes: ts / 60.0,
            },
            steady: SteadyConstants {
                keep: 1.0 - share(60.0),
                reference: (REFERENCE_TIME * stretch / ts) as u32,
                split: LowPass::over(1.0 / share(5.0)),
                mean: LowPass::over(1.0 / share(25.0)),
            },
            swing: LowPass::over(1.0 / share(SWING_TIME)),
            inlet: LowPass::over(1.0 / share(INLET_TIME)),
            wander: LowPass::over(1.0 / share(WANDER_TIME)),
            forgets: 1.0 - share(FORGETS_WITH),
            window: 1.0 - share(WINDOW),
        }
    }
}
