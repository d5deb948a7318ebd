//! Where the surroundings move as slowly as the rig answers, what lasts says hardly anything: faults are seen by how they come and go. There a sensor's
//! error that goes is asked for by itself, and so is a heater that is right again.

use super::{Gathered, Watch, WatchState};
use crate::bounds::{larger, smaller};
use crate::likelihood::alarm::Alarm;
use crate::likelihood::class::FaultClass;
use crate::likelihood::hypothesis::{COUNT, HYPOTHESES, Hypothesis};
use crate::likelihood::inputs::Inputs;
use crate::likelihood::recovery::Recovery;
use crate::likelihood::regressor::{Direction, LASTING, Regressor, Regressors};

impl Watch {
    /// By how much the residuals change where the fault of an alarm has gone on this tick, or lately; none while it has not.
    pub(super) fn recovered(
        &self,
        s: &mut WatchState,
        g: &mut Gathered,
        z: [f32; 2],
        row: &Regressors<LASTING>,
        heat: f32,
    ) -> Option<[f32; 2]> {
        let alarm = s.alarm.filter(|_| s.is_slow())?;
        s.sensor_recovered(&alarm, z, row).or_else(|| self.has_recovered(s, g, &alarm, z, heat))
    }

    /// Whether the heater's power is right again. What it did lately the rig still has: the model goes on from there.
    fn has_recovered(
        &self,
        s: &mut WatchState,
        g: &mut Gathered,
        alarm: &Alarm,
        z: [f32; 2],
        heat: f32,
    ) -> Option<[f32; 2]> {
        let of_power =
            HYPOTHESES[alarm.hypothesis % COUNT].first.direction == Direction::Of(Regressor::Power);
        if !of_power {
            g.recovery = Recovery::default();
            return None;
        }
        let theta = alarm.values[0];
        let longest = (self.tuning.slow.longest * s.times.time_scale / self.sample_time) as u32;
        if !g.recovery.step(
            (&s.process, &s.whitening),
            heat,
            [z, g.power_response],
            theta,
            (self.tuning.alarm.kappa, longest),
        ) {
            return None;
        }
        let before = s.process.rises(s.motion.m, s.motion.w).y;
        s.motion.add(&g.onset.power, theta);
        s.motion.add(&g.recovery.power, -theta);
        let after = s.process.rises(s.motion.m, s.motion.w).y;
        Some([after[0] - before[0], after[1] - before[1]])
    }
}

impl WatchState {
    /// Whether the surroundings move so slowly that a constant residual says hardly anything.
    pub(super) fn is_slow(&self) -> bool {
        self.lacks && self.whitening.dc_gain()[0] < self.tuning.slow.dc_gain
    }

    /// A jump that has not gone back on the next tick is no spike, and counts again, in full: what stays shows nothing more.
    pub(super) fn confirm(&mut self, z: [f32; 2], charted: &mut [f32; 2]) {
        let (clip, back) = (self.tuning.charts.clip, self.tuning.slow.back);
        for m in 0..2 {
            let jumped = core::mem::take(&mut self.jumped[m]);
            if jumped * (z[m] + back * jumped) > 0.0 {
                charted[m] =
                    if jumped > 0.0 { larger(charted[m], jumped) } else { smaller(charted[m], jumped) };
            }
            if z[m].abs() > clip {
                self.jumped[m] = z[m];
            }
        }
    }

    /// Whether a fault can be told here. What a controller holds looks stuck, or as if the heater gave always the same, where only slow answers
    /// would tell.
    pub(super) fn asks(&self, inputs: Inputs, row: &Hypothesis) -> bool {
        let stands = matches!(row.class, FaultClass::Stuck(_))
            || row.first.direction == Direction::Of(Regressor::Constant);
        inputs.tell(row.class) && !(self.is_slow() && stands)
    }

    /// By how much T1 and T2 read other where all that this tick shows is that a thermistor reads right again.
    fn sensor_recovered(&self, alarm: &Alarm, z: [f32; 2], row: &Regressors<LASTING>) -> Option<[f32; 2]> {
        let hypothesis = &HYPOTHESES[alarm.hypothesis % COUNT];
        if hypothesis.second.is_some() || hypothesis.class.sensor().is_none() {
            return None;
        }
        let direction = hypothesis.first.direction;
        let mut change = [0.0; 2];
        for (regressor, weight) in direction.regressors().into_iter().zip(direction.weights()) {
            for (change, value) in change.iter_mut().zip(row[regressor % LASTING]) {
                *change += weight * value * alarm.values[0];
            }
        }
        let explained = |m: usize| {
            let left = z[m] + change[m] * self.whitening.inv_sigma[m];
            (z[m] * z[m] - left * left) / (2.0 * self.tuning.alarm.kappa)
        };
        (explained(0) + explained(1) > self.tuning.slow.sensor_over).then_some(change)
    }

    /// The alarm is over, and what it changed of the residuals with it.
    pub(super) fn end_recovered(&mut self, g: &mut Gathered, change: [f32; 2]) {
        self.past.lower(change);
        self.past_clipped.lower(change);
        self.alarm = None;
        self.reset_charts();
        g.begin_anew();
        g.recovery = Recovery::default();
        self.holdoff = self.tuning.slow.holdoff as u32;
    }
}
