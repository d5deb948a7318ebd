//! Thermistors that contradict each other: which answers to the power, which first, and what each reads. Nothing need have
//! been learnt; it holds from arming on, and what was found stands until the next arming.
//!
//! | T0 | T1 | T2 | then |
//! |---|---|---|---|
//! | | silent | answers | T1 is out of the tube where it reads as the room does, else stuck |
//! | | answers | silent | T2 is out of the tube, where it reads as the room does |
//! | answers | silent | | T0 and T1 are swapped |
//! | answers | answers | silent | T0 and T2 are swapped |
//! | | after T2 | before T1 | T1 and T2 are swapped |
//! | | | stays much warmer than T1 | T1 is half out of the tube |
//! | silent, warmest | | | T0 reads wrong |

use super::class::{Channel, FaultClass, Pair};
use super::impulse::{ImpulseResponse, ImpulseResponseState, Moments};
use super::tuning::Tuning;
use super::verdict::Finding;
use crate::bounds::{larger, smaller};
use crate::filter::LowPass;

/// What a judgement says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Judgement {
    /// Too little has been seen.
    #[default]
    Open,
    /// T1 and T2 answer, T1 first.
    Agree,
    /// They contradict each other.
    Contradict(FaultClass),
}

/// The memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contradiction {
    response: ImpulseResponseState,
    was_heating: bool,
    /// Ticks since heating ended; saturates.
    cold: u32,
    judgement: Judgement,
    found: Option<Finding>,
    /// For how many steps T2 has been much warmer than T1, how many ticks ago it was, and T2's running mean, degC.
    warmer: f32,
    since_warmer: u32,
    t2_mean: Option<f32>,
}

impl Contradiction {
    /// What contradicts itself by now: the readings of T0, T1, T2 where there are any, and the power applied from now on, %.
    pub(super) fn step(
        &mut self,
        response: &ImpulseResponse,
        tick: u32,
        heating: bool,
        readings: [Option<f32>; 3],
        power: f32,
    ) -> Option<Finding> {
        if heating && !self.was_heating {
            *self = Self::default();
        }
        self.was_heating = heating;
        self.cold = if heating { 0 } else { self.cold.saturating_add(1) };
        response.step(&mut self.response, readings, power);
        let ticks = response.ticks();
        let t: &Tuning = &response.tuning;
        let (every, over) = (t.contradiction.every as u32, t.contradiction.over as u32);
        self.compare(t, readings, ticks as f32);
        if tick.is_multiple_of(every * ticks) && self.cold < over * ticks {
            let t2_warmer = self.warmer >= t.impulse.steps;
            let judgement = judge(t, &self.response.moments(response), readings, t2_warmer);
            let before = core::mem::replace(&mut self.judgement, judgement);
            if judgement == before {
                self.conclude(t, tick, heating, ticks);
            }
        }
        self.found
    }

    /// Is T2 warmer than T1, and not only because it cools later?
    fn compare(&mut self, t: &Tuning, [t0, t1, t2]: [Option<f32>; 3], ticks: f32) {
        let (Some(t0), Some(t1), Some(t2)) = (t0, t1, t2) else { return };
        let mean = self.t2_mean.get_or_insert(t2);
        LowPass::over(t.impulse.steps * ticks).follow(mean, t2);
        let much = larger(t.sensors.gross, t.sensors.share * (t2 - t0));
        self.since_warmer = self.since_warmer.saturating_add(1);
        if t2 - t1 > much && t2 > *mean - t.heat.cooling {
            self.warmer = smaller(t.impulse.steps, self.warmer + (t2 - t1) / (much * ticks));
            self.since_warmer = 0;
        } else {
            self.warmer = 0.0;
        }
    }

    /// Finite as long as all of it is that stays.
    pub(super) fn sum(&self) -> f32 {
        self.response.sum() + self.warmer + self.t2_mean.unwrap_or(0.0)
    }

    /// Once found it stands until thermistors that are heated are seen to agree.
    fn conclude(&mut self, t: &Tuning, tick: u32, heating: bool, ticks: u32) {
        match self.judgement {
            Judgement::Contradict(class) if self.found.is_none_or(|found| found.class != class) => {
                let onset = tick.saturating_sub(t.contradiction.every as u32 * ticks);
                self.found = Some(Finding { class, confidence: 1.0, magnitude: None, onset });
            }
            Judgement::Agree if heating && self.since_warmer > t.contradiction.over as u32 * ticks => {
                self.found = None
            }
            _ => {}
        }
    }
}

fn judge(t: &Tuning, answers: &[Moments; 3], readings: [Option<f32>; 3], t2_warmer: bool) -> Judgement {
    let [_, a1, a2] = answers;
    match contradiction(t, answers, readings, t2_warmer) {
        Some(class) => Judgement::Contradict(class),
        None if a1.responds(t) && a2.responds(t) && a2.comes_after(t, a1) => Judgement::Agree,
        None => Judgement::Open,
    }
}

fn contradiction(
    t: &Tuning,
    answers: &[Moments; 3],
    readings: [Option<f32>; 3],
    t2_warmer: bool,
) -> Option<FaultClass> {
    let [a0, a1, a2] = answers;
    let strongest = if a2.area > a1.area { a2 } else { a1 };
    let [t0, t1, t2] = readings;
    let cold = |reading: Option<f32>, other: Option<f32>| {
        let (reading, t0, other) = (reading?, t0?, other?);
        Some(reading - t0 < t.sensors.share * (other - t0) + t.sensors.alike)
    };
    if a0.responds(t) && a0.area > t.sensors.share * strongest.area {
        return match (a1.is_silent_beside(t, a0), a2.is_silent_beside(t, a0)) {
            (true, _) => Some(FaultClass::Swapped(Pair::T0T1)),
            (false, true) => Some(FaultClass::Swapped(Pair::T0T2)),
            _ => None,
        };
    }
    if !a0.is_silent_beside(t, strongest) {
        return None;
    }
    if a2.responds(t) && a1.is_silent_beside(t, a2) {
        let out = cold(t1, t2)?;
        return Some(if out { FaultClass::T1Detached } else { FaultClass::Stuck(Channel::T1) });
    }
    if a1.responds(t) && a2.is_silent_beside(t, a1) {
        return cold(t2, t1)?.then_some(FaultClass::T2Detached);
    }
    if a1.responds(t) && a2.responds(t) && a1.comes_after(t, a2) {
        return Some(FaultClass::Swapped(Pair::T1T2));
    }
    if a2.responds(t) && t2_warmer {
        return Some(FaultClass::T1Detached);
    }
    let (t0, t1, t2) = (t0?, t1?, t2?);
    let warmest = t0 - t1 > t.sensors.gross && t0 - t2 > t.sensors.gross;
    (warmest && strongest.responds(t)).then_some(FaultClass::T0Fault)
}

impl Moments {
    fn responds(&self, t: &Tuning) -> bool {
        self.area > t.contradiction.answers * self.area_sd
    }

    fn is_silent_beside(&self, t: &Tuning, other: &Self) -> bool {
        self.area.abs() + t.contradiction.answers * self.area_sd < t.sensors.share * other.area
    }

    fn comes_after(&self, t: &Tuning, other: &Self) -> bool {
        let (gap, sd) = (self.late - other.late, self.late_sd + other.late_sd);
        gap > t.contradiction.after && gap > t.contradiction.answers * sd
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A response of this area and centroid, well known.
    fn answer(area: f32, late: f32) -> Moments {
        Moments { area, area_sd: 0.001, late, late_sd: 0.05 }
    }

    /// The table at the head of this file, row by row.
    #[test]
    fn each_row_of_the_table_is_concluded() {
        let silent = || answer(0.0, 0.0);
        let [t1, t2] = [answer(0.3, 5.0), answer(0.28, 7.0)];
        let warm = [Some(22.0), Some(42.0), Some(41.0)];
        let at = |t0: f32, t1: f32, t2: f32| [Some(t0), Some(t1), Some(t2)];
        let said = |answers: [Moments; 3], readings, t2_warmer| {
            contradiction(&Tuning::DEFAULT, &answers, readings, t2_warmer)
        };
        assert_eq!(said([silent(), t1, t2], warm, false), None);
        assert_eq!(judge(&Tuning::DEFAULT, &[silent(), t1, t2], warm, false), Judgement::Agree);
        assert_eq!(said([silent(), silent(), t2], at(22.0, 22.5, 41.0), false), Some(FaultClass::T1Detached));
        assert_eq!(said([silent(), silent(), t2], warm, false), Some(FaultClass::Stuck(Channel::T1)));
        assert_eq!(said([silent(), t1, silent()], at(22.0, 42.0, 22.5), false), Some(FaultClass::T2Detached));
        assert_eq!(said([silent(), t1, silent()], warm, false), None);
        assert_eq!(said([t1, silent(), t2], warm, false), Some(FaultClass::Swapped(Pair::T0T1)));
        assert_eq!(said([t2, t1, silent()], warm, false), Some(FaultClass::Swapped(Pair::T0T2)));
        assert_eq!(said([silent(), t2, t1], warm, false), Some(FaultClass::Swapped(Pair::T1T2)));
        assert_eq!(said([silent(), t1, t2], warm, true), Some(FaultClass::T1Detached));
        assert_eq!(said([silent(), t1, t2], at(60.0, 42.0, 41.0), false), Some(FaultClass::T0Fault));
    }

    #[test]
    fn too_little_seen_concludes_nothing() {
        let unknown = Moments { area: 0.3, area_sd: 0.1, late: 5.0, late_sd: 2.0 };
        assert_eq!(
            judge(&Tuning::DEFAULT, &[unknown; 3], [Some(22.0), Some(42.0), Some(41.0)], false),
            Judgement::Open
        );
    }
}
