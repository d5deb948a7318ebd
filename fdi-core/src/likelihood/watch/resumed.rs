//! Another recording of the same rig begins.

use super::{Gathered, Watch, WatchState};
use crate::likelihood::onset::{History, REMEMBERED};
use crate::likelihood::process::{Motion, Parameter};
use crate::likelihood::tracker::Tracker;
use crate::likelihood::whitening::Past;

impl Watch {
    /// Another recording begins, long after its power was last changed. Where nothing says how warm the room is by now, the first ticks do.
    pub(in crate::likelihood) fn resume(&self, s: &mut WatchState, [u, fan, beside]: [f32; 3]) -> Gathered {
        let heat = s.process.heat(u);
        s.motion = Motion::steady(heat);
        s.power = u;
        s.beside = s.beside.resumed(beside);
        s.steady.resume(&s.motion);
        s.history = History::default();
        for _ in 0..REMEMBERED {
            s.history.push(heat, &s.motion);
        }
        s.before = s.process.rises(s.motion.m, s.motion.w).y;
        (s.fan, s.tracker, s.alarm, s.lasting) = (fan, Tracker::new(self.tuning), None, None);
        (s.past, s.past_clipped) = (Past::default(), Past::default());
        s.swing = [s.before[0] + s.parameters.get(Parameter::Offset1), 0.0];
        let t = &self.tuning.slow;
        let settles = t.settles * s.parameters.residence();
        let settles = if settles <= t.anchored { settles as u32 } else { 0 };
        s.anchoring = settles + if self.inputs.t0 { 0 } else { t.anchored as u32 };
        s.ticks = 0;
        s.reset_charts();
        Gathered::default()
    }
}

impl WatchState {
    /// Whether this tick is one of the first, which say what the intercept is, after those in which the rig has forgotten how it began.
    pub(super) fn anchors(&mut self, e: [f32; 2]) -> bool {
        if self.anchoring == 0 {
            return false;
        }
        self.anchoring = self.anchoring.saturating_sub(1);
        let taken = (self.tuning.slow.anchored as u32).saturating_sub(self.anchoring);
        if taken > 0 {
            let share = 1.0 / taken as f32;
            for (mean, e) in self.mean.iter_mut().zip(e) {
                *mean += share * e;
            }
        }
        true
    }
}
