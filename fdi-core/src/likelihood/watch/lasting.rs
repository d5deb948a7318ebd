//! What has changed since training: the last minute held against the trained state, an alarm as long as it is other than that.

use super::naming::{magnitude, named};
use super::{Watch, WatchState};
use crate::bounds::larger;
use crate::likelihood::class::FaultClass;
use crate::likelihood::evidence::Estimate;
use crate::likelihood::hypothesis::{self, COUNT, IMPOSSIBLE};
use crate::likelihood::posterior::Posterior;
use crate::likelihood::verdict::Finding;
use crate::root::sqrt;

/// What has changed since training: when that was seen, and what it is, once that can be told.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lasting {
    pub(super) onset: u32,
    pub(super) finding: Option<Finding>,
}

impl Watch {
    /// The smallest change since training that is a fault.
    pub(super) fn least(&self, s: &WatchState, class: FaultClass) -> f32 {
        let (t, alarm) = (&self.tuning.since_training, &self.tuning.alarm);
        match class {
            FaultClass::HeaterPower => {
                larger(self.least_power, alarm.unusual * sqrt(s.walk_variance[0] + s.curvature_variance()))
            }
            FaultClass::AirFlow => larger(alarm.least_flow, alarm.unusual * sqrt(s.walk_variance[1])),
            FaultClass::T1Clogged => t.least_gain,
            _ => t.least_offset,
        }
    }

    /// The minute, against the trained state.
    pub(super) fn judge_lasting(&self, s: &mut WatchState, tick: u32) {
        let t = &self.tuning.since_training;
        let first = t.first * s.times.time_scale / self.sample_time;
        if !s.steady.is_ready(first) {
            return;
        }
        let mut estimate = [Estimate::default(); COUNT];
        let nuisances = hypothesis::since_training(
            &self.tuning.nuisances,
            &s.walk_variance,
            s.curvature_variance(),
            s.expected[0],
        );
        s.steady.judge(&nuisances, &mut estimate, self.inputs);
        let posterior = Posterior::new(&estimate);
        let h = posterior.likeliest % COUNT;
        let row = &self.tuning.hypotheses()[h];
        let sized = s.steady.size(&nuisances, h, self.inputs);
        let sized = if row.judged(sized).gain == IMPOSSIBLE { estimate[h] } else { sized };
        let least = self.least(s, row.class);
        let (factor, share) =
            if s.lasting.is_some() { (t.lasting_raise, t.lasting_size) } else { (1.0, 1.0) };
        let there = posterior.best_gain > factor * t.raise && estimate[h].value.abs() > share * least;
        let onset = s.lasting.map_or(tick, |was| was.onset);
        let least = if self.inputs.fan { t.naming } else { 0.0 };
        let (class, confidence) = named(&self.tuning.naming, &posterior, least);
        s.lasting = there.then(|| Lasting {
            onset,
            finding: (confidence > t.naming).then(|| Finding {
                class,
                confidence,
                magnitude: magnitude(&self.tuning.naming, h, class, &sized),
                onset,
            }),
        });
    }
}
