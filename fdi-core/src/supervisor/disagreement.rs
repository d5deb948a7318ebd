//! T1 and T2 hang in the same air, T2 downstream: while the heater is on, T2 cannot be much hotter than T1. Where it is, T1
//! reads too little of the air (out of the tube, wholly or half, or mistaken for T0), and the loop overheats the rig.

use super::config::SupervisorConfig;
use super::normal::Normal;
use super::{Situation, TripReason};
use crate::sense::Validity;
use crate::units::Seconds;

/// The rule, validated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disagreement {
    limit: f32,
    ticks: u32,
}

impl Disagreement {
    pub(super) fn new(c: &SupervisorConfig, ts: Seconds) -> Self {
        Self { limit: c.max_disagreement.0, ticks: c.disagreement_time.ticks(ts) }
    }

    /// `lasting` counts the ticks with power on which T2 was too hot beside T1. Those without power do not count, as nothing
    /// grows hotter then: after a large step of the set-point downwards T2 is late and rightly the hotter one.
    pub(super) fn step(
        &self,
        lasting: &mut u32,
        now: &Situation,
        power: f32,
        normal: &Normal,
    ) -> Option<TripReason> {
        // A T1 that is known to be faulty, and does without, is no reason; one that reads nothing has a rule of its own.
        let (t1, t2) = (now.sample.t1, now.sample.t2);
        let readable = |validity| matches!(validity, Validity::Good | Validity::Spike | Validity::Rate);
        if readable(t1.validity) && readable(t2.validity) {
            let difference = normal.learnt().map_or(0.0, |learnt| learnt.t1_over_t2());
            let excess = t2.celsius.0 - t1.celsius.0 + difference;
            if !(excess > self.limit) {
                *lasting = 0;
            } else if power > 0.0 {
                *lasting = lasting.saturating_add(1);
            }
        }
        (*lasting > self.ticks).then_some(TripReason::SensorsDisagree)
    }
}
