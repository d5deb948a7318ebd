//! The ambient temperature that is believed, when T0 may be wrong: it moves no faster than a room does, and is set right
//! whenever the rig is at rest, where three thermistors should agree.

use super::class::FaultClass;
use super::tuning::{AmbientTuning, Tuned};
use super::verdict::{Finding, Magnitude};
use crate::bounds::{bounded, smaller};
use crate::filter::LowPass;
use crate::vector::sum;

/// The memories of the trend, the step of a tick in degC, and Ts in answer times.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ambient {
    trend: [LowPass; 2],
    fastest: f32,
    sample_time: f32,
    tuning: Tuned,
}

/// The memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AmbientState {
    believed: Option<f32>,
    /// Means of T1 and T2 over both memories.
    means: Option<[[f32; 2]; 2]>,
    /// For how many answer times the rig has been at rest.
    rest: f32,
    /// For how many answer times T0 has been wrong, since which tick, and by how much, degC, where that is known.
    wrong: f32,
    since: u32,
    off: Option<f32>,
}

impl Ambient {
    pub(super) fn new(tuning: Tuned, sample_time: f32, answer_time: f32) -> Self {
        let t = &tuning.ambient;
        let answer_time = smaller(t.longest, answer_time);
        Self {
            trend: [t.short_memory, t.rest].map(|times| LowPass::euler(times * answer_time, sample_time)),
            fastest: t.fastest / 60.0 * sample_time,
            sample_time: sample_time / answer_time,
            tuning,
        }
    }

    /// One tick: T0, T1, T2 where good, and the power applied from now on, %.
    pub(super) fn step(&self, s: &mut AmbientState, tick: u32, readings: [Option<f32>; 3], power: f32) {
        let [t0, t1, t2] = readings;
        let t = &self.tuning.ambient;
        let outlet = t1.zip(t2).and_then(|(t1, t2)| self.at_rest(s, [t1, t2], power));
        s.rest = if outlet.is_some() { smaller(t.rest, s.rest + self.sample_time) } else { 0.0 };
        match (outlet, t0, s.believed) {
            (Some(outlet), ..) if s.rest >= t.rest => {
                let close = t0.filter(|t0| (t0 - outlet).abs() < self.tuning.sensors.alike);
                s.believed = Some(close.unwrap_or(outlet));
            }
            (_, Some(t0), Some(ambient)) if (t0 - ambient).abs() < t.followed => {
                s.believed = Some(ambient + bounded(t0 - ambient, -self.fastest, self.fastest));
            }
            // A workshop in winter is no wrong T0, where all three say so before anything has heated.
            (_, t0, believed) => {
                let alike = |t0: f32| {
                    [t1, t2].iter().all(|t| t.is_some_and(|t| (t - t0).abs() < self.tuning.sensors.alike))
                };
                s.believed = believed.or(t0.filter(|t0| is_possible(t, t0) || alike(*t0)));
            }
        }
        if let Some(t0) = t0 {
            self.doubt(s, tick, t0);
        }
    }

    /// For how long has T0 been wrong?
    fn doubt(&self, s: &mut AmbientState, tick: u32, t0: f32) {
        s.off = s.believed.map(|ambient| t0 - ambient);
        let t = &self.tuning.ambient;
        let limit = if s.is_wrong(t) { t.followed } else { self.tuning.sensors.gross };
        let wrong = s.off.map_or(!is_possible(t, &t0), |off| off.abs() > limit);
        if s.wrong == 0.0 {
            s.since = tick;
        }
        s.wrong = if wrong { smaller(t.short_memory, s.wrong + self.sample_time) } else { 0.0 };
    }

    /// The mean of T1 and T2, where they are at rest.
    fn at_rest(&self, s: &mut AmbientState, outlet: [f32; 2], power: f32) -> Option<f32> {
        let means = s.means.get_or_insert(outlet.map(|t| [t; 2]));
        let mut still = power <= 0.0;
        for (means, t) in means.iter_mut().zip(outlet) {
            for (mean, memory) in means.iter_mut().zip(&self.trend) {
                memory.follow(mean, t);
            }
            still &= (means[0] - means[1]).abs() < self.tuning.ambient.trend;
        }
        let [near, far] = [means[0][0], means[1][0]];
        (still && (near - far).abs() < self.tuning.sensors.alike).then_some(0.5 * (near + far))
    }

    /// Whether T0 may be what the room is.
    pub(super) fn is_followed(&self, s: &AmbientState, t0: Option<f32>) -> bool {
        let limit = self.tuning.ambient.followed;
        t0.zip(s.believed).is_some_and(|(t0, ambient)| (t0 - ambient).abs() < limit)
    }

    /// A T0 that reads wrong.
    pub(super) fn finding(&self, s: &AmbientState) -> Option<Finding> {
        let t = &self.tuning.ambient;
        let magnitude = s.off.map(|value| Magnitude { value, half_width: self.tuning.sensors.alike });
        let finding = Finding { class: FaultClass::T0Fault, confidence: 1.0, magnitude, onset: s.since };
        s.is_wrong(t).then_some(finding)
    }
}

impl AmbientState {
    /// Finite as long as all of it is that stays.
    pub(super) fn sum(&self) -> f32 {
        let means = sum(self.means.as_slice().as_flattened().as_flattened());
        means + self.believed.unwrap_or(0.0) + self.rest + self.wrong
    }

    /// Nothing measures it: what stands for it is believed.
    pub(super) fn assume(&mut self, t0: Option<f32>) {
        self.believed = t0.or(self.believed);
    }

    fn is_wrong(&self, t: &AmbientTuning) -> bool {
        self.wrong >= t.short_memory
    }

    /// The ambient temperature that is believed, degC.
    pub(super) fn believed(&self) -> Option<f32> {
        self.believed
    }

    /// Rises of T1 and T2, where good, over the ambient that is believed, degC.
    pub(super) fn rises(&self, outlet: [Option<f32>; 2]) -> [Option<f32>; 2] {
        outlet.map(|t| Some(t? - self.believed?))
    }
}

fn is_possible(t: &AmbientTuning, t0: &f32) -> bool {
    *t0 > t.coldest && *t0 < t.warmest
}

#[cfg(test)]
mod tests {
    use super::*;

    const TS: f32 = 0.11;

    /// What is believed after `time` s, and whether T0 is reported as wrong, if readings and power are so.
    fn after(time: f32, at: impl Fn(f32) -> ([f32; 3], f32)) -> (f32, bool) {
        let (ambient, mut s) = (Ambient::new(Tuned::default(), TS, 2.0), AmbientState::default());
        for tick in 0..(time / TS) as u32 {
            let (readings, power) = at(tick as f32 * TS);
            ambient.step(&mut s, tick, readings.map(Some), power);
        }
        (s.believed().expect("T0 was there"), ambient.finding(&s).is_some())
    }

    #[test]
    fn a_t0_that_is_wrong_at_rest_is_reported_and_the_others_are_believed() {
        let (ambient, wrong) = after(40.0, |_| ([12.5, 22.5, 22.6], 0.0));
        assert!(wrong && (ambient - 22.55).abs() < 0.1, "{ambient}");
        let (ambient, wrong) = after(40.0, |_| ([22.0, 22.5, 22.6], 0.0));
        assert!(!wrong && ambient == 22.0, "{ambient}");
    }

    /// While it heats a jump of T0 is none of the room, and a slow change is followed.
    #[test]
    fn only_what_a_room_can_do_is_followed() {
        let jump = |time| ([if time < 10.0 { 22.5 } else { 2.5 }, 35.0, 34.0], 40.0);
        assert_eq!(after(600.0, jump), (22.5, true));
        let drift = |time| ([22.5 + 0.5 / 60.0 * time, 35.0, 34.0], 40.0);
        let (ambient, wrong) = after(600.0, drift);
        assert!((ambient - 27.5).abs() < 0.1 && !wrong, "{ambient}");
    }

    /// A hot tube without its fan loses 10 degC in five minutes, then less.
    #[test]
    fn a_hot_tube_that_cools_is_no_room() {
        let cooling = |time: f32| {
            ([22.5, 22.5 + 20.0 * libm::expf(-time / 400.0), 22.5 + 19.0 * libm::expf(-time / 400.0)], 0.0)
        };
        for time in [30.0, 120.0, 500.0, 800.0] {
            let (ambient, wrong) = after(time, cooling);
            assert!((ambient - 22.5).abs() < 2.0 && !wrong, "{ambient} degC after {time} s");
        }
    }

    #[test]
    fn no_trainer_stands_in_such_a_room() {
        let (ambient, mut s) = (Ambient::new(Tuned::default(), TS, 2.0), AmbientState::default());
        for tick in 0..60 {
            ambient.step(&mut s, tick, [Some(-3.0), Some(35.0), Some(34.0)], 40.0);
        }
        assert!(s.believed().is_none() && ambient.finding(&s).is_some_and(|f| f.magnitude.is_none()));
    }
}
