//! What has happened since an onset: gathered while anything stirs, an alarm where a fault explains it, taken in where nuisances do, and the
//! alarm's name and end.

use super::{Charted, Gathered, NowRises, Watch, WatchState};
use crate::bounds::{bounded, larger, smaller};
use crate::likelihood::alarm::Alarm;
use crate::likelihood::class::FaultClass;
use crate::likelihood::evidence::{Estimate, Nuisances};
use crate::likelihood::hypothesis::{COUNT, HYPOTHESES, IMPOSSIBLE};
use crate::likelihood::posterior::Posterior;
use crate::likelihood::regressor::{LASTING, PROCESS, Regressor, Regressors, SENSORS};
use crate::likelihood::taught::{Weighed, weigh};
use crate::root::sqrt;

impl Watch {
    /// Gathers since the onset, or begins anew while nothing stirs.
    pub(super) fn follow_onset(
        &self,
        s: &mut WatchState,
        g: &mut Gathered,
        z: [f32; 2],
        widened: [f32; 2],
        charted: &Charted,
        now: &NowRises,
    ) {
        let t = &self.tuning.alarm;
        if s.alarm.is_none() && charted.fast * self.fast.interval < t.near && charted.slow < t.near_slow {
            g.begin_anew();
            s.z_mean = [0.0; 2];
            s.candidate = 0.0;
            return;
        }
        if g.onset.age == 0 {
            s.at_onset = s.measured;
        }
        let mut weight = 1.0 / (1.0 + t.widened * widened[0] * widened[0]);
        let mut jump: f32 = 0.0;
        for m in 0..2 {
            s.z_mean[m] += t.mean_share * (z[m] - s.z_mean[m]);
            jump = larger(jump, (z[m] - s.z_mean[m]).abs());
        }
        let transient =
            if s.is_slow() { 1.0 } else { 1.0 + t.transient_slope * larger(0.0, jump - t.transient_from) };
        weight /= transient * transient;
        // A jump while a sag or the like already stirs: what sensors do begins here, what the process does goes on.
        let most = self.tuning.since_training.clip * self.tuning.since_training.clip;
        let evidence = smaller(z[0] * z[0], most) + smaller(z[1] * z[1], most);
        let begins = if g.onset.age < t.outlasted as u32 {
            evidence > t.jump && evidence > t.jump_ratio * g.since.energy
        } else {
            evidence > 2.0 * t.jump && evidence * g.onset.age as f32 > t.jump_ratio * g.since.energy
        };
        if s.alarm.is_none() && g.onset.age > 0 && begins {
            g.since.forget(&SENSORS);
            g.onset.restart_sensors(now.before[0]);
            s.at_onset = s.measured;
        }
        let row = g.onset.step(&s.times.onset, &s.whitening, &s.nominal(now));
        g.power_response = row[Regressor::Power as usize];
        if let Some(alarm) = &s.alarm {
            if alarm.age > t.forgets_from {
                g.since.scale(s.times.forgets);
            }
            g.window.scale(s.times.window);
            g.window.add(&row, z, weight);
        }
        g.since.add(&row, z, weight);
    }

    /// Raises the alarm where a fault explains more than the nuisances do.
    pub(super) fn decide(
        &self,
        s: &mut WatchState,
        g: &mut Gathered,
        tick: u32,
        charted: &Charted,
        row: &Regressors<LASTING>,
    ) {
        if larger(charted.fast, charted.slow) <= 1.0 || g.onset.age == 0 {
            return;
        }
        s.candidate += self.sample_time / s.times.time_scale;
        let (mut estimate, taught, left) = self.judge_since(s, g);
        let posterior = Posterior::new(&estimate);
        let t = &self.tuning.alarm;
        let best = &HYPOTHESES[posterior.best % COUNT];
        let size = estimate[posterior.best % COUNT].value.abs();
        let small = match best.class {
            FaultClass::HeaterPower => {
                size < larger(self.least_power, t.unusual * sqrt(s.steps + s.curvature_variance()))
            }
            FaultClass::Drift => size < t.least_drift,
            FaultClass::AirFlow => size < t.least_flow,
            _ => false,
        };
        if posterior.best_gain > t.raise && !small {
            let age = g.onset.age.saturating_sub(1);
            g.window = g.since;
            let mut alarm = Alarm::new(tick.saturating_sub(age));
            self.name(g, &mut alarm, &mut estimate, &taught, left);
            s.alarm = Some(alarm);
            // What stirred before and does not explain what is seen was something else, which went on until the process changed, too.
            let old = age as f32 * self.sample_time > t.before * s.times.time_scale;
            if old && left - 2.0 * t.kappa * posterior.best_gain > t.inexplicable * g.since.count {
                g.since.forget(&PROCESS);
                g.window.forget(&PROCESS);
                g.onset.process_again = true;
            }
        } else if s.candidate > t.taken_after {
            s.take_in(g, row);
        }
    }

    /// Names the fault while it lasts; clears the alarm when it has gone. A young alarm is ranked and asked for its end on every tick, an older one
    /// by turns.
    pub(super) fn follow_alarm(
        &self,
        s: &mut WatchState,
        g: &mut Gathered,
        z: [f32; 2],
        row: &Regressors<LASTING>,
        heat: f32,
    ) {
        let Some(mut alarm) = s.alarm else { return };
        let t = &self.tuning.alarm;
        alarm.age += self.sample_time / s.times.time_scale;
        alarm.turn = !alarm.turn;
        let young = alarm.age < t.young;
        if young || alarm.turn {
            let (mut estimate, taught, left) = self.judge_since(s, g);
            self.name(g, &mut alarm, &mut estimate, &taught, left);
        }
        let over = (young || !alarm.turn) && s.is_over(g, &alarm);
        s.alarm = Some(alarm);
        if let Some(change) = self.recovered(s, g, z, row, heat) {
            s.end_recovered(g, change);
        } else if over || (alarm.age > self.tuning.naming.process_time && alarm.gain < t.least_gain) {
            s.alarm = None;
            s.reset_charts();
            g.begin_anew();
            s.holdoff = (t.holdoff * s.times.time_scale / self.sample_time) as u32;
            s.tracker.widen([t.power_after, 0.0, t.offset_after, t.offset_after]);
        }
    }

    /// Gains of all hypotheses since the onset, and of what was taught; what the nuisances leave of the residual sum of squares.
    fn judge_since(&self, s: &WatchState, g: &Gathered) -> ([Estimate; COUNT], Weighed, f32) {
        let nuisances = s.nuisances();
        let nuisances = Nuisances::new(&g.since, &nuisances, self.tuning.alarm.kappa);
        let left = g.since.energy - nuisances.explained;
        let beyond = nuisances.beyond();
        let mut estimate = [Estimate { gain: IMPOSSIBLE, ..Estimate::default() }; COUNT];
        for (estimate, row) in
            estimate.iter_mut().zip(self.tuning.hypotheses()).filter(|(_, row)| s.asks(self.inputs, row))
        {
            let mut second = row.second;
            if let (Some(second), Some(m)) = (&mut second, row.stuck_at) {
                second.mean = s.at_onset[m % 2];
            }
            *estimate = row.judged(beyond.estimate(row.first, second));
            if let Some(second) = row.later(&self.tuning.hypotheses, estimate.value) {
                *estimate = row.judged(beyond.estimate(row.first, Some(second)));
            }
        }
        (estimate, weigh(&self.tuning.taught, &self.taught, &beyond), left)
    }
}

impl WatchState {
    /// Mean square of the gain's error as far from the trained power as the rig is now: a share.
    pub(super) fn curvature_variance(&self) -> f32 {
        // A fault moves either what is expected or, where the controller cannot help it, what is measured; a new set-point moves both.
        let from_trained = |rise: f32| (rise - self.trained).abs();
        let away = smaller(from_trained(self.swing[0]), from_trained(self.measured[0])) / self.gain();
        let t = &self.tuning.alarm;
        // Where it was excited the gain is known.
        // Surroundings that are slower still are learnt as such, in the noise model.
        let inflation = if self.is_slow() { 1.0 } else { t.curvature_inflation };
        let error = inflation * self.curvature_error * larger(0.0, away / self.tuning.model.step - t.excited);
        error * error
    }

    /// Shares, 0 to 1, of the residuals since the onset that each hypothesis would take away all by itself, with its class; None without an alarm.
    pub(in crate::likelihood) fn explained(&self, g: &Gathered) -> Option<[(FaultClass, f32); COUNT]> {
        self.alarm.as_ref()?;
        let kappa = self.tuning.alarm.kappa;
        let alone = Nuisances::new(&g.since, &[], kappa).beyond();
        let energy = larger(1.0, g.since.energy - g.since.count);
        Some(core::array::from_fn(|h| {
            let row = &self.tuning.hypotheses()[h];
            let mut second = row.second;
            if let (Some(second), Some(m)) = (&mut second, row.stuck_at) {
                second.mean = self.at_onset[m];
            }
            let estimate = row.judged(alone.estimate(row.first, second));
            (row.class, bounded(2.0 * kappa * (estimate.gain - row.prior) / energy, 0.0, 1.0))
        }))
    }

    /// Whether the nuisances alone explain one of the windows better than the fault as it was.
    fn is_over(&self, g: &Gathered, alarm: &Alarm) -> bool {
        let row = &HYPOTHESES[alarm.hypothesis % COUNT];
        let [value, second] = alarm.values;
        let first = (row.first.direction, value);
        let both = [first, row.second.map_or(first, |free| (free.direction, second))];
        let at = if row.second.is_some() { &both[..] } else { &both[..1] };
        let (list, t) = (self.nuisances(), &self.tuning.alarm);
        alarm.age > t.asked_from && Nuisances::new(&g.window, &list, t.kappa).fixed(at) < -t.over
    }

    /// Nuisances explain what the charts say: the tracker takes them.
    pub(super) fn take_in(&mut self, g: &mut Gathered, row: &Regressors<LASTING>) {
        let before = self.tracker.expected(row);
        let nuisances = self.nuisances();
        let t = self.tuning;
        let nuisances = Nuisances::new(&g.since, &nuisances, t.alarm.kappa);
        let [power, less, more, offset1, offset2, offset0, ..] = nuisances.values();
        self.steps += t.tracker.step_share * (power * power - self.steps);
        self.steps = larger(t.nuisances.onset_power * t.nuisances.onset_power, self.steps);
        let by = [power, less + more, offset1 - offset0, offset2 - offset0];
        for (x, by) in self.tracker.x.iter_mut().zip(by) {
            *x += by;
        }
        let (power, offset) = (t.tracker.first_power, t.tracker.first_offset);
        self.tracker.widen([power, 0.0, offset, offset]);
        let after = self.tracker.expected(row);
        let change = [after[0] - before[0], after[1] - before[1]];
        self.past.lower(change);
        self.past_clipped.lower(change);
        self.reset_charts();
        g.begin_anew();
    }
}
