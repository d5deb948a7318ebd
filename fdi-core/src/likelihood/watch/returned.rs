//! "As trained": while an alarm stands, are the residuals of the last seconds those of the trained rig again?
//!
//! What the tracker has taken in of a fault that came slowly is missing when that fault is mended: an alarm since the onset of the mending then explains
//! just that, and goes on for ever. So the residuals without the tracker are asked, too, by the hypotheses and the nuisances of the bank since
//! training: where the nuisances leave noise, no fault explains more, and what is left of the one of the alarm is not what the alarm says, all is as it
//! was trained.

use super::simulation::Simulated;
use super::times::Times;
use super::{SinceOnsetState, Watch, WatchState};
use crate::bounds::larger;
use crate::likelihood::evidence::Nuisances;
use crate::likelihood::hypothesis::{COUNT, Hypothesis, LASTING_PAIRS};
use crate::likelihood::inputs::Inputs;
use crate::likelihood::normal::LastingNormal;
use crate::likelihood::regressor::{LASTING, Regressors};
use crate::likelihood::tuning::Tuned;
use crate::likelihood::usual::Usual;

/// The question, for a rig with these inputs.
#[derive(Clone, Debug)]
pub(super) struct Returned {
    pub(super) least_power: f32,
    pub(super) sample_time: f32,
    pub(super) inputs: Inputs,
    pub(super) tuning: Tuned,
}

/// The memory: sums over the last seconds of an alarm, and its age in ticks.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ReturnedState {
    normal: LastingNormal,
    ticks: u32,
}

impl Returned {
    /// Gathers a tick with an alarm, regressors and residuals since training, whitened; says whether it is one on which the question is asked.
    pub(super) fn gather(
        &self,
        s: &mut ReturnedState,
        times: &Times,
        regressors: &Regressors<LASTING>,
        z: [f32; 2],
    ) -> bool {
        s.normal.add(times.recent, regressors, z, 1.0);
        s.ticks = s.ticks.saturating_add(1);
        // Twice the memory: then hardly anything is left of what was before the alarm.
        let asked_from = times.ticks(2.0 * self.tuning.times.split, self.sample_time);
        s.ticks >= asked_from && s.ticks.is_multiple_of(self.tuning.since_training.every as u32)
    }

    /// What the nuisances are if all is as it was trained but for what moves here without being a fault: power, air flow, offsets of T1 and T2. It is asked
    /// during an alarm of hypothesis `h`. An alarm since an onset says that there is so much of it, and stands while that is nearer to what is seen than
    /// nothing is, however small that is; a change since training, while it may be a fault by its size. `expected` is what T1 should read above T0, degC.
    #[inline(never)]
    pub(super) fn as_trained(
        &self,
        s: &ReturnedState,
        usual: &Usual,
        (h, value): (usize, Option<f32>),
        expected: f32,
    ) -> Option<[f32; 4]> {
        let (t, normal) = (&self.tuning.since_training, &s.normal);
        let list = usual.since_training(usual.error_of(expected));
        let nuisances = Nuisances::new(normal.sums(), &list, t.kappa);
        let left = normal.energy - nuisances.explained;
        if !(left < self.tuning.naming.fits * larger(1.0, normal.count)) {
            return None;
        }
        let beyond = nuisances.beyond(&LASTING_PAIRS);
        let ours = &self.tuning.hypotheses()[h % COUNT];
        let ours_left = if ours.lasting { beyond.estimate(ours.first, None).value } else { 0.0 };
        let least = t.lasting_size * usual.least_since_training(ours.class, self.least_power);
        let stands =
            value.map_or(ours_left.abs() > least, |value| (value - ours_left).abs() < ours_left.abs());
        if stands {
            return None;
        }
        let mut asked =
            self.tuning.hypotheses().iter().filter(|row| row.lasting && self.inputs.tell(row.class));
        let explains_more =
            |row: &Hypothesis| row.judged(beyond.estimate(row.first, None)).gain > t.lasting_raise * t.raise;
        if asked.any(explains_more) {
            return None;
        }
        let [_, _, power, less, more, offset1, offset2, ..] = nuisances.values();
        Some([power, less + more, offset1, offset2])
    }
}

impl Watch {
    /// Ends whatever alarm stands where all is as it was trained, and forgets what the tracker has taken in.
    pub(super) fn follow_return(
        &self,
        s: &mut WatchState,
        onset: &mut SinceOnsetState,
        whitened: &Regressors<LASTING>,
        z: [f32; 2],
        e: [f32; 2],
        now: &Simulated,
    ) {
        let since_onset = onset.hypothesis().map(|(h, value)| (h, Some(value)));
        let lasting = || s.since_training.hypothesis().map(|h| (h, None));
        let Some(of_alarm) = since_onset.or_else(lasting) else {
            s.returned.reset();
            return;
        };
        let asked = self.returned.gather(&mut s.returned, &s.times, whitened, z);
        let left = asked
            .then(|| self.returned.as_trained(&s.returned, &s.usual(), of_alarm, now.expected[0]))
            .flatten();
        if let Some(left) = left {
            s.returned.reset();
            onset.begin_anew();
            s.since_training.forget(e);
            let change = s.tracker.return_to(left, &now.regressors);
            s.innovations.lower(change);
            s.charts.hold_off(s.times.ticks(self.tuning.times.reference, self.sample_time));
        }
    }
}

impl ReturnedState {
    /// Without an alarm there is nothing to return from.
    pub(super) fn reset(&mut self) {
        if self.ticks > 0 {
            *self = Self::default();
        }
    }

    /// Finite as long as all of it is.
    pub(super) fn sum(&self) -> f32 {
        self.normal.sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::likelihood::class::FaultClass;
    use crate::likelihood::hypothesis::HYPOTHESES;
    use crate::likelihood::regressor::Regressor;
    use crate::likelihood::watch::tests::trained;

    /// A heater that gave 30 % less was mended, so that an alarm says that it gives 22 % more than it did. Of 8 % less than in training, which is no fault,
    /// the last seconds are not sure: all is as trained. An alarm of 10 % less stands, and so does a change since training that is as large as this.
    #[test]
    fn an_alarm_that_is_refuted_does_not_stand_for_a_rest() {
        let tuning = Tuned::default();
        let returned = Returned { least_power: 0.085, sample_time: 0.11, inputs: Inputs::ALL, tuning };
        let times = Times::new(tuning, &trained(1), Inputs::ALL, 0.11);
        let (mut s, mut regressors) = (ReturnedState::default(), [[0.0; 2]; LASTING]);
        regressors[Regressor::Power as usize] = [4.4, 3.4];
        for _ in 0..1000 {
            returned.gather(&mut s, &times, &regressors, [-0.08 * 4.4, -0.08 * 3.4]);
        }
        let power = HYPOTHESES.iter().position(|row| row.class == FaultClass::HeaterPower).unwrap();
        let is_over = |value| returned.as_trained(&s, &Usual::calm(), (power, value), 13.0).is_some();
        assert_eq!([Some(0.22), Some(-0.1), None].map(is_over), [true, false, false]);
    }
}
