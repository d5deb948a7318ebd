//! Heat that nobody asked for: without any power T1 and T2 rise, or stay hot. Then the power stage is stuck on. Looked for
//! in every mode, armed or not, learnt or not. Both must show it, so that a thermistor in a hand or in hot water does not.

use super::Situation;
use super::config::SupervisorConfig;
use super::operation::AMBIENT_RATE;
use crate::bounds::{larger, smaller};
use crate::sense::Validity;
use crate::units::Seconds;

/// Less than this on average, without the excitation, is no power, %.
const NO_POWER: f32 = 0.5;
/// A rise without power by more than this, degC. The excitation alone must not give as much.
const RISE: f32 = 8.0;
/// A thermistor is hot if it reads so much above the coldest that it has read since the start, or above what a room can
/// be, degC.
const HOT: f32 = 8.0;
const HOTTEST_ROOM: f32 = 45.0;
/// Of what it is above the coldest it must lose this share in every `cooling_time`.
const LOSS: f32 = 0.1;

/// The rule, validated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unasked {
    /// The heat that is under way when the power ends arrives within this.
    settle_ticks: u32,
    cooling_ticks: u32,
    /// What a room may grow warmer in a tick, degC.
    ambient_step: f32,
}

/// Its memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct UnaskedState {
    /// Ticks in a row without power; saturates.
    unpowered: u32,
    t1: Trace,
    t2: Trace,
    stuck_on: bool,
}

/// Of one thermistor, degC.
#[derive(Clone, Copy, Debug, Default)]
struct Trace {
    /// Coldest since the start, but for what the room has grown warmer since.
    coldest: Option<f32>,
    /// Coldest since the heat that was under way has arrived.
    lowest: f32,
    /// At the beginning of the present `cooling_time`.
    begin: f32,
    /// Both are known; the tick on which they were due may have had no reading.
    begun: bool,
    /// It rises, or has not fallen over a whole `cooling_time`, without power.
    heated: bool,
}

impl Unasked {
    pub(super) fn new(c: &SupervisorConfig, ts: Seconds) -> Self {
        Self {
            settle_ticks: c.response_time.ticks(ts),
            cooling_ticks: c.cooling_time.ticks(ts).max(1),
            ambient_step: AMBIENT_RATE * ts.0,
        }
    }

    /// Whether the heater heats unasked. `power` is what was asked for up to now, low-passed, %.
    pub(super) fn step(&self, state: &mut UnaskedState, now: &Situation, power: f32) -> bool {
        state.unpowered = if power < NO_POWER { state.unpowered.saturating_add(1) } else { 0 };
        let since = state.unpowered.checked_sub(self.settle_ticks);
        let begins = since == Some(0) || state.unpowered == 0;
        let window_ends = since.is_some_and(|since| since > 0 && since.is_multiple_of(self.cooling_ticks));
        let ambient = now.sample.t0.good();
        let [t1, t2] = [(&mut state.t1, now.sample.t1), (&mut state.t2, now.sample.t2)].map(|(trace, t)| {
            trace.follow_ambient(ambient, self.ambient_step);
            Some(trace.step(t.good()?, begins, since.is_some(), window_ends))
        });
        // A tick without a reading says nothing new. A broken T2 leaves it to T1.
        state.stuck_on = match (t1, t2) {
            (Some(t1), Some(t2)) => t1 && t2,
            (Some(t1), None) if is_broken(now.sample.t2.validity) => t1,
            _ => state.stuck_on && state.unpowered > 0,
        };
        state.stuck_on
    }
}

fn is_broken(validity: Validity) -> bool {
    matches!(validity, Validity::Open | Validity::Short | Validity::OutOfRange)
}

impl Trace {
    /// A room that grows warmer is no heater: the coldest rises with it, no faster than a room can and never above T0.
    fn follow_ambient(&mut self, t0: Option<f32>, step: f32) {
        if let (Some(coldest), Some(t0)) = (&mut self.coldest, t0) {
            *coldest = larger(*coldest, smaller(*coldest + step, t0));
        }
    }

    fn step(&mut self, t: f32, begins: bool, unpowered: bool, window_ends: bool) -> bool {
        let coldest = self.coldest.map_or(t, |coldest| smaller(t, coldest));
        self.coldest = Some(coldest);
        if begins || !self.begun {
            (self.lowest, self.begin, self.heated) = (t, t, false);
        }
        self.begun = unpowered;
        if !unpowered {
            return false;
        }
        self.lowest = smaller(t, self.lowest);
        let hot = |t: f32| t - coldest > HOT || t > HOTTEST_ROOM;
        if window_ends {
            // Above the coldest, or above a room where it has been hot from the start.
            let above = larger(self.begin - coldest, self.begin - HOTTEST_ROOM);
            self.heated = hot(t) && t > self.begin - LOSS * above;
            self.begin = t;
        }
        self.heated && hot(t) || t - self.lowest > RISE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bit of the memory has flipped: the next readings are judged as if nothing had been known before.
    #[test]
    fn a_trace_that_is_no_number_is_begun_anew() {
        // It rises without power; it was heated, and stays hot when the power has gone.
        let rises = |mut trace: Trace| {
            trace.follow_ambient(Some(22.0), 0.002);
            (0..20).any(|k| trace.step(if k < 10 { 22.0 } else { 32.0 }, false, true, false))
        };
        let stays_hot = |mut trace: Trace| {
            trace.follow_ambient(Some(22.0), 0.002);
            trace.step(22.0, true, false, false);
            trace.step(42.0, true, false, false);
            (0..60).any(|k| trace.step(42.0, false, true, k % 20 == 19))
        };
        let known = Trace { coldest: Some(22.0), lowest: 22.0, begin: 22.0, begun: true, heated: false };
        for (name, trace) in [
            ("known", known),
            ("coldest", Trace { coldest: Some(f32::NAN), ..known }),
            ("lowest", Trace { lowest: f32::NAN, ..known }),
            ("begin", Trace { begin: f32::NAN, ..known }),
        ] {
            assert!(rises(trace) && stays_hot(trace), "{name}");
        }
        // Nor does a rate that is none let the coldest follow T0.
        let mut trace = known;
        trace.follow_ambient(Some(60.0), f32::NAN);
        assert_eq!(trace.coldest, Some(22.0));
    }
}
