//! The watch over a trained rig, a stage after the other:
//!
//! ```text
//! Input -> simulation -> tracker -> innovations -> charts -> bank since an onset -> Said
//!               |                        |                   bank since training ---^
//!               '-> rises held against those expected (heat.rs) --------------------^
//! ```
//!
//! While nothing stirs, the tracker follows slow change, and the bank since an onset begins anew on every tick. When a chart fires, that bank has
//! gathered since the onset and asks which fault explains what is seen. The bank since training holds the last minute against the trained state.
//!
//! Each stage keeps its own state, which no other writes.

mod charts;
mod facts;
mod innovations;
mod returned;
mod simulation;
mod since_onset;
mod since_training;
mod steady;
#[cfg(test)]
pub(in crate::likelihood) mod tests;
mod times;

use super::alarm::Said;
use super::config::LikelihoodConfig;
use super::heat::{Heat, HeatState, Rise};
use super::inputs::Inputs;
use super::model::Model;
use super::regressor::{LASTING, Regressors};
use super::start::{Begun, Start};
use super::tracker::Tracker;
use super::training::Trained;
use super::tuning::Tuned;
use crate::bounds::{bounded, larger};
use crate::likelihood::chart::Chart;
use charts::{Charts, ChartsState};
use innovations::InnovationsState;
use returned::{Returned, ReturnedState};
use simulation::{Simulated, Simulation, SimulationState};
pub(super) use since_onset::SinceOnsetState;
use since_onset::{Outcome, SinceOnset};
use since_training::{SinceTraining, SinceTrainingState};
use times::Times;

/// A validated watch.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    simulation: Simulation,
    charts: Charts,
    since_onset: SinceOnset,
    since_training: SinceTraining,
    returned: Returned,
    heat: Heat,
    sample_time: f32,
    inputs: Inputs,
    tuning: Tuned,
}

/// Its memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct WatchState {
    times: Times,
    simulation: SimulationState,
    tracker: Tracker,
    innovations: InnovationsState,
    charts: ChartsState,
    since_training: SinceTrainingState,
    returned: ReturnedState,
    heat: HeatState,
    /// Standard deviation of how the gain grows with the power.
    curvature_error: f32,
    /// Rises that were measured on the last tick with both, degC.
    measured: [f32; 2],
    pub(super) tuning: Tuned,
}

/// A tick as the models see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Input {
    pub(super) tick: u32,
    /// Rises of T1 and T2 over T0, and over the ambient that is believed, where known, degC.
    pub(super) y: [Option<f32>; 2],
    pub(super) believed: [Option<f32>; 2],
    pub(super) t0: Option<f32>,
    /// What drives the heater from now on, as at the nominal supply, and a second heater beside T1's own, %.
    pub(super) power: f32,
    pub(super) second_power: f32,
    /// Level of the fan as announced, share of that at which the rig is learnt; 1 where nothing was.
    pub(super) fan: f32,
}

impl Watch {
    pub(super) fn new(c: &LikelihoodConfig, tuning: Tuned, sample_time: f32, answer_time: f32) -> Self {
        let inputs = Inputs::ALL;
        Self {
            simulation: Simulation { inputs, tuning },
            charts: Charts {
                fast: Chart { allowance: c.fast_allowance, interval: c.fast_interval },
                slow: Chart { allowance: c.slow_allowance, interval: c.slow_interval },
                model_uncertainty: c.model_uncertainty,
                tuning,
            },
            since_onset: SinceOnset {
                naming: c.naming,
                least_power: c.least_power,
                sample_time,
                inputs,
                taught: c.taught.clone(),
                tuning,
            },
            since_training: SinceTraining { least_power: c.least_power, sample_time, inputs, tuning },
            returned: Returned { least_power: c.least_power, sample_time, inputs, tuning },
            heat: Heat::new(tuning, sample_time, answer_time),
            sample_time,
            inputs,
            tuning,
        }
    }

    /// The same for a rig that lacks some inputs.
    pub(super) fn with(mut self, inputs: Inputs) -> Self {
        self.inputs = inputs;
        self.simulation.inputs = inputs;
        self.since_onset.inputs = inputs;
        self.since_training.inputs = inputs;
        self.returned.inputs = inputs;
        self
    }

    pub(super) fn start(&self, trained: &Trained) -> WatchState {
        let t = self.tuning;
        WatchState {
            times: Times::new(t, trained, self.inputs, self.sample_time),
            simulation: self.simulation.start(trained),
            tracker: Tracker::new(t),
            innovations: InnovationsState::new(t, trained.whitening),
            charts: ChartsState::new(trained.rise),
            since_training: SinceTrainingState::new(t),
            returned: ReturnedState::default(),
            heat: HeatState::new(t, trained.rise),
            curvature_error: trained.curvature_error,
            measured: [trained.rise; 2],
            tuning: t,
        }
    }

    /// Another recording of the same rig begins, long after its power was last changed.
    pub(super) fn resume(&self, s: &mut WatchState, power: f32, fan: f32, second_power: f32) {
        self.simulation.resume(&mut s.simulation, power, fan, second_power);
        self.begin_anew(s);
    }

    /// What has to be found of how the rig began.
    pub(super) fn begins(&self, s: &WatchState, is_long: bool) -> Start {
        self.simulation.begins(&s.simulation, *s.innovations.filter(), is_long)
    }

    /// How the rig began has been found.
    pub(super) fn settle(&self, s: &mut WatchState, begun: &Begun) {
        self.simulation.settle(&mut s.simulation, begun);
        self.begin_anew(s);
    }

    /// All is as trained from another state on, which has been found.
    pub(super) fn return_to(&self, s: &mut WatchState, state: &Begun) {
        self.simulation.settle(&mut s.simulation, state);
        self.begin_residuals_anew(s);
        s.since_training.forget([0.0; 2]);
    }

    /// Nothing of what has been seen so far counts for what is seen from now on.
    fn begin_anew(&self, s: &mut WatchState) {
        self.begin_residuals_anew(s);
        s.since_training.resume();
    }

    fn begin_residuals_anew(&self, s: &mut WatchState) {
        s.tracker.resume();
        s.innovations.resume();
        s.charts.resume(s.simulation.rise_of_t1());
    }

    /// One tick while the instrument watches.
    pub(super) fn step(&self, s: &mut WatchState, onset: &mut SinceOnsetState, now: &Input) -> Said {
        if self.follow_fan(s, now.fan) {
            onset.begin_anew();
        }
        let simulated = self.simulation.step(&mut s.simulation, &s.times, now);
        let y = self.follow_rises(s, &simulated, now, true);
        // Without T1 above all: what is regulated by then must not leave T2.
        if let Some(y2) = y[1] {
            self.heat.correct(&mut s.heat, y2 - simulated.expected[1], s.simulation.reaches());
        }
        s.heat.compare(y.iter().all(Option::is_some));
        if let [Some(y1), Some(y2)] = y {
            let e = [y1 - simulated.expected[0], y2 - simulated.expected[1]];
            if s.simulation.is_beginning() {
                return Said::default();
            }
            self.judge(s, onset, now.tick, e, &simulated);
            s.measured = s.simulation.as_rises([y1, y2]);
        } else {
            let nominal = s.simulation.nominal(&simulated);
            self.since_onset.pass(onset, &s.times, s.innovations.filter(), &nominal);
        }
        self.said(s, onset, now.tick)
    }

    /// One tick while the instrument does not watch: the models keep going.
    pub(super) fn idle(&self, s: &mut WatchState, now: &Input, heating: bool) {
        self.follow_fan(s, now.fan);
        s.since_training.quieten();
        s.charts.reset();
        let simulated = self.simulation.step(&mut s.simulation, &s.times, now);
        self.follow_rises(s, &simulated, now, heating);
    }

    /// Residuals `e` in degC, through all stages.
    fn judge(
        &self,
        s: &mut WatchState,
        onset: &mut SinceOnsetState,
        tick: u32,
        e: [f32; 2],
        now: &Simulated,
    ) {
        let t = &self.tuning;
        let followed = s.tracker.expected(&now.regressors);
        let left = [e[0] - followed[0], e[1] - followed[1]];
        let widened = self.charts.widened(&mut s.charts, &s.times, s.innovations.filter(), now.expected[0]);
        let innovations = s.innovations.step(left, e, widened);
        let mut whitened = [[0.0; 2]; LASTING];
        s.innovations.whiten(&now.regressors, &mut whitened);
        let inlet = s.simulation.inlet_above();
        let filter = s.innovations.filter();
        let charted = self.charts.step(&mut s.charts, &s.times, filter, &innovations, widened, inlet);
        let outcome = self.since_onset.step(
            onset,
            &since_onset::Seen {
                tick,
                times: &s.times,
                simulated: now,
                nominal: &s.simulation.nominal(now),
                filter,
                innovations: &innovations,
                charted: &charted,
                usual: &s.usual(),
                measured: s.measured,
            },
        );
        self.carry_out(s, onset, outcome, e, &now.regressors);
        self.follow_return(s, onset, &whitened, innovations.z_trained, e, now);
        let settling = s.charts.end_tick();
        if onset.said().is_some() {
            return;
        }
        if s.since_training.said().is_none() {
            s.tracker.remember(&s.times.walk);
        }
        let asks = larger(charted.fast, charted.slow);
        if settling || asks < t.tracker.below {
            let z = innovations.z.map(|z| bounded(z, -t.charts.clip, t.charts.clip));
            s.tracker.step(&whitened, z);
        }
        // While a chart asks, something begins, of which the last minute knows nothing.
        if s.charts.is_charting()
            && !settling
            && asks <= 1.0
            && self.charts.is_calm(&s.charts)
            && innovations.gathered
        {
            let usual = s.usual();
            let passed = self.since_training.step(
                &mut s.since_training,
                &since_training::Seen {
                    tick,
                    times: &s.times,
                    e,
                    expected: now.expected[0],
                    regressors: &now.regressors,
                    whitened: &whitened,
                    z: innovations.z_trained,
                    usual: &usual,
                },
            );
            if let Some((quantity, size)) = passed {
                s.tracker.learn(quantity, size);
            }
        }
    }

    /// What the bank since an onset has found out, told to the other stages.
    fn carry_out(
        &self,
        s: &mut WatchState,
        onset: &mut SinceOnsetState,
        outcome: Outcome,
        e: [f32; 2],
        regressors: &Regressors<LASTING>,
    ) {
        let t = &self.tuning;
        let change = match outcome {
            Outcome::Nothing => return,
            Outcome::Over => {
                s.charts.hold_off(s.times.ticks(t.times.reference, self.sample_time));
                return;
            }
            Outcome::Usual(values) => {
                s.charts.reset();
                s.since_training.gather_anew(e);
                s.tracker.take_over(values, regressors)
            }
            Outcome::SensorRecovered(change) => {
                onset.end_recovered();
                s.charts.hold_off(t.charts.first as u32);
                change
            }
            // What the power did lately the rig still has: the model goes on from there.
            Outcome::PowerRecovered(theta) => {
                let (since, until) = onset.power_motions();
                let change = s.simulation.take_over(theta, since, until);
                onset.end_recovered();
                s.charts.hold_off(t.charts.first as u32);
                change
            }
        };
        s.innovations.lower(change);
    }

    /// Follows an announced change of the fan. What is known of such a change is its kind, hardly its size: for a while nothing is judged, and the state
    /// since training is taken anew from there.
    fn follow_fan(&self, s: &mut WatchState, fan: f32) -> bool {
        let Some(left) = self.simulation.follow_fan(&mut s.simulation, &s.times, fan) else { return false };
        // The kind of the change is known, hardly its size.
        let t = self.tuning;
        s.tracker.widen([t.nuisances.onset_power, t.hypotheses.flow_sd * left.abs(), 0.0, 0.0]);
        s.since_training.rebase();
        s.charts.settle(s.times.ticks(t.times.forgetting, self.sample_time));
        true
    }

    /// Holds the measured rises against the expected ones; gives what T1's own heater has of those over T0, degC.
    fn follow_rises(
        &self,
        s: &mut WatchState,
        simulated: &Simulated,
        now: &Input,
        heating: bool,
    ) -> [Option<f32>; 2] {
        let own = |rises: [Option<f32>; 2]| rises.map(|rise| Some(rise? - simulated.added));
        let (y, believed, expected) = (own(now.y), own(now.believed), simulated.expected);
        let rise = |m: usize| Some(Rise { measured: believed[m]?, expected: expected[m] });
        self.heat.step(&mut s.heat, [rise(0), rise(1)], heating);
        y
    }

    fn said(&self, s: &WatchState, onset: &SinceOnsetState, tick: u32) -> Said {
        let said =
            Said { since_onset: onset.said(), since_training: s.since_training.said(), ..Said::default() };
        let Some(finding) = said.by_models() else { return said };
        Said {
            by_rises: s.heat.detached(finding.onset),
            moves: self.heat.moves(&s.heat, finding.onset, tick),
            ..said
        }
    }

    /// What was learnt.
    pub(super) fn model(&self, s: &WatchState) -> Model {
        s.simulation.model(self.sample_time, s.innovations.filter().sigma)
    }
}
