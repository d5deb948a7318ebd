//! Power without an answer: the heater is driven hard and T1 does not rise. Then T1 is out of the tube or dead, the heater
//! is not connected, or far more air flows than should; whichever it is, the power does not do what it is there for.
//!
//! Two rules, because before learning nobody knows what power is much. Their hazard is a false trip, after which people
//! switch such rules off: a set-point that the rig cannot reach, a cold start and a strong fan must pass. Hence the first
//! rule asks only whether T1 has risen at all since arming, and the second starts anew whenever T1 still rises.

use super::config::SupervisorConfig;
use super::{Situation, TripReason};
use crate::bounds::{larger, smaller};
use crate::units::{Percent, Seconds};

/// Above this share of the highest output the power counts as full.
const FULL: f32 = 0.9;
/// Power that is this much above what is needed may be noise and excitation, whatever its ratio, %.
const LEAST_EXCESS: f32 = 8.0;
/// T1 this much above the set-point is no lack of heat: the power is on its way down, degC.
const ABOVE: f32 = 1.0;
/// T1 rises if it has risen by this much within the time that excess power has, degC.
const RISING: f32 = 2.0;

/// Both rules, validated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Response {
    full_power: f32,
    min_response: f32,
    response_ticks: u32,
    max_ratio: f32,
    excess_ticks: u32,
}

/// Their memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ResponseState {
    /// Lowest T1 since arming, degC.
    lowest: Option<f32>,
    /// Ticks in a row at full power without an answer; saturates.
    unanswered: u32,
    /// Ticks in a row above the power that is needed, and T1 when they began; saturates.
    excess: u32,
    excess_from: f32,
}

impl Response {
    pub(super) fn new(c: &SupervisorConfig, output_max: Percent, ts: Seconds) -> Self {
        Self {
            full_power: FULL * output_max.0,
            min_response: c.min_response.0,
            response_ticks: c.response_time.ticks(ts),
            max_ratio: 1.0 + c.max_excess_power.0 / 100.0,
            excess_ticks: c.excess_power_time.ticks(ts),
        }
    }

    /// `power` is what was asked for up to now, low-passed, and `needed` what the set-point needs by what was learnt, %.
    pub(super) fn step(
        &self,
        state: &mut ResponseState,
        now: &Situation,
        power: f32,
        needed: Option<f32>,
    ) -> Option<TripReason> {
        // Without a reading the time goes on: a T1 that comes and goes answers no more than one that is out.
        let t1 = now.sample.t1.good();
        if let Some(t1) = t1 {
            state.lowest = Some(state.lowest.map_or(t1, |lowest| smaller(lowest, t1)));
        }
        if self.is_unanswered(state, t1, now.pid.0) {
            return Some(TripReason::NoResponse);
        }
        let needed = needed.filter(|_| !t1.is_some_and(|t1| t1 > now.setpoint.0 + ABOVE));
        self.is_excessive(state, t1, power, needed).then_some(TripReason::ExcessPower)
    }

    fn is_unanswered(&self, state: &mut ResponseState, t1: Option<f32>, pid: f32) -> bool {
        let answered = t1.zip(state.lowest).is_some_and(|(t1, lowest)| t1 - lowest >= self.min_response);
        state.unanswered =
            if pid < self.full_power || answered { 0 } else { state.unanswered.saturating_add(1) };
        state.unanswered > self.response_ticks
    }

    fn is_excessive(
        &self,
        state: &mut ResponseState,
        t1: Option<f32>,
        power: f32,
        needed: Option<f32>,
    ) -> bool {
        let limit = needed.map(|needed| larger(needed * self.max_ratio, needed + LEAST_EXCESS));
        if limit.is_none_or(|limit| power <= limit) {
            state.excess = 0;
            return false;
        }
        let rising = t1.is_some_and(|t1| t1 - state.excess_from > RISING);
        if state.excess == 0 || rising {
            state.excess_from = t1.unwrap_or(state.excess_from);
            state.excess = 0;
        }
        state.excess = state.excess.saturating_add(1);
        state.excess > self.excess_ticks
    }
}
