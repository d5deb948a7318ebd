//! What has happened since an onset: gathered while anything stirs, an alarm where a fault explains it, taken in where nuisances do, and the
//! alarm's name and end.

use super::naming::PROCESS_TIME;
use super::{Charted, Gathered, KAPPA, LEAST_FLOW, NowRises, OVERSURE, UNUSUAL, Watch, WatchState};
use crate::bounds::{bounded, larger, smaller};
use crate::likelihood::alarm::Alarm;
use crate::likelihood::class::FaultClass;
use crate::likelihood::column::{Column, LASTING, PROCESS, Row, SENSORS};
use crate::likelihood::evidence::{Freed, Nuisances};
use crate::likelihood::hypothesis::{self, COUNT, HYPOTHESES, IMPOSSIBLE};
use crate::likelihood::posterior::Posterior;
use crate::likelihood::process::STEP;
use crate::likelihood::taught::{Weighed, weigh};
use crate::root::sqrt;

/// All columns begin anew while the fast charts are below so many standard deviations, and the slow one below this share of its interval.
const NEAR: f32 = 0.5;
const NEAR_SLOW: f32 = 0.14;
/// Log Bayes factor that raises an alarm.
const RAISE: f32 = 4.5;
/// An alarm is over by these log odds in a window, which is asked from so long on, s.
const OVER: f32 = 5.0;
const ASKED_FROM: f32 = 0.5;
/// An alarm is young for so long, s.
const YOUNG: f32 = 2.0;
/// What stirred for longer than this before an alarm may have been something else, s.
const STIRRED: f32 = 0.4;
/// It was, where more than so much of each whitened residual's square is left.
const INEXPLICABLE: f32 = 10.0;
/// Least sum of both squares of what begins in one tick, in variances.
const JUMP: f32 = 16.0;
/// Ticks after which one that shows much more than they did in the mean is the beginning of something else; before, more than all of them.
const OUTLASTED: u32 = 4;
/// What nuisances explain for so long is taken into the tracker, s.
const TAKEN_AFTER: f32 = 8.0;
/// From so old on an alarm forgets with this memory, s.
const FORGETS_FROM: f32 = 3.0;
/// So many steps of the power around the trained one count as excited.
const EXCITED: f32 = 0.5;
/// Weight of a new step of the power in what is known of their size.
const STEP_SHARE: f32 = 0.2;

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
        if s.alarm.is_none() && charted.fast * self.fast.interval < NEAR && charted.slow < NEAR_SLOW {
            g.begin_anew();
            s.z_mean = [0.0; 2];
            s.candidate = 0.0;
            return;
        }
        if g.onset.age == 0 {
            s.stays = s.measured;
        }
        let mut weight = 1.0 / (1.0 + 0.25 * widened[0] * widened[0]);
        let mut jump: f32 = 0.0;
        for m in 0..2 {
            s.z_mean[m] += 0.3 * (z[m] - s.z_mean[m]);
            jump = larger(jump, (z[m] - s.z_mean[m]).abs());
        }
        let transient = if s.is_slow() { 1.0 } else { 1.0 + 0.1 * larger(0.0, jump - 3.0) };
        weight /= transient * transient;
        // A jump while a sag or the like already stirs: what sensors do begins here, what the process does goes on.
        let evidence = smaller(z[0] * z[0], 64.0) + smaller(z[1] * z[1], 64.0);
        let begins = if g.onset.age < OUTLASTED {
            evidence > JUMP && evidence > 4.0 * g.since.energy
        } else {
            evidence > 2.0 * JUMP && evidence * g.onset.age as f32 > 4.0 * g.since.energy
        };
        if s.alarm.is_none() && g.onset.age > 0 && begins {
            g.since.forget(&SENSORS);
            g.onset.restart_sensors(now.before[0]);
            s.stays = s.measured;
        }
        let row = g.onset.step(&s.pace.onset, &s.ladder, &s.nominal(now));
        g.answer = row[Column::Power as usize];
        if let Some(alarm) = &s.alarm {
            if alarm.age > FORGETS_FROM {
                g.since.scale(s.pace.forgets);
            }
            g.window.scale(s.pace.window);
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
        row: &Row<LASTING>,
    ) {
        if larger(charted.fast, charted.slow) <= 1.0 || g.onset.age == 0 {
            return;
        }
        s.candidate += self.sample_time / s.pace.stretch;
        let (mut freed, taught, left) = self.judge_since(s, g);
        let posterior = Posterior::new(&freed);
        let best = &HYPOTHESES[posterior.best % COUNT];
        let size = freed[posterior.best % COUNT].value.abs();
        let small = match best.class {
            FaultClass::HeaterPower => size < larger(self.least_power, UNUSUAL * sqrt(s.steps + s.bent())),
            FaultClass::Drift => size < 1.0,
            FaultClass::AirFlow => size < LEAST_FLOW,
            _ => false,
        };
        if posterior.best_gain > RAISE && !small {
            let age = g.onset.age.saturating_sub(1);
            g.window = g.since;
            let mut alarm = Alarm::new(tick.saturating_sub(age));
            self.name(g, &mut alarm, &mut freed, &taught, left);
            s.alarm = Some(alarm);
            // What stirred before and does not explain what is seen was something else, which went on until the process changed, too.
            let old = age as f32 * self.sample_time > STIRRED * s.pace.stretch;
            if old && left - 2.0 * KAPPA * posterior.best_gain > INEXPLICABLE * g.since.count {
                g.since.forget(&PROCESS);
                g.window.forget(&PROCESS);
                g.onset.process_again = true;
            }
        } else if s.candidate > TAKEN_AFTER {
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
        row: &Row<LASTING>,
        heat: f32,
    ) {
        let Some(mut alarm) = s.alarm else { return };
        alarm.age += self.sample_time / s.pace.stretch;
        alarm.turn = !alarm.turn;
        let young = alarm.age < YOUNG;
        if young || alarm.turn {
            let (mut freed, taught, left) = self.judge_since(s, g);
            self.name(g, &mut alarm, &mut freed, &taught, left);
        }
        let over = (young || !alarm.turn) && s.is_over(g, &alarm);
        s.alarm = Some(alarm);
        if let Some(change) = self.goes(s, g, z, row, heat) {
            s.goes_on_without(g, change);
        } else if over || (alarm.age > PROCESS_TIME && alarm.gain < 1.0) {
            s.alarm = None;
            s.rest();
            g.begin_anew();
            s.rests = (s.pace.stretch / self.sample_time) as u32;
            s.tracker.widen([0.015, 0.0, 0.05, 0.05]);
        }
    }

    /// Gains of all hypotheses since the onset, and of what was taught; what the nuisances leave of the residual sum of squares.
    fn judge_since(&self, s: &WatchState, g: &Gathered) -> ([Freed; COUNT], Weighed, f32) {
        let nuisances = s.nuisances();
        let nuisances = Nuisances::new(&g.since, &nuisances, KAPPA).for_many();
        let mut freed = [Freed { gain: IMPOSSIBLE, ..Freed::default() }; COUNT];
        for (freed, row) in freed.iter_mut().zip(&HYPOTHESES).filter(|(_, row)| s.asks(self.inputs, row)) {
            let mut second = row.second;
            if let (Some(second), Some(m)) = (&mut second, row.stays) {
                second.mean = s.stays[m % 2];
            }
            *freed = row.judged(nuisances.free(row.first, second));
            if let Some(second) = row.later(freed.value) {
                *freed = row.judged(nuisances.free(row.first, Some(second)));
            }
        }
        (freed, weigh(&self.taught, &nuisances), g.since.energy - nuisances.explained)
    }
}

impl WatchState {
    /// Mean square of the gain's error as far from the trained power as the rig is now: a share.
    pub(super) fn bent(&self) -> f32 {
        // A fault moves either what is expected or, where the controller cannot help it, what is measured; a new set-point moves both.
        let from_trained = |rise: f32| (rise - self.trained).abs();
        let away = smaller(from_trained(self.swing[0]), from_trained(self.measured[0])) / self.gain();
        // Where it was excited the gain is known.
        // Surroundings that are slower still are learnt as such, in the noise model.
        let oversure = if self.is_slow() { 1.0 } else { OVERSURE };
        let error = oversure * self.curvature_error * larger(0.0, away / STEP - EXCITED);
        error * error
    }

    /// Shares, 0 to 1, of the residuals since the onset that each hypothesis would take away all by itself, with its class; None without an alarm.
    pub(in crate::likelihood) fn explained(&self, g: &Gathered) -> Option<[(FaultClass, f32); COUNT]> {
        self.alarm.as_ref()?;
        let alone = Nuisances::new(&g.since, &[], KAPPA);
        let energy = larger(1.0, g.since.energy - g.since.count);
        Some(core::array::from_fn(|h| {
            let row = &HYPOTHESES[h];
            let mut second = row.second;
            if let (Some(second), Some(m)) = (&mut second, row.stays) {
                second.mean = self.stays[m];
            }
            let freed = row.judged(alone.free(row.first, second));
            (row.class, bounded(2.0 * KAPPA * (freed.gain - row.prior) / energy, 0.0, 1.0))
        }))
    }

    /// Whether the nuisances alone explain one of the windows better than the fault as it was.
    fn is_over(&self, g: &Gathered, alarm: &Alarm) -> bool {
        let row = &HYPOTHESES[alarm.hypothesis % COUNT];
        let [value, second] = alarm.values;
        let first = (row.first.direction, value);
        let both = [first, row.second.map_or(first, |free| (free.direction, second))];
        let at = if row.second.is_some() { &both[..] } else { &both[..1] };
        let list = self.nuisances();
        alarm.age > ASKED_FROM && Nuisances::new(&g.window, &list, KAPPA).fixed(at) < -OVER
    }

    /// Nuisances explain what the charts say: the tracker takes them.
    pub(super) fn take_in(&mut self, g: &mut Gathered, row: &Row<LASTING>) {
        let before = self.tracker.expected(row);
        let nuisances = self.nuisances();
        let nuisances = Nuisances::new(&g.since, &nuisances, KAPPA);
        let [power, less, more, offset1, offset2, offset0, ..] = nuisances.values();
        self.steps += STEP_SHARE * (power * power - self.steps);
        self.steps = larger(hypothesis::POWER_SD * hypothesis::POWER_SD, self.steps);
        let by = [power, less + more, offset1 - offset0, offset2 - offset0];
        for (x, by) in self.tracker.x.iter_mut().zip(by) {
            *x += by;
        }
        self.tracker.widen([0.01, 0.0, 0.1, 0.1]);
        let after = self.tracker.expected(row);
        let change = [after[0] - before[0], after[1] - before[1]];
        self.past.lower(change);
        self.past_clipped.lower(change);
        self.rest();
        g.begin_anew();
    }
}
