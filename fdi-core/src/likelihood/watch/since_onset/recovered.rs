//! Where the surroundings move as slowly as the rig answers, what lasts says hardly anything: faults are seen by how they come and go. There a sensor's
//! error that goes is asked for by itself, and so is a heater that is right again.

use super::{Outcome, Seen, SinceOnset, SinceOnsetState};
use crate::likelihood::alarm::Alarm;
use crate::likelihood::hypothesis::{COUNT, HYPOTHESES};
use crate::likelihood::recovery::Recovery;
use crate::likelihood::regressor::{Direction, LASTING, Regressor};

impl SinceOnset {
    /// What is right again on this tick, or has been lately; none while the fault of the alarm lasts.
    pub(super) fn recovered(&self, s: &mut SinceOnsetState, alarm: &Alarm, seen: &Seen) -> Option<Outcome> {
        if !seen.times.slow_surroundings {
            return None;
        }
        let sensor = self.sensor_recovered(alarm, seen).map(Outcome::SensorRecovered);
        sensor.or_else(|| self.power_recovered(s, alarm, seen).map(Outcome::PowerRecovered))
    }

    /// By which share the heater's power was other, where it is right again.
    fn power_recovered(&self, s: &mut SinceOnsetState, alarm: &Alarm, seen: &Seen) -> Option<f32> {
        let of_power =
            HYPOTHESES[alarm.hypothesis % COUNT].first.direction == Direction::Of(Regressor::Power);
        if !of_power {
            s.recovery = Recovery::default();
            return None;
        }
        let theta = alarm.values[0];
        let longest = (self.tuning.times.reference * seen.times.time_scale / self.sample_time) as u32;
        let gone = s.recovery.step(
            (seen.nominal.process, seen.filter),
            seen.nominal.heat,
            [seen.innovations.z, s.power_response],
            theta,
            (self.tuning.alarm.kappa, longest),
        );
        gone.then_some(theta)
    }

    /// By how much T1 and T2 read other where all that this tick shows is that a thermistor reads right again, degC.
    fn sensor_recovered(&self, alarm: &Alarm, seen: &Seen) -> Option<[f32; 2]> {
        let hypothesis = &HYPOTHESES[alarm.hypothesis % COUNT];
        if hypothesis.second.is_some() || hypothesis.class.sensor().is_none() {
            return None;
        }
        let direction = hypothesis.first.direction;
        let mut change = [0.0; 2];
        for (regressor, weight) in direction.regressors().into_iter().zip(direction.weights()) {
            for (change, value) in change.iter_mut().zip(seen.simulated.regressors[regressor % LASTING]) {
                *change += weight * value * alarm.values[0];
            }
        }
        let z = seen.innovations.z;
        let explained = |m: usize| {
            let left = z[m] + change[m] * seen.filter.inv_sigma[m];
            (z[m] * z[m] - left * left) / (2.0 * self.tuning.alarm.kappa)
        };
        (explained(0) + explained(1) > 2.0 * self.tuning.alarm.over).then_some(change)
    }
}

impl SinceOnsetState {
    /// The alarm is over, since its fault is.
    pub(in crate::likelihood::watch) fn end_recovered(&mut self) {
        self.begin_anew();
        self.recovery = Recovery::default();
    }
}
