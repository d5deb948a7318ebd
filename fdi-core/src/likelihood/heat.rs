//! What control and supervision need to know of the heat, every tick and whatever the bank makes of the residuals: a stand-in
//! for T1, the air flow, whether the rig heats unasked, and who sees only a part of the rise. Rises are those over the room
//! that is believed (`room.rs`): a wrong T0 neither causes nor prevents anything here.

use super::class::{Channel, FaultClass};
use super::verdict::{Finding, Magnitude};
use crate::bounds::{larger, smaller};

/// Memory of the correction of the stand-in, s.
const STAND_IN_TIME: f32 = 2.0;
/// T2 and the models may disagree by so much about T1: degC, and share of the rise. Beyond it one of them is wrong, too, and
/// nothing is left to regulate by.
const MAX_CORRECTION: f32 = 3.0;
const MAX_CORRECTION_SHARE: f32 = 0.2;
/// The heater is stuck on when a thermistor is so much hotter than expected, and hardly any rise is expected, degC: for so
/// long while heating, s. With the heater off the fan may be off as well: there it must be so for longer, without cooling.
const TOO_HOT: f32 = 4.0;
const HARDLY_WARM: f32 = 1.5;
const TOO_HOT_TIME: f32 = 2.0;
const TOO_HOT_TIME_OFF: f32 = 20.0;
const COOLING: f32 = 0.3;
/// Memory of the rises that the air flow is judged by, s, and the smallest rise that says anything, degC.
const FLOW_TIME: f32 = 2.0;
const FLOW_MIN_RISE: f32 = 2.0;
/// A thermistor that sees less than this share of the rise is out of the tube where the other sees all of it, give or take
/// this share of what the one lacks, and the rise is one, degC; what nothing else explains is so from a smaller loss on.
const DETACHED_SHARE: f32 = 0.6;
const UNEXPLAINED_SHARE: f32 = 0.85;
const ATTACHED: f32 = 0.25;
const DETACHED_MIN_RISE: f32 = 4.0;
/// A stuck T1 shows less than this share of the motion from tick to tick that is expected.
const STUCK_SHARE: f32 = 0.2;
/// That is told only so long after the onset, in memories of the rises.
const STUCK_TIME: f32 = 2.5;

/// Ts and the shares of the memories that are renewed in a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Heat {
    sample_time: f32,
    stand_in: f32,
    flow: f32,
}

/// A rise, measured and expected by the models, degC.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rise {
    pub(super) measured: f32,
    pub(super) expected: f32,
}

/// The memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeatState {
    /// What T1 by the models lacks, as T2 shows it, degC.
    correction: f32,
    /// For how long the rig has been hot without power, s, and how hot it was at its coldest since, degC.
    too_hot: f32,
    coldest: f32,
    stuck_on: bool,
    was_heating: bool,
    /// Low-passed rises of T1 and T2.
    rises: [Rise; 2],
    /// T1's rise before; low-passed products of its expected motion from tick to tick with the measured and with itself.
    before: Rise,
    shared_motion: f32,
    motion: f32,
}

impl Heat {
    pub(super) fn new(sample_time: f32) -> Self {
        let share = |time: f32| (sample_time / time).min(1.0);
        Self { sample_time, stand_in: share(STAND_IN_TIME), flow: share(FLOW_TIME) }
    }

    /// Takes in the rises of T1 and T2 where known.
    pub(super) fn step(&self, s: &mut HeatState, now: [Option<Rise>; 2], heating: bool) {
        for (mean, now) in s.rises.iter_mut().zip(now) {
            if let Some(now) = now {
                mean.measured += self.flow * (now.measured - mean.measured);
                mean.expected += self.flow * (now.expected - mean.expected);
            }
        }
        if let [Some(t1), _] = now {
            let before = core::mem::replace(&mut s.before, t1);
            let moved = t1.expected - before.expected;
            s.shared_motion += self.flow * (moved * (t1.measured - before.measured) - s.shared_motion);
            s.motion += self.flow * (moved * moved - s.motion);
        }
        self.watch_heater(s, now, heating);
    }

    /// Is the rig hot although hardly any rise is expected?
    fn watch_heater(&self, s: &mut HeatState, now: [Option<Rise>; 2], heating: bool) {
        if heating && !s.was_heating {
            s.too_hot = 0.0; // the fan has just come on
        }
        s.was_heating = heating;
        let unasked = |rise: &Rise| rise.expected < HARDLY_WARM && rise.measured - rise.expected > TOO_HOT;
        // All that read anything: a T1 that stands still while the rig cools is no heater.
        let known = || now.iter().flatten();
        if known().count() == 0 || !known().all(unasked) {
            (s.too_hot, s.coldest, s.stuck_on) = (0.0, f32::MAX, false);
            return;
        }
        let hottest = larger(s.rises[0].measured, s.rises[1].measured);
        if hottest < s.coldest - COOLING {
            s.coldest = hottest;
            if !heating {
                (s.too_hot, s.stuck_on) = (0.0, false);
            }
        }
        s.too_hot = smaller(TOO_HOT_TIME_OFF, s.too_hot + self.sample_time);
        s.stuck_on |= s.too_hot >= if heating { TOO_HOT_TIME } else { TOO_HOT_TIME_OFF };
    }

    /// What the bank says, held against the levels: what slips out slowly fits none of its signatures, and looks stuck
    /// while the controller holds it.
    pub(super) fn review(&self, s: &HeatState, told: Finding, tick: u32) -> Option<Finding> {
        let settled = tick.saturating_sub(told.onset) as f32 * self.flow > STUCK_TIME;
        let share = match told.class {
            FaultClass::Drift => DETACHED_SHARE,
            FaultClass::Unknown => UNEXPLAINED_SHARE,
            FaultClass::Stuck(Channel::T1) if settled && s.t1_moves() => UNEXPLAINED_SHARE,
            _ => return Some(told),
        };
        let still = told.class != FaultClass::Stuck(Channel::T1);
        s.detached(share, told.onset).or(still.then_some(told))
    }

    /// Takes in what T2 reads above what the power lets expect, degC; `along` is the share of T1's rise that reaches T2.
    pub(super) fn correct(&self, s: &mut HeatState, e2: f32, along: f32) {
        s.correction += self.stand_in * (e2 / along - s.correction);
    }
}

impl HeatState {
    /// Right after training at the rise `trained` of T1.
    pub(super) fn new(trained: f32) -> Self {
        let rise = Rise { measured: trained, expected: trained };
        Self {
            correction: 0.0,
            too_hot: 0.0,
            coldest: f32::MAX,
            stuck_on: false,
            was_heating: true,
            rises: [rise; 2],
            before: rise,
            shared_motion: 0.0,
            motion: 0.0,
        }
    }

    /// T1's rise by T2 and the models, where the models alone expect `expected`, degC; None where the two disagree.
    pub(super) fn stand_in(&self, expected: f32) -> Option<f32> {
        let limit = MAX_CORRECTION + MAX_CORRECTION_SHARE * expected.abs();
        (self.correction.abs() <= limit).then_some(expected + self.correction)
    }

    /// Air flow by the static gain, % of normal, the larger of what T1 and T2 say; None where it is too cold to tell.
    pub(super) fn air_flow(&self) -> Option<f32> {
        let flow = |rise: &Rise| {
            let warm = rise.expected > FLOW_MIN_RISE && rise.measured > FLOW_MIN_RISE;
            warm.then(|| 100.0 * rise.expected / rise.measured)
        };
        Some(flow(&self.rises[0])?.max(flow(&self.rises[1])?))
    }

    fn t1_moves(&self) -> bool {
        self.shared_motion > STUCK_SHARE * self.motion
    }

    /// Who sees less than `share` of a rise that the other sees.
    fn detached(&self, share: f32, onset: u32) -> Option<Finding> {
        let [t1, t2] = &self.rises;
        if !(t1.expected > DETACHED_MIN_RISE && t2.expected > DETACHED_MIN_RISE) {
            return None;
        }
        let [t1, t2] = [t1.measured / t1.expected, t2.measured / t2.expected];
        let beside = |seen: f32, other: f32| seen < share && (other - 1.0).abs() < ATTACHED * (1.0 - seen);
        let (class, seen) = if beside(t1, t2) {
            (FaultClass::T1Detached, t1)
        } else if beside(t2, t1) {
            (FaultClass::T2Detached, t2)
        } else {
            return None;
        };
        let lacks = 100.0 * (1.0 - seen);
        let magnitude = Magnitude { value: -lacks, half_width: ATTACHED * lacks };
        Some(Finding { class, confidence: 1.0, magnitude: Some(magnitude), onset })
    }

    /// By how much T1 and T2 differ from what they should differ by, degC.
    pub(super) fn apart(&self) -> f32 {
        let [t1, t2] = &self.rises;
        ((t2.measured - t1.measured) - (t2.expected - t1.expected)).abs()
    }

    /// Whether the rig has been hot without power for too long.
    pub(super) fn heater_stuck_on(&self) -> bool {
        self.stuck_on
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TS: f32 = 0.11;

    /// The tube is still hot when the instrument is armed: it gets the time to cool.
    #[test]
    fn arming_a_hot_tube_is_no_heater_stuck_on() {
        let (heat, mut s) = (Heat::new(TS), HeatState::new(20.0));
        for tick in 0..120 {
            let rise = Rise { measured: 20.0, expected: 0.0 };
            heat.step(&mut s, [Some(rise); 2], tick >= 110);
        }
        assert!(!s.heater_stuck_on());
    }

    /// How long it takes until the heater counts as stuck on, with rises of 20 degC that fall by a share a second.
    fn stuck_after(heating: bool, falling: f32) -> Option<f32> {
        let (heat, mut s) = (Heat::new(TS), HeatState::new(20.0));
        (1..3000).map(|k| k as f32 * TS).find(|time| {
            let rise = Rise { measured: 20.0 * (1.0 - falling * time).max(0.0), expected: 0.0 };
            heat.step(&mut s, [Some(rise); 2], heating);
            s.heater_stuck_on()
        })
    }

    #[test]
    fn heat_that_stays_without_power_is_a_heater_stuck_on() {
        assert!(stuck_after(true, 0.0).is_some_and(|time| time < 2.2));
        assert!(stuck_after(false, 0.0).is_some_and(|time| (19.0..22.0).contains(&time)));
    }

    /// The fan goes off with the heater: the tube stays hot for minutes.
    #[test]
    fn a_tube_that_cools_without_its_fan_is_none() {
        assert_eq!(stuck_after(false, 0.003), None);
    }
}
