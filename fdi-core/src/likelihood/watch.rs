//! The watch over a trained rig: residuals of frozen models, charts on them, the bank that explains what the charts find.
//!
//! While nothing is wrong the means of the residuals follow slow change; they are frozen as soon as a chart stirs. The
//! bank starts anew whenever all fast charts are near zero, so that when one fires, it has gathered since the onset.

use super::alarm::{Alarm, ModelAlarm, Rules};
use super::bank::{Bank, BankInput, Filters, ResponseTime};
use super::chart::{Chart, Sums};
use super::fit::NB;
use super::heat::{Heat, HeatState, Rise};
use super::levels::Levels;
use super::model_error::{ErrorBound, ModelError, ModelErrorState};
use super::ranking::Ranking;
use super::training::Trained;
use super::whitening::Past;
use crate::bounds::{bounded, larger};
use crate::filter::LowPass;

// Tuned on seeds 1 to 99999, lively, unless a section says more (docs/diagnosis.md, sections 3, 6, 7 and 12).
/// Charts and the simulation of y2 from y1 see no more of an innovation than so many standard deviations: a spike counts once.
const CLIP: f32 = 6.0;
/// The means of the residuals follow while all charts are below this share of their decision interval.
const MEANS_FOLLOW_BELOW: f32 = 0.4;
/// The bank starts anew while all fast charts are below this sum, standard deviations.
const BANK_RESTARTS_BELOW: f32 = 1.0;
/// A tick whose evidence exceeds so many times all before it is the onset, and the bank starts anew with it.
const ONSET_EVIDENCE: f32 = 4.0;
/// A sag that lasts so long is taken into the means, s.
const SAG_TIME: f32 = 3.0;
/// How far sags may carry the means from where they were trained: tolerated sags, and degC on top.
const MEAN_TRAVEL_SAGS: f32 = 1.5;
const MEAN_TRAVEL: f32 = 0.25;
/// A valid T1 and T2 whose difference is so much other than learnt contradict each other, degC: neither is regulated by.
const MAX_CONTRADICTION: f32 = 6.0;

/// A validated watch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watch {
    pub(super) fast: Chart,
    pub(super) slow: Chart,
    pub(super) model_error: ModelError,
    pub(super) filters: Filters,
    pub(super) heat: Heat,
    pub(super) rules: Rules,
    /// With which the means of the residuals follow.
    pub(super) mean: LowPass,
    pub(super) tolerated_sag: f32,
    pub(super) sample_time: f32,
}

/// Its memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct WatchState {
    trained: Trained,
    dead_ticks: usize,
    response: ResponseTime,
    /// Means of the residuals of y1, y2 and y2 from y1, degC.
    mean: [f32; 3],
    past: [Past; 3],
    past_clipped: [Past; 3],
    fast: [Sums; 3],
    slow: Sums,
    /// Last tick on which the slow chart was at zero.
    slow_onset: u32,
    model_error: ModelErrorState,
    bank: Bank,
    measured: [f32; 2],
    levels: Levels,
    /// Ticks for which a sag has explained what the charts say.
    sagging: u32,
    alarm: Option<Alarm>,
    heat: HeatState,
    /// T1 and T2, both valid, contradict each other.
    contradict: bool,
    /// What the models say y1 and y2 should be now.
    expected: [f32; 2],
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
    bound: ErrorBound,
    z: [f32; 2],
    valid: bool,
}

/// Largest sums, as shares of the decision intervals.
struct Charted {
    fast: f32,
    slow: f32,
}

impl WatchState {
    /// Static gain from the power to T1, degC per %.
    pub(super) fn gain(&self) -> f32 {
        self.trained.models.heater_to_t1.gain()
    }
}

impl Watch {
    pub(super) fn start(&self, trained: Trained, tick: u32) -> WatchState {
        WatchState {
            dead_ticks: trained.models.dead_ticks(),
            response: ResponseTime::new(&trained.models),
            mean: trained.noise.map(|noise| noise.mean),
            past: Default::default(),
            past_clipped: Default::default(),
            fast: Default::default(),
            slow: Sums::default(),
            slow_onset: tick,
            model_error: ModelErrorState::new(trained.rise),
            bank: Bank::default(),
            measured: [trained.rise; 2],
            levels: Levels::default(),
            sagging: 0,
            alarm: None,
            heat: HeatState::new(trained.rise),
            contradict: false,
            expected: [trained.rise; 2],
            trained,
        }
    }

    /// What the models say of a tick: rises and ambient temperature where valid, rises over the ambient that is believed, degC, and the
    /// power applied from now on, %.
    pub(super) fn step(
        &self,
        s: &mut WatchState,
        tick: u32,
        y: [Option<f32>; 2],
        t0: Option<f32>,
        believed: [Option<f32>; 2],
        u: f32,
    ) -> ModelAlarm {
        let mut now = self.residuals(s, tick, y, t0, u);
        let charted = self.chart(s, &mut now);
        self.explain(s, &now, &charted);
        if let Some(e2) = now.e[1] {
            self.heat.correct(&mut s.heat, e2, s.trained.models.t1_to_t2.gain());
        }
        self.follow_rises(s, believed, now.expected, true);
        s.contradict = now.valid && s.heat.contradiction() > MAX_CONTRADICTION;
        if s.alarm.is_none() {
            self.decide(s, &now, &charted);
        }
        match self.follow_alarm(s, &now) {
            ModelAlarm::Named(finding) => self.heat.review(&s.heat, finding, tick),
            unnamed => unnamed,
        }
    }

    /// Keeps the models going while the instrument does not watch by them: `y1` is the rise of T1 over T0, degC.
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
        self.follow_rises(s, believed, [y1, y2], heating);
    }

    /// Holds the measured rises against the expected ones.
    fn follow_rises(
        &self,
        s: &mut WatchState,
        believed: [Option<f32>; 2],
        expected: [f32; 2],
        heating: bool,
    ) {
        let rise = |m: usize| Some(Rise { measured: believed[m]?, expected: expected[m] });
        self.heat.step(&mut s.heat, [rise(0), rise(1)], heating);
        s.expected = expected;
    }

    /// Simulates, and compares with what was measured.
    fn residuals(&self, s: &mut WatchState, tick: u32, y: [Option<f32>; 2], t0: Option<f32>, u: f32) -> Now {
        let Trained { models, simulations, noise, .. } = &mut s.trained;
        let (y1_before, y1_expected) = (simulations.y1.y[1], simulations.y1.y[0]);
        let power = simulations.y1.u;
        let bound = self.model_error.step(&mut s.model_error, y1_expected, t0, noise);
        // A spike of T1 would otherwise ring in what is expected of T2.
        let likely = y1_expected + s.mean[0] + noise[0].whitener.expected(&s.past_clipped[0]);
        let reach = CLIP * noise[0].whitener.sigma() * (1.0 + bound.model[0]);
        let y1_clipped = y[0].map_or(likely, |y1| likely + bounded(y1 - likely, -reach, reach));
        let [_, y2_expected, y2_of_y1] = models.step(simulations, y1_clipped, u);
        let expected = [y1_expected, y2_expected];
        let seen = core::array::from_fn(|m| y[m].unwrap_or(expected[m]));
        let e = [
            y[0].map(|y1| y1 - y1_expected - s.mean[0]),
            y[1].map(|y2| y2 - y2_expected - s.mean[1]),
            y[0].and(y[1]).map(|y2| y2 - y2_of_y1 - s.mean[2]),
        ];
        Now {
            tick,
            e,
            expected,
            y1_before,
            measured_before: core::mem::replace(&mut s.measured, seen),
            power,
            bound,
            z: [0.0; 2],
            valid: e[2].is_some(),
        }
    }

    /// Whitens the residuals and feeds the charts; those of a missing sample stand still.
    fn chart(&self, s: &mut WatchState, now: &mut Now) -> Charted {
        let mut charted = Charted { fast: 0.0, slow: 0.0 };
        for m in 0..3 {
            let whitener = &s.trained.noise[m].whitener;
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
            charted.fast = larger(charted.fast, self.fast.step(&mut s.fast[m], clipped, now.bound.all[m]));
            if m == 2 {
                charted.slow = self.slow.step(&mut s.slow, clipped, now.bound.all[m]) / self.slow.interval;
                s.slow_onset = if charted.slow > 0.0 { s.slow_onset } else { now.tick };
            }
        }
        charted.fast /= self.fast.interval;
        s.levels.step(&now.e, &s.trained.models.heater_to_t1.a);
        charted
    }

    /// Lets the means follow while all charts are low, and the bank gather while one is not.
    fn explain(&self, s: &mut WatchState, now: &Now, charted: &Charted) {
        if !now.valid {
            return;
        }
        let all_low = charted.fast * self.fast.interval < BANK_RESTARTS_BELOW;
        if s.alarm.is_none() {
            if larger(charted.fast, charted.slow) < MEANS_FOLLOW_BELOW {
                for (mean, e) in s.mean.iter_mut().zip(&now.e) {
                    *mean += self.mean.share() * e.unwrap_or(0.0); // e is what is left of it
                }
            }
            let energy = now.z[0] * now.z[0] + now.z[1] * now.z[1];
            if all_low || energy > ONSET_EVIDENCE * s.bank.energy() {
                s.bank.restart(now.tick.saturating_sub(s.slow_onset));
            }
        }
        if s.alarm.is_some() || !all_low {
            let widest = larger(now.bound.model[0], now.bound.model[1]);
            let input = BankInput {
                models: &s.trained.models,
                noise: &s.trained.noise,
                response: s.response,
                dead_ticks: s.dead_ticks,
                z: now.z,
                weight: 1.0 / ((1.0 + widest) * (1.0 + widest)),
                power: &now.power,
                expected: [now.expected[0] + s.mean[0], now.expected[1] + s.mean[1]],
                expected_before: now.y1_before + s.mean[0],
                measured_before: now.measured_before,
            };
            self.filters.step(&mut s.bank, &input);
        }
    }

    /// Raises the alarm, unless a sag of the power that is tolerated explains what the fast charts say.
    fn decide(&self, s: &mut WatchState, now: &Now, charted: &Charted) {
        if charted.fast > 1.0 {
            let ranking = Ranking::new(&s.bank, self.sample_time);
            if self.means_in_reach(s, now) && ranking.is_sag(&s.bank, self.tolerated_sag) {
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
            let carried = s.mean[m] + s.levels.residual[m] - s.trained.noise[m].mean;
            carried.abs() < MEAN_TRAVEL_SAGS * self.tolerated_sag * now.expected[m].abs() + MEAN_TRAVEL
        })
    }

    /// Takes a lasting sag into the means, as if it had always been so.
    fn accept_sag(&self, s: &mut WatchState, now: &Now) {
        let share = s.bank.power().best((-self.tolerated_sag, self.tolerated_sag));
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
    fn follow_alarm(&self, s: &mut WatchState, now: &Now) -> ModelAlarm {
        let Some(alarm) = s.alarm.as_mut() else { return ModelAlarm::Quiet };
        let noise = &s.trained.noise;
        let ranking = Ranking::new(&s.bank, self.sample_time);
        let slow_sd = larger(noise[0].slow_sd, noise[1].slow_sd);
        let named = self.rules.name(alarm, &ranking, slow_sd, now.expected[0]);
        if self.rules.is_over(alarm, &s.levels, noise, now.valid) {
            s.model_error.fault_ended(s.levels.residual);
            s.alarm = None;
            s.rest();
        }
        named
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

    /// The virtual T1: its rise over the ambient on the next tick by the models and T2, degC; None where they disagree, or T1 and T2 do.
    pub(super) fn virtual_t1(&self) -> Option<f32> {
        if self.contradict {
            return None;
        }
        self.heat.virtual_t1(self.trained.simulations.y1.y[0] + self.mean[0])
    }

    /// Air flow and heater, as the heat shows them.
    pub(super) fn heat(&self) -> &HeatState {
        &self.heat
    }

    /// What T1 and T2 should be above the ambient now, degC.
    pub(super) fn expected(&self) -> [f32; 2] {
        [self.expected[0] + self.mean[0], self.expected[1] + self.mean[1]]
    }
}
