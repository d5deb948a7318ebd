//! The watch over a trained rig: residuals of a frozen model, charts on them, and the banks that explain what the charts find.
//!
//! While nothing stirs, a tracker follows slow change, and all regressors begin anew on every tick; when a chart fires, they have gathered since
//! the onset. Beside that the state is held against the trained one, over a minute.

use super::alarm::{Alarm, ModelAlarm};
use super::chart::{Chart, Sums};
use super::heat::{Heat, HeatState, Rise};
use super::inputs::Inputs;
use super::model::Model;
use super::normal::Normal;
use super::onset::{History, Nominal, Onset};
use super::process::{Motion, Parameter, Parameters, Process};
use super::recovery::Recovery;
use super::second_heater::SecondHeater;
use super::steady::Steady;
use super::taught::Responses;
use super::tracker::Tracker;
use super::training::Trained;
use super::tuning::Tuned;
use super::whitening::{Past, WhiteningFilter};
use lasting::Lasting;
use times::Times;

/// A validated watch.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    pub(super) fast: Chart,
    pub(super) slow: Chart,
    pub(super) heat: Heat,
    pub(super) model_uncertainty: f32,
    pub(super) naming: f32,
    pub(super) least_power: f32,
    pub(super) sample_time: f32,
    pub(super) inputs: Inputs,
    pub(super) taught: Responses,
    pub(super) tuning: Tuned,
}

/// Its memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct WatchState {
    parameters: Parameters,
    beside: SecondHeater,
    /// The fan's level as announced, behind its lag, and the model there.
    fan: f32,
    process: Process,
    flows: [Process; 2],
    motion: Motion,
    whitening: WhiteningFilter,
    mean: [f32; 2],
    times: Times,
    power: f32,
    before: [f32; 2],
    history: History,
    past: Past,
    past_clipped: Past,
    tracker: Tracker,
    /// Mean squares of what the tracker has followed, and of the steps of the power that were taken in.
    walk_variance: [f32; 4],
    steps: f32,
    fast: [Sums; 2],
    slow: Sums,
    swing: [f32; 2],
    /// Rise of T1 at which training took place, degC, and standard deviation of how the gain grows with the power from there.
    trained: f32,
    curvature_error: f32,
    /// T0 and its mean, and what its motion may have been at T1 and at T2, degC.
    inlet: Option<(f32, f32, [f32; 2])>,
    z_mean: [f32; 2],
    /// What jumped on the tick before, standard deviations; 0 where nothing did.
    jumped: [f32; 2],
    candidate: f32,
    holdoff: u32,
    /// Ticks for which a change of the fan settles.
    settling: u32,
    ticks: u32,
    /// The rig lacks some of the trainer's inputs.
    lacks: bool,
    /// Ticks that the intercept is still taken from.
    anchoring: u32,
    alarm: Option<Alarm>,
    steady: Steady,
    lasting: Option<Lasting>,
    heat: HeatState,
    measured: [f32; 2],
    at_onset: [f32; 2],
    contradict: bool,
    expected: [f32; 2],
    pub(super) tuning: Tuned,
}

/// What has been gathered since the assumed onset: regressors, their sums, and those of late. It is needed only while the instrument watches.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Gathered {
    onset: Onset,
    since: Normal,
    window: Normal,
    recovery: Recovery,
    /// The whitened answer to the power since the onset, on the last tick.
    power_response: [f32; 2],
}

impl Gathered {
    /// Begins anew with the next tick that stirs.
    fn begin_anew(&mut self) {
        self.onset.age = 0;
        if self.since.count > 0.0 {
            self.since = Normal::default();
        }
    }
}

/// Largest sums, as shares of the decision intervals.
struct Charted {
    fast: f32,
    slow: f32,
}

impl WatchState {
    /// What was learnt.
    pub(super) fn model(&self, sample_time: f32) -> Model {
        let p = |which| self.parameters.get(which);
        let time = |which| sample_time * libm::expf(p(which));
        let (gain_beside, lag_beside) = self.beside.learnt();
        Model {
            gain: self.gain(),
            curvature: p(Parameter::Curvature),
            offset: p(Parameter::Offset1),
            heater: time(Parameter::Heater),
            lag: time(Parameter::Lag1),
            wall: time(Parameter::WallTime),
            dead_time: sample_time * p(Parameter::Delay1),
            wall_share: p(Parameter::Wall1),
            reaches: p(Parameter::Reaches2),
            lag2: time(Parameter::Lag2),
            transport: sample_time * p(Parameter::Delay2),
            gain_beside,
            lag_beside: sample_time * lag_beside,
            noise: self.whitening.sigma,
        }
    }

    /// Static gain from the power to T1, degC per %.
    pub(super) fn gain(&self) -> f32 {
        libm::expf(self.parameters.get(Parameter::Gain))
    }
}

impl Watch {
    pub(super) fn start(&self, trained: Trained) -> WatchState {
        let p = trained.parameters;
        let t = self.tuning;
        let process = Process::new(t, &p, 1.0);
        WatchState {
            parameters: p,
            beside: trained.beside,
            fan: 1.0,
            process,
            flows: [Process::new(t, &p, t.model.less_flow), Process::new(t, &p, t.model.more_flow)],
            motion: trained.motion,
            whitening: trained.whitening,
            mean: trained.mean,
            times: Times::new(t, &p, self.sample_time),
            power: trained.power,
            before: [trained.rise; 2],
            history: History::default(),
            past: Past::default(),
            past_clipped: Past::default(),
            tracker: Tracker::new(t),
            walk_variance: [0.0; 4],
            steps: t.nuisances.onset_power * t.nuisances.onset_power,
            fast: Default::default(),
            slow: Sums::default(),
            swing: [trained.rise, 0.0],
            trained: trained.rise,
            curvature_error: trained.curvature_error,
            inlet: None,
            z_mean: [0.0; 2],
            jumped: [0.0; 2],
            candidate: 0.0,
            holdoff: 0,
            settling: 0,
            ticks: 0,
            lacks: self.inputs != Inputs::ALL,
            anchoring: 0,
            alarm: None,
            steady: Steady::new(t, &trained.motion, trained.rise),
            lasting: None,
            heat: HeatState::new(t, trained.rise),
            measured: [trained.rise; 2],
            at_onset: [trained.rise; 2],
            contradict: false,
            expected: [trained.rise; 2],
            tuning: t,
        }
    }

    /// What the models say of a tick: rises over T0 and over the ambient that is believed, degC, and the power applied from now on, %, with
    /// the fan's level and the power of a heater beside.
    #[expect(clippy::too_many_arguments, reason = "a tick as all parts see it")]
    pub(super) fn step(
        &self,
        s: &mut WatchState,
        g: &mut Gathered,
        tick: u32,
        y: [Option<f32>; 2],
        t0: Option<f32>,
        believed: [Option<f32>; 2],
        [u, fan, beside]: [f32; 3],
    ) -> ModelAlarm {
        let added = s.beside.step(beside);
        let [y, believed] = [y, believed].map(|rises| rises.map(|rise| Some(rise? - added)));
        if self.follow_fan(s, fan) {
            g.begin_anew();
        }
        if let Some(t0) = t0 {
            let (before, mut mean, _) = s.inlet.unwrap_or((t0, t0, [0.0; 2]));
            let above = t0 - mean;
            s.times.inlet.follow(&mut mean, t0);
            s.inlet = Some((t0, mean, [self.tuning.model.inlet_slope * (t0 - before), above]));
        }
        let heat = s.process.heat(self.inputs.drove(&mut s.power, u));
        let before = s.before;
        let rises = s.process.step(&mut s.motion, heat);
        s.before = rises.y;
        let offsets = [s.parameters.get(Parameter::Offset1), s.parameters.get(Parameter::Offset2)];
        let expected: [f32; 2] = core::array::from_fn(|m| rises.y[m] + offsets[m] + s.mean[m]);
        s.expected = expected;
        self.follow_rises(s, believed, true);
        // Without T1 above all: what is regulated by then must not leave T2.
        if let Some(y2) = y[1] {
            self.heat.correct(&mut s.heat, y2 - expected[1], s.parameters.get(Parameter::Reaches2));
        }
        let row = s.steady.regressors(&s.flows, heat, &rises, before);
        let now = NowRises { heat, rises, before };
        let told = match y {
            [Some(y1), Some(y2)] => {
                let e = [y1 - expected[0], y2 - expected[1]];
                if s.anchors(e) {
                    return ModelAlarm::Quiet;
                }
                s.ticks = s.ticks.saturating_add(1);
                s.contradict = s.heat.contradiction() > self.tuning.charts.largest_contradiction;
                self.judge(s, g, tick, e, &row, &now);
                s.measured = [y1 - offsets[0] - s.mean[0], y2 - offsets[1] - s.mean[1]];
                s.reported(&self.heat, tick)
            }
            _ => {
                s.contradict = false;
                if g.onset.age > 0 {
                    g.onset.pass(&s.times.onset, &s.whitening, &s.nominal(&now));
                }
                s.reported(&self.heat, tick)
            }
        };
        s.history.push(heat, &s.motion);
        told
    }

    /// Keeps the models going while the instrument does not watch by them.
    pub(super) fn idle(
        &self,
        s: &mut WatchState,
        believed: [Option<f32>; 2],
        [u, fan, beside]: [f32; 3],
        heating: bool,
    ) {
        let added = s.beside.step(beside);
        let believed = believed.map(|rise| Some(rise? - added));
        self.follow_fan(s, fan);
        s.alarm = None;
        s.lasting = None;
        s.reset_charts();
        let heat = s.process.heat(self.inputs.drove(&mut s.power, u));
        let rises = s.process.step(&mut s.motion, heat);
        let before = core::mem::replace(&mut s.before, rises.y);
        s.steady.regressors(&s.flows, heat, &rises, before);
        s.history.push(heat, &s.motion);
        let offsets = [s.parameters.get(Parameter::Offset1), s.parameters.get(Parameter::Offset2)];
        s.expected = core::array::from_fn(|m| rises.y[m] + offsets[m] + s.mean[m]);
        self.follow_rises(s, believed, heating);
    }

    /// Follows an announced change of the fan, with its lag. What is known of such a change is its kind, hardly its size: for a while nothing is
    /// judged, and the state since training is taken anew from there.
    fn follow_fan(&self, s: &mut WatchState, fan: f32) -> bool {
        let (t, left) = (self.tuning, fan - s.fan);
        if left.abs() < t.fan.same {
            return false;
        }
        s.fan += left * s.times.onset.fan.min(1.0);
        if (fan - s.fan).abs() < t.fan.same {
            s.fan = fan;
        }
        s.process = Process::new(t, &s.parameters, s.fan);
        s.flows =
            [t.model.less_flow, t.model.more_flow].map(|flow| Process::new(t, &s.parameters, flow * s.fan));
        s.tracker.widen([t.fan.power_sd, t.fan.flow_sd * left.abs(), 0.0, 0.0]);
        s.steady.rebase();
        s.alarm = None;
        s.lasting = None;
        s.reset_charts();
        s.settling = (t.fan.settles * s.times.time_scale / self.sample_time) as u32;
        true
    }

    /// Holds the measured rises against the expected ones.
    fn follow_rises(&self, s: &mut WatchState, believed: [Option<f32>; 2], heating: bool) {
        let rise = |m: usize| Some(Rise { measured: believed[m]?, expected: s.expected[m] });
        self.heat.step(&mut s.heat, [rise(0), rise(1)], heating);
    }
}

/// Power and rises of this tick, and the rises before.
struct NowRises {
    heat: f32,
    rises: super::process::Rises,
    before: [f32; 2],
}

impl WatchState {
    /// The model as learnt on this tick.
    fn nominal(&self, now: &NowRises) -> Nominal<'_> {
        Nominal {
            parameters: &self.parameters,
            fan: self.fan,
            process: &self.process,
            motion: &self.motion,
            history: &self.history,
            heat: now.heat,
            rises: now.rises,
            before: now.before,
            inlet: self.inlet.map_or([0.0; 2], |(_, _, moved)| moved),
        }
    }

    /// Charts and bank as if nothing had happened.
    fn reset_charts(&mut self) {
        self.fast = Default::default();
        self.slow = Sums::default();
        self.jumped = [0.0; 2];
        self.candidate = 0.0;
    }
}

mod alarmed;
mod finite;
mod judge;
mod lasting;
mod naming;
mod output;
mod recall;
mod resumed;
mod slow;
#[cfg(test)]
mod tests;
mod times;
