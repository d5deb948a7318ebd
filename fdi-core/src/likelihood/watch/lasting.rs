//! What has changed since training: the last minute held against the trained state, an alarm as long as it is other than that.

use super::naming::{magnitude, named};
use super::{LEAST_FLOW, UNUSUAL, Watch, WatchState};
use crate::bounds::larger;
use crate::likelihood::class::FaultClass;
use crate::likelihood::evidence::Freed;
use crate::likelihood::hypothesis::{self, COUNT, HYPOTHESES, IMPOSSIBLE};
use crate::likelihood::posterior::Posterior;
use crate::likelihood::verdict::Finding;
use crate::root::sqrt;

/// Log Bayes factor that raises an alarm.
const RAISE_SLOW: f32 = 0.8;
/// An alarm since training goes on above this share of both the factor and the size that raised it.
const GOES_ON: [f32; 2] = [0.4, 0.7];
/// What has changed since training is named from this probability on.
const NAME_LASTING: f32 = 0.9;
/// Smallest faults that are reported since training, beside [`LEAST_FLOW`]: share of power, degC, share of gain.
const LEAST_POWER: f32 = 0.085;
const LEAST_OFFSET: f32 = 0.8;
const LEAST_GAIN: f32 = 0.08;

/// What has changed since training: when that was seen, and what it is, once that can be told.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lasting {
    pub(super) onset: u32,
    pub(super) finding: Option<Finding>,
}

impl Watch {
    /// The minute, against the trained state.
    pub(super) fn judge_lasting(&self, s: &mut WatchState, tick: u32) {
        let first = 20.0 * s.pace.stretch / self.sample_time;
        if !s.steady.is_ready(first) {
            return;
        }
        let mut freed = [Freed::default(); COUNT];
        let nuisances = hypothesis::since_training(&s.wander, s.bent(), s.expected[0]);
        s.steady.judge(&nuisances, &mut freed, self.inputs);
        let posterior = Posterior::new(&freed);
        let h = posterior.likeliest % COUNT;
        let row = &HYPOTHESES[h];
        let sized = s.steady.size(&nuisances, h, self.inputs);
        let sized = if row.judged(sized).gain == IMPOSSIBLE { freed[h] } else { sized };
        let least = match row.class {
            FaultClass::HeaterPower => larger(LEAST_POWER, UNUSUAL * sqrt(s.wander[0] + s.bent())),
            FaultClass::AirFlow => larger(LEAST_FLOW, UNUSUAL * sqrt(s.wander[1])),
            FaultClass::T1Clogged => LEAST_GAIN,
            _ => LEAST_OFFSET,
        };
        let (factor, share) = if s.lasting.is_some() { (GOES_ON[0], GOES_ON[1]) } else { (1.0, 1.0) };
        let there = posterior.best_gain > factor * RAISE_SLOW && freed[h].value.abs() > share * least;
        let onset = s.lasting.map_or(tick, |was| was.onset);
        let least = if self.inputs.fan { NAME_LASTING } else { 0.0 };
        let (class, confidence) = named(&posterior, least);
        s.lasting = there.then(|| Lasting {
            onset,
            finding: (confidence > NAME_LASTING).then(|| Finding {
                class,
                confidence,
                magnitude: magnitude(h, class, &sized),
                onset,
            }),
        });
    }
}
