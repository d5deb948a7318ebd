//! What moves on this rig without being a fault, by what has been seen of it: the nuisances' spreads, and the smallest change that is a fault.

use super::class::{FaultClass, Quantity};
use super::evidence::Nuisance;
use super::hypothesis::{
    NUISANCES_SINCE_ONSET, NUISANCES_SINCE_TRAINING, nuisances_since_onset, nuisances_since_training,
};
use super::tuning::Tuned;
use crate::bounds::larger;
use crate::root::sqrt;

/// What is usual, as far as is known now.
#[derive(Clone, Copy, Debug)]
pub(super) struct Usual {
    /// Mean square of the steps of the power that the tracker took over.
    pub(super) steps: f32,
    /// Mean squares of what the tracker has followed: power, air flow, both offsets.
    pub(super) walk: [f32; 4],
    /// Mean square of the gain's error, a share, as far from the trained power as the rig is.
    pub(super) curvature: f32,
    /// The surroundings move as slowly as the rig answers.
    pub(super) slow_surroundings: bool,
    pub(super) tuning: Tuned,
}

/// Nuisances since an onset, and since training.
pub(super) type Nuisances = [Nuisance; NUISANCES_SINCE_ONSET];
pub(super) type LastingNuisances = [Nuisance; NUISANCES_SINCE_TRAINING];

/// Places in both lists: of the dead time's error, and of the power, the flow and the offsets. Place of T0 in the second.
const SHIFT: usize = 1;
const POWER: usize = 2;
const FLOW: core::ops::Range<usize> = 3..5;
const LASTING_T0: usize = NUISANCES_SINCE_TRAINING - 1;

impl Usual {
    /// Nuisances since an onset. What was learnt wrong with the gain looks like flow, too.
    pub(super) fn since_onset(&self) -> Nuisances {
        let mut nuisances = nuisances_since_onset(&self.tuning.nuisances);
        nuisances[POWER].1 = sqrt(self.moved() + self.curvature);
        for (_, sd) in &mut nuisances[FLOW] {
            *sd = sqrt(*sd * *sd + self.curvature);
        }
        if self.slow_surroundings {
            nuisances[SHIFT].1 = self.tuning.slow.shift;
        }
        nuisances
    }

    /// The same where a change of this quantity explains best what is seen: it may be as large as a fault.
    pub(super) fn since_onset_with(&self, quantity: Quantity) -> Nuisances {
        let mut nuisances = self.since_onset();
        let (freed, sd) = match quantity {
            Quantity::Power => (POWER..FLOW.start, self.tuning.hypotheses.share_sd),
            Quantity::Flow => (FLOW, self.tuning.hypotheses.flow_sd),
            Quantity::Nothing | Quantity::Offset | Quantity::Ramp | Quantity::Rise => return nuisances,
        };
        nuisances[freed].iter_mut().for_each(|nuisance| nuisance.1 = sd);
        nuisances
    }

    /// Mean square of what the gain's error makes of a rise, degC.
    pub(super) fn error_of(&self, rise: f32) -> f32 {
        self.curvature * rise * rise
    }

    /// Nuisances since training. The gain's error at the mean power is another than that of its moves, so that an offset of both is left, of the
    /// mean square `offset`, degC.
    pub(super) fn since_training(&self, offset: f32) -> LastingNuisances {
        let mut nuisances = nuisances_since_training(&self.tuning.nuisances);
        let [power, flow, offset1, offset2] = self.walk;
        // A step leads from one draw to another, so that it has twice the mean square of each.
        let least_steps = self.tuning.nuisances.onset_power * self.tuning.nuisances.onset_power;
        let power = larger(power, 0.5 * (self.steps - least_steps));
        let flow = flow + self.curvature;
        let more = [power + self.curvature, flow, flow, offset1, offset2];
        let widen = |(_, sd): &mut Nuisance, more: f32| *sd = sqrt(*sd * *sd + more);
        nuisances[POWER..].iter_mut().zip(more).for_each(|(nuisance, more)| widen(nuisance, more));
        widen(&mut nuisances[LASTING_T0], offset);
        nuisances
    }

    /// Mean squares of what may have moved since training. What it was then is as far from its mean as it is now: of two draws of one process the
    /// difference has twice the mean square.
    fn walk_since_training(&self) -> [f32; 4] {
        self.walk.map(|square| 2.0 * square)
    }

    /// Mean square of a change of the power that is usual: a step leads from one draw of what the mains do to another, too.
    fn moved(&self) -> f32 {
        larger(self.steps, self.walk_since_training()[0])
    }

    /// The smallest magnitude of a hypothesis that is a fault when it comes at an onset, with that of the power by the setting; 0 where whatever is
    /// seen is one.
    pub(super) fn least_since_onset(&self, class: FaultClass, power: f32) -> f32 {
        let t = &self.tuning.alarm;
        match class.quantity() {
            Quantity::Power => larger(power, t.unusual * sqrt(self.moved() + self.curvature)),
            Quantity::Flow => t.least_flow,
            Quantity::Ramp => t.least_drift,
            Quantity::Nothing | Quantity::Offset | Quantity::Rise => 0.0,
        }
    }

    /// The same when it has come about since training.
    pub(super) fn least_since_training(&self, class: FaultClass, power: f32) -> f32 {
        let (t, alarm) = (&self.tuning.since_training, &self.tuning.alarm);
        let walk = self.walk_since_training();
        match class.quantity() {
            Quantity::Power => larger(power, alarm.unusual * sqrt(self.moved() + self.curvature)),
            Quantity::Flow => larger(alarm.least_flow, alarm.unusual * sqrt(walk[1])),
            Quantity::Rise => t.least_gain,
            Quantity::Nothing | Quantity::Offset | Quantity::Ramp => t.least_offset,
        }
    }
}

#[cfg(test)]
impl Usual {
    /// Where nothing has been seen to move.
    pub(super) fn calm() -> Self {
        Self {
            steps: 0.0,
            walk: [0.0; 4],
            curvature: 0.0,
            slow_surroundings: false,
            tuning: Tuned::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use core::f32::consts::SQRT_2;

    use super::*;

    /// The smallest change of the power is the user's, and more where the mains are seen to change by more.
    #[test]
    fn the_smallest_change_of_the_power_is_that_of_the_setting() {
        let calm = Usual::calm();
        let restless = Usual { walk: [0.04, 0.0, 0.0, 0.0], steps: 0.04, ..calm };
        let power = FaultClass::HeaterPower;
        assert_eq!([calm.least_since_onset(power, 0.2), calm.least_since_training(power, 0.2)], [0.2; 2]);
        assert!((restless.least_since_onset(power, 0.2) - 0.6 * SQRT_2).abs() < 1e-6);
        assert!((restless.least_since_training(power, 0.2) - 0.6 * SQRT_2).abs() < 1e-6);
        // Steps are differences already.
        let steps = Usual { walk: [0.0; 4], ..restless };
        assert!((steps.least_since_onset(power, 0.2) - 0.6).abs() < 1e-6);
        assert!((steps.least_since_training(power, 0.2) - 0.6).abs() < 1e-6);
    }
}
