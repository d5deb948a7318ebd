//! The watch over a trained rig: residuals of frozen models, charts on them, the bank that explains what the charts find.
//!
//! While nothing is wrong the means of the residuals follow slow change; they are frozen as soon as a chart stirs. The
//! bank starts anew whenever all fast charts are near zero, so that when one fires, it has gathered since the onset.

use super::alarm::{Alarm, Rules};
use super::bank::{Bank, Briskness, Filters, Moment};
use super::chart::{Chart, Sums};
use super::fit::{NA, NB};
use super::heat::{Heat, HeatState, Rise};
use super::hypothesis::Weighed;
use super::model::{dot, shift};
use super::training::Trained;
use super::verdict::Finding;
use super::weakness::{Slack, Weakness, WeaknessState};
use super::whitening::Past;
use crate::bounds::{bounded, larger};

/// Charts and the simulation of y2 from y1 see no more of an innovation than so many standard deviations.
const CLIP: f32 = 6.0;
/// Below this share of its limit a chart has not stirred.
const STIRRED: f32 = 0.4;
/// A fast chart below this sum is near zero.
const NEAR_ZERO: f32 = 1.0;
/// Evidence of one tick that exceeds so many times all before it is the true onset.
const OUTSHINES: f32 = 4.0;
/// A sag that lasts so long is taken into the means, s.
const SAG_TIME: f32 = 3.0;
/// Share of a level's running mean that is renewed in a tick.
const LEVEL_SHARE: f32 = 0.4;
/// A valid T1 and T2 that are so much further apart than learnt contradict each other, degC: neither is regulated by.
const APART: f32 = 6.0;
/// How far sags may carry the means from where they were trained: degC, on top of 1.5 tolerated sags.
const MEAN_REACH: f32 = 0.25;

/// A validated watch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watch {
    pub(super) fast: Chart,
    pub(super) slow: Chart,
    pub(super) weakness: Weakness,
    pub(super) filters: Filters,
    pub(super) heat: Heat,
    pub(super) rules: Rules,
    /// Share of the means that is renewed in a tick.
    pub(super) mean_share: f32,
    pub(super) tolerated_sag: f32,
    pub(super) sample_time: f32,
}

/// Its memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct WatchState {
    trained: Trained,
    lead: usize,
    brisk: Briskness,
    /// Means of the residuals of y1, y2 and y2 from y1, degC.
    mean: [f32; 3],
    past: [Past; 3],
    past_clipped: [Past; 3],
    fast: [Sums; 3],
    slow: Sums,
    /// Last tick on which the slow chart was at zero.
    slow_onset: u32,
    weakness: WeaknessState,
    bank: Bank,
    measured: [f32; 2],
    levels: Levels,
    /// Ticks for which a sag has explained what the charts say.
    sagging: u32,
    alarm: Option<Alarm>,
    heat: HeatState,
    /// T1 and T2, both valid, do not belong together.
    apart: bool,
    /// What the models say y1 and y2 should be now.
    expected: [f32; 2],
}

/// Where the residuals are now: means over a few ticks.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Levels {
    /// Of the residuals, degC.
    pub(super) residual: [f32; 3],
    /// Of A(z) times the residual of y1, degC: what drives it, without what is only decaying.
    pub(super) drive: f32,
    past: [f32; NA],
}

/// One tick, worked out.
struct Now {
    tick: u32,
    /// Residuals, where valid.
    e: [Option<f32>; 3],
    /// What y1 and y2 should be.
    expected: [f32; 2],
    y1_before: f32,
    measured_before: [f32; 2],
    power: [f32; NB],
    slack: Slack,
    z: [f32; 2],
    valid: bool,
}

/// Largest sums, as shares of the limits.
struct Charted {
    fast: f32,
    slow: f32,
}

impl Watch {
    pub(super) fn start(&self, trained: Trained, tick: u32) -> WatchState {
        WatchState {
            lead: trained.models.lead(),
            brisk: Briskness::new(&trained.models),
            mean: trained.normal.map(|normal| normal.mean),
            past: Default::default(),
            past_clipped: Default::default(),
            fast: Default::default(),
            slow: Sums::default(),
            slow_onset: tick,
            weakness: WeaknessState::new(trained.rise),
            bank: Bank::default(),
            measured: [trained.rise; 2],
            levels: Levels::default(),
            sagging: 0,
            alarm: None,
            heat: HeatState::new(trained.rise),
            apart: false,
            expected: [trained.rise; 2],
            trained,
        }
    }

    /// Takes in a tick: rises and ambient temperature where valid, rises over the room that is believed, and the power applied
    /// from now on, %.
    pub(super) fn step(
        &self,
        s: &mut WatchState,
        tick: u32,
        y: [Option<f32>; 2],
        t0: Option<f32>,
        believed: [Option<f32>; 2],
        u: f32,
    ) -> Option<Option<Finding>> {
        let mut now = self.residuals(s, tick, y, t0, u);
        let charted = self.chart(s, &mut now);
        self.explain(s, &now, &charted);
        if let Some(e2) = now.e[1] {
            self.heat.correct(&mut s.heat, e2, s.trained.models.along.gain());
        }
        self.warm(s, believed, now.expected, true);
        s.apart = now.valid && s.heat.apart() > APART;
        if s.alarm.is_none() {
            self.decide(s, &now, &charted);
        }
        let told = self.follow_alarm(s, &now)?;
        Some(told.and_then(|told| self.heat.review(&s.heat, told, tick)))
    }

    /// Keeps the models going while the instrument does not watch by them: `y1` is the rise of T1 over the room that T0 says.
    pub(super) fn idle(
        &self,
        s: &mut WatchState,
        y1: Option<f32>,
        believed: [Option<f32>; 2],
        u: f32,
        heating: bool,
    ) {
        s.alarm = None;
        s.rest();
        let y1 = y1.unwrap_or(s.trained.simulations.y1.y[0]);
        let [y1, y2, _] = s.trained.models.step(&mut s.trained.simulations, y1, u);
        self.warm(s, believed, [y1, y2], heating);
    }

    /// Tells the heat what is measured and expected now.
    fn warm(&self, s: &mut WatchState, believed: [Option<f32>; 2], expected: [f32; 2], heating: bool) {
        let rise = |m: usize| Some(Rise { measured: believed[m]?, expected: expected[m] });
        self.heat.step(&mut s.heat, [rise(0), rise(1)], heating);
        s.expected = expected;
    }

    /// Simulates, and compares with what was measured.
    fn residuals(&self, s: &mut WatchState, tick: u32, y: [Option<f32>; 2], t0: Option<f32>, u: f32) -> Now {
        let Trained { models, simulations, normal, .. } = &mut s.trained;
        let (y1_before, y1_expected) = (simulations.y1.y[1], simulations.y1.y[0]);
        let power = simulations.y1.u;
        let slack = self.weakness.step(&mut s.weakness, y1_expected, t0, normal);
        // A spike of T1 would otherwise ring in what is expected of T2.
        let likely = y1_expected + s.mean[0] + normal[0].whitener.expected(&s.past_clipped[0]);
        let reach = CLIP * normal[0].whitener.sigma() * (1.0 + slack.model[0]);
        let y1_clipped = y[0].map_or(likely, |y1| likely + bounded(y1 - likely, -reach, reach));
        let [_, y2_expected, along] = models.step(simulations, y1_clipped, u);
        let expected = [y1_expected, y2_expected];
        let seen = core::array::from_fn(|m| y[m].unwrap_or(expected[m]));
        let e = [
            y[0].map(|y1| y1 - y1_expected - s.mean[0]),
            y[1].map(|y2| y2 - y2_expected - s.mean[1]),
            y[0].and(y[1]).map(|y2| y2 - along - s.mean[2]),
        ];
        Now {
            tick,
            e,
            expected,
            y1_before,
            measured_before: core::mem::replace(&mut s.measured, seen),
            power,
            slack,
            z: [0.0; 2],
            valid: e[2].is_some(),
        }
    }

    /// Whitens the residuals and feeds the charts; those of a missing sample stand still.
    fn chart(&self, s: &mut WatchState, now: &mut Now) -> Charted {
        let mut charted = Charted { fast: 0.0, slow: 0.0 };
        for m in 0..3 {
            let whitener = &s.trained.normal[m].whitener;
            let Some(e) = now.e[m] else {
                whitener.skip(&mut s.past[m]);
                whitener.skip(&mut s.past_clipped[m]);
                continue;
            };
            let z = whitener.step(&mut s.past[m], e);
            let clipped = whitener.step_clipped(&mut s.past_clipped[m], e, CLIP);
            if m < 2 {
                now.z[m] = z;
            }
            charted.fast = larger(charted.fast, self.fast.step(&mut s.fast[m], clipped, now.slack.all[m]));
            if m == 2 {
                charted.slow = self.slow.step(&mut s.slow, clipped, now.slack.all[m]) / self.slow.limit;
                s.slow_onset = if charted.slow > 0.0 { s.slow_onset } else { now.tick };
            }
            s.levels.residual[m] += LEVEL_SHARE * (e - s.levels.residual[m]);
        }
        charted.fast /= self.fast.limit;
        if let Some(e) = now.e[0] {
            let drive = e + dot(&s.trained.models.heat.a, &s.levels.past);
            s.levels.drive += LEVEL_SHARE * (drive - s.levels.drive);
            shift(&mut s.levels.past, e);
        }
        charted
    }

    /// Lets the means follow while nothing stirs, and the bank gather while something does.
    fn explain(&self, s: &mut WatchState, now: &Now, charted: &Charted) {
        if !now.valid {
            return;
        }
        let near_zero = charted.fast * self.fast.limit < NEAR_ZERO;
        if s.alarm.is_none() {
            if larger(charted.fast, charted.slow) < STIRRED {
                for (mean, e) in s.mean.iter_mut().zip(&now.e) {
                    *mean += self.mean_share * e.unwrap_or(0.0);
                }
            }
            let energy = now.z[0] * now.z[0] + now.z[1] * now.z[1];
            if near_zero || energy > OUTSHINES * s.bank.energy() {
                s.bank.restart(now.tick.saturating_sub(s.slow_onset));
            }
        }
        if s.alarm.is_some() || !near_zero {
            let widest = larger(now.slack.model[0], now.slack.model[1]);
            let moment = Moment {
                models: &s.trained.models,
                normal: &s.trained.normal,
                brisk: s.brisk,
                lead: s.lead,
                z: now.z,
                weight: 1.0 / ((1.0 + widest) * (1.0 + widest)),
                power: &now.power,
                expected: [now.expected[0] + s.mean[0], now.expected[1] + s.mean[1]],
                expected_before: now.y1_before + s.mean[0],
                measured_before: now.measured_before,
            };
            self.filters.step(&mut s.bank, &moment);
        }
    }

    /// Raises the alarm, unless a sag of the power that is tolerated explains what the fast charts say.
    fn decide(&self, s: &mut WatchState, now: &Now, charted: &Charted) {
        if charted.fast > 1.0 {
            let weighed = Weighed::new(&s.bank, self.sample_time);
            if self.means_in_reach(s, now) && weighed.is_sag(&s.bank, self.tolerated_sag) {
                s.sagging += 1;
                if s.sagging as f32 * self.sample_time > SAG_TIME {
                    self.accept_sag(s, now);
                }
                return;
            }
            s.alarm = Some(Alarm::new(now.tick.saturating_sub(s.bank.age.saturating_sub(1))));
        } else if charted.slow > 1.0 && s.sagging == 0 {
            s.bank.restart(now.tick.saturating_sub(s.slow_onset));
            s.alarm = Some(Alarm::new(s.slow_onset));
        }
        s.sagging = 0;
    }

    fn means_in_reach(&self, s: &WatchState, now: &Now) -> bool {
        (0..2).all(|m| {
            let carried = s.mean[m] + s.levels.residual[m] - s.trained.normal[m].mean;
            carried.abs() < 1.5 * self.tolerated_sag * now.expected[m].abs() + MEAN_REACH
        })
    }

    /// Takes a lasting sag into the means, as if it had always been so.
    fn accept_sag(&self, s: &mut WatchState, now: &Now) {
        let share = s.bank.power.best((-self.tolerated_sag, self.tolerated_sag));
        for m in 0..2 {
            let change = share * now.expected[m];
            s.mean[m] += change;
            s.levels.residual[m] -= change;
            s.past[m].lower(change);
            s.past_clipped[m].lower(change);
        }
        s.rest();
    }

    /// Names the fault while it lasts; clears the alarm when it has gone.
    fn follow_alarm(&self, s: &mut WatchState, now: &Now) -> Option<Option<Finding>> {
        let alarm = s.alarm.as_mut()?;
        let normal = &s.trained.normal;
        let weighed = Weighed::new(&s.bank, self.sample_time);
        let slow = larger(normal[0].slow_sd, normal[1].slow_sd);
        let finding = self.rules.name(alarm, &weighed, slow, now.expected[0]);
        if self.rules.is_over(alarm, &s.levels, normal, now.valid) {
            s.weakness.fault_ended(s.levels.residual);
            s.alarm = None;
            s.rest();
        }
        Some(finding)
    }
}

impl WatchState {
    /// Charts and bank as if nothing had happened.
    fn rest(&mut self) {
        self.fast = Default::default();
        self.slow = Sums::default();
        self.bank.restart(0);
        self.sagging = 0;
    }

    /// What T1 will be above the room on the next tick, by the models and T2, degC; None where they disagree, or T1 and
    /// T2 do.
    pub(super) fn stand_in(&self) -> Option<f32> {
        if self.apart {
            return None;
        }
        self.heat.stand_in(self.trained.simulations.y1.y[0] + self.mean[0])
    }

    /// Air flow and heater, as the heat shows them.
    pub(super) fn heat(&self) -> &HeatState {
        &self.heat
    }

    /// What T1 and T2 should be above the room now, degC.
    pub(super) fn expected(&self) -> [f32; 2] {
        [self.expected[0] + self.mean[0], self.expected[1] + self.mean[1]]
    }
}
