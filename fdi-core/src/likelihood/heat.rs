//! Measured rises held against those that the models expect, every tick and whatever the bank makes of the residuals: a virtual T1, the
//! air flow, heat without power, and who sees only a part of the rise. Rises are those over the ambient that is believed (`ambient.rs`): a
//! wrong T0 neither causes nor prevents anything here.

use super::class::FaultClass;
use super::tuning::Tuned;
use super::verdict::{Finding, Magnitude};
use crate::bounds::{larger, smaller};
use crate::filter::LowPass;

/// Ts in answer times, and the memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Heat {
    sample_time: f32,
    rises: LowPass,
    tuning: Tuned,
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
    /// For how many answer times the rig has been hot without power, and how hot it was at its coldest since, degC.
    too_hot: f32,
    coldest: f32,
    stuck_on: bool,
    was_heating: bool,
    /// Low-passed rises of T1 and T2.
    rises: [Rise; 2],
    /// Low-passed squares of how far these are from their means.
    motion: [Rise; 2],
    /// T1 and T2 contradict each other: neither is regulated by.
    contradict: bool,
    tuning: Tuned,
}

impl Heat {
    pub(super) fn new(tuning: Tuned, sample_time: f32, answer_time: f32) -> Self {
        Self {
            sample_time: sample_time / answer_time,
            rises: LowPass::euler(answer_time, sample_time),
            tuning,
        }
    }

    /// One tick: the rises of T1 and T2 where known.
    pub(super) fn step(&self, s: &mut HeatState, now: [Option<Rise>; 2], heating: bool) {
        for ((mean, motion), now) in s.rises.iter_mut().zip(&mut s.motion).zip(now) {
            if let Some(now) = now {
                self.rises.follow(&mut mean.measured, now.measured);
                self.rises.follow(&mut mean.expected, now.expected);
                let [seen, expected] = [now.measured - mean.measured, now.expected - mean.expected];
                self.rises.follow(&mut motion.measured, seen * seen);
                self.rises.follow(&mut motion.expected, expected * expected);
            }
        }
        self.watch_heater(s, now, heating);
    }

    /// Is the rig hot although hardly any rise is expected?
    fn watch_heater(&self, s: &mut HeatState, now: [Option<Rise>; 2], heating: bool) {
        if heating && !s.was_heating {
            s.too_hot = 0.0; // the fan has just come on
        }
        s.was_heating = heating;
        let (t, of) = (&self.tuning.heat, &self.tuning.sensors);
        let unasked = |rise: &Rise| rise.expected < of.alike && rise.measured - rise.expected > of.gross;
        // All that read anything: a T1 that stands still while the rig cools is no heater.
        let known = || now.iter().flatten();
        if known().count() == 0 || !known().all(unasked) {
            (s.too_hot, s.coldest, s.stuck_on) = (0.0, f32::MAX, false);
            return;
        }
        let hottest = larger(s.rises[0].measured, s.rises[1].measured);
        if hottest < s.coldest - t.cooling {
            s.coldest = hottest;
            if !heating {
                (s.too_hot, s.stuck_on) = (0.0, false);
            }
        }
        let longest = self.tuning.ambient.rest;
        s.too_hot = smaller(longest, s.too_hot + self.sample_time);
        s.stuck_on |= s.too_hot >= if heating { t.too_hot_time } else { longest };
    }

    /// Whether T1 and T2 have moved since an onset, however late, for long enough to be told: what stands still is stuck, what follows slowly is not.
    pub(super) fn moves(&self, s: &HeatState, onset: u32, tick: u32) -> [bool; 2] {
        let still = self.tuning.sensors.share;
        let settled = tick.saturating_sub(onset) as f32 * self.rises.share() > self.tuning.heat.stuck_time;
        s.motion.map(|motion| settled && motion.measured > still * still * motion.expected)
    }

    /// `e2` is what T2 reads above what the power lets expect, degC; `gain` the share of T1's rise that reaches T2.
    pub(super) fn correct(&self, s: &mut HeatState, e2: f32, gain: f32) {
        self.rises.follow(&mut s.correction, e2 / gain);
    }
}

impl HeatState {
    /// Right after training at the rise `trained` of T1.
    pub(super) fn new(tuning: Tuned, trained: f32) -> Self {
        let rise = Rise { measured: trained, expected: trained };
        Self {
            correction: 0.0,
            too_hot: 0.0,
            coldest: f32::MAX,
            stuck_on: false,
            was_heating: true,
            rises: [rise; 2],
            motion: [Rise { measured: 0.0, expected: 0.0 }; 2],
            contradict: false,
            tuning,
        }
    }

    /// T1's rise by T2 and the models, where the models alone expect `expected`, degC; None where these disagree, or T1 and T2 do.
    pub(super) fn virtual_t1(&self, expected: f32) -> Option<f32> {
        let t = &self.tuning.sensors;
        let limit = t.alike + t.share * expected.abs();
        (!self.contradict && self.correction.abs() <= limit).then_some(expected + self.correction)
    }

    /// Air flow by the static gain, % of normal, the larger of what T1 and T2 say; None where it is too cold to tell.
    pub(super) fn air_flow(&self) -> Option<f32> {
        let least = self.tuning.sensors.alike;
        let flow = |rise: &Rise| {
            let warm = rise.expected > least && rise.measured > least;
            warm.then(|| 100.0 * rise.expected / rise.measured)
        };
        Some(flow(&self.rises[0])?.max(flow(&self.rises[1])?))
    }

    /// Who has seen too little of a rise that the other sees since an onset: it slips out of the tube.
    pub(super) fn detached(&self, onset: u32) -> Option<Finding> {
        let share = self.tuning.heat.unexplained;
        let [t1, t2] = &self.rises;
        let (least, attached) = (self.tuning.sensors.gross, self.tuning.sensors.share);
        if !(t1.expected > least && t2.expected > least) {
            return None;
        }
        let [t1, t2] = [t1.measured / t1.expected, t2.measured / t2.expected];
        let beside = |seen: f32, other: f32| seen < share && (other - 1.0).abs() < attached * (1.0 - seen);
        let (class, seen) = if beside(t1, t2) {
            (FaultClass::T1Detached, t1)
        } else if beside(t2, t1) {
            (FaultClass::T2Detached, t2)
        } else {
            return None;
        };
        let lacks = 100.0 * (1.0 - seen);
        let magnitude = Magnitude { value: -lacks, half_width: attached * lacks };
        Some(Finding { class, confidence: self.tuning.naming.certain, magnitude: Some(magnitude), onset })
    }

    /// Is the difference of T1 and T2, where `both` are known, far from what it should be?
    pub(super) fn compare(&mut self, both: bool) {
        let [t1, t2] = &self.rises;
        let off = ((t2.measured - t1.measured) - (t2.expected - t1.expected)).abs();
        self.contradict = both && off > self.tuning.sensors.gross;
    }

    /// Finite as long as all of it is that stays.
    pub(super) fn sum(&self) -> f32 {
        let [t1, t2] = self.rises;
        let rises = t1.measured + t1.expected + t2.measured + t2.expected;
        let motion: f32 = self.motion.iter().map(|motion| motion.measured + motion.expected).sum();
        rises + self.correction + self.too_hot + motion
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
        let (heat, mut s) = (Heat::new(Tuned::default(), TS, 2.0), HeatState::new(Tuned::default(), 20.0));
        for tick in 0..120 {
            let rise = Rise { measured: 20.0, expected: 0.0 };
            heat.step(&mut s, [Some(rise); 2], tick >= 110);
        }
        assert!(!s.heater_stuck_on());
    }

    /// How long it takes until the heater counts as stuck on, with rises of 20 degC that fall by a share a second.
    fn stuck_after(heating: bool, falling: f32) -> Option<f32> {
        let (heat, mut s) = (Heat::new(Tuned::default(), TS, 2.0), HeatState::new(Tuned::default(), 20.0));
        (1..3000).map(|k| k as f32 * TS).find(|time| {
            let rise = Rise { measured: 20.0 * (1.0 - falling * time).max(0.0), expected: 0.0 };
            heat.step(&mut s, [Some(rise); 2], heating);
            s.heater_stuck_on()
        })
    }

    /// Both rises by the definition of the flow: it goes with the inverse of the static gain. The larger of the two is reported.
    #[test]
    fn the_air_flow_is_what_the_static_gain_says() {
        let (heat, mut s) = (Heat::new(Tuned::default(), TS, 2.0), HeatState::new(Tuned::default(), 20.0));
        let at = |measured| Some(Rise { measured, expected: 20.0 });
        for _ in 0..400 {
            heat.step(&mut s, [at(25.0), at(16.0)], true);
        }
        assert!(s.air_flow().is_some_and(|flow| (flow - 125.0).abs() < 0.1), "{:?}", s.air_flow());
        for _ in 0..400 {
            heat.step(&mut s, [Some(Rise { measured: 1.0, expected: 1.0 }); 2], true);
        }
        assert_eq!(s.air_flow(), None, "too cold to tell");
    }

    /// T2 shows what the models do not know of T1; where they are too far apart, neither is believed.
    #[test]
    fn the_virtual_t1_is_corrected_by_t2_up_to_a_limit() {
        let (heat, mut s) = (Heat::new(Tuned::default(), TS, 2.0), HeatState::new(Tuned::default(), 20.0));
        assert_eq!(s.virtual_t1(20.0), Some(20.0));
        for _ in 0..400 {
            heat.correct(&mut s, 0.9, 0.9);
        }
        assert!(s.virtual_t1(20.0).is_some_and(|t1| (t1 - 21.0).abs() < 1e-3));
        for _ in 0..400 {
            heat.correct(&mut s, 7.2, 0.9);
        }
        assert_eq!(s.virtual_t1(20.0), None, "8 degC, and 2 and a quarter of 20 are 7");
    }

    /// Whoever sees only a part of a rise that the other sees is out of the tube; a loss that both see is none of a thermistor.
    #[test]
    fn who_lacks_the_rise_is_detached() {
        let found = |t1: f32, t2: f32| {
            let (heat, mut s) =
                (Heat::new(Tuned::default(), TS, 2.0), HeatState::new(Tuned::default(), 20.0));
            for _ in 0..400 {
                let at = |measured| Some(Rise { measured, expected: 20.0 });
                heat.step(&mut s, [at(t1), at(t2)], true);
            }
            s.detached(7)
                .map(|finding| (finding.class, finding.magnitude.unwrap().value.round(), finding.onset))
        };
        assert_eq!(found(8.0, 20.0), Some((FaultClass::T1Detached, -60.0, 7)));
        assert_eq!(found(20.0, 8.0), Some((FaultClass::T2Detached, -60.0, 7)));
        assert_eq!(found(12.0, 12.0), None);
        assert_eq!(found(19.0, 20.0), None);
    }

    /// Rises that swing by 2 degC: a thermistor behind a lag of 3 s moves by a third of it, a frozen one by its noise alone.
    #[test]
    fn a_late_thermistor_moves_and_a_frozen_one_does_not() {
        let (heat, mut s) = (Heat::new(Tuned::default(), TS, 2.0), HeatState::new(Tuned::default(), 20.0));
        let [mut late, frozen] = [20.0; 2];
        for late_one in [0, 1] {
            for tick in 0..400_u16 {
                let expected = 20.0 + 2.0 * (f32::from(tick) * TS).sin();
                late += (expected - late) * TS / 3.0;
                let noise = if tick % 2 == 0 { 0.1 } else { -0.1 };
                let mut now = [frozen; 2];
                now[late_one] = late;
                heat.step(
                    &mut s,
                    now.map(|measured| Some(Rise { measured: measured + noise, expected })),
                    true,
                );
            }
            assert_eq!(heat.moves(&s, 390, 400), [false; 2], "too early to tell");
            assert_eq!(heat.moves(&s, 0, 400), [late_one == 0, late_one == 1]);
        }
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
