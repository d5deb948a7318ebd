//! T1 and T2 hang in the same air, T2 downstream: while the heater is on, T2 cannot be much hotter than T1. Where it is, T1
//! reads too little of the air (out of the tube, wholly or half, or mistaken for T0), and the loop overheats the rig.

use super::config::SupervisorConfig;
use super::operation::Operation;
use super::{Situation, TripReason};
use crate::bounds::larger;
use crate::filter::LowPass;
use crate::sense::Validity;
use crate::units::Seconds;

/// The rule, validated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Disagreement {
    limit: f32,
    ticks: u32,
    /// Of T1.
    low_pass: LowPass,
}

/// Its memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DisagreementState {
    /// T1 low-passed: T2 is late, and after a large step of the set-point downwards it is rightly the hotter one, but
    /// never hotter than T1 was, degC.
    t1_before: Option<f32>,
    /// Ticks with power on which T2 was too hot; saturates.
    lasting: u32,
}

impl Disagreement {
    pub(super) fn new(c: &SupervisorConfig, ts: Seconds) -> Self {
        Self {
            limit: c.max_disagreement.0,
            ticks: c.disagreement_time.ticks(ts),
            low_pass: LowPass::euler(c.disagreement_time.0, ts.0),
        }
    }

    /// `power` is what was asked for up to now, low-passed, %. Without any nothing grows hotter, and the time stands still.
    pub(super) fn step(
        &self,
        state: &mut DisagreementState,
        now: &Situation,
        power: f32,
        operation: &Operation,
    ) -> Option<TripReason> {
        let (t1, t2) = (now.sample.t1, now.sample.t2);
        let readable = |validity| matches!(validity, Validity::Good | Validity::Spike | Validity::Rate);
        if readable(t1.validity) && readable(t2.validity) {
            let (t1, t2) = (t1.celsius.0, t2.celsius.0);
            let before = state.t1_before.get_or_insert(t1);
            self.low_pass.follow(before, t1);
            let before = *before;
            // What was learnt allows no more than the limit again: a T2 that was hotter than that has tripped before it was learnt.
            let difference =
                operation.learnt().map_or(0.0, |learnt| larger(learnt.t1_over_t2(), -self.limit));
            // What is no number is above the limit.
            if t2 - larger(t1, before) + difference <= self.limit {
                state.lasting = 0;
            } else if power > 0.0 {
                state.lasting = state.lasting.saturating_add(1);
            }
        }
        (state.lasting > self.ticks).then_some(TripReason::SensorsDisagree)
    }
}
