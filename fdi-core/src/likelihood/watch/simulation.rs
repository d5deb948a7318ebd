//! The model, simulated by the power alone: what T1 and T2 should read, and what they would read if one thing had always been otherwise.

use super::Input;
use super::times::Times;
use crate::likelihood::inputs::Inputs;
use crate::likelihood::model::Model;
use crate::likelihood::onset::{History, Nominal, REMEMBERED};
use crate::likelihood::process::{Motion, Parameter, Parameters, Process, Rises};
use crate::likelihood::regressor::{LASTING, Regressor, Regressors};
use crate::likelihood::second_heater::SecondHeater;
use crate::likelihood::start::{Begun, Start};
use crate::likelihood::training::Trained;
use crate::likelihood::tuning::Tuned;
use crate::likelihood::whitening::WhiteningFilter;
use crate::vector::sum;

/// The simulation of a rig that has these inputs.
#[derive(Clone, Debug)]
pub(super) struct Simulation {
    pub(super) inputs: Inputs,
    pub(super) tuning: Tuned,
}

/// A model at its air flow, and what moves in it.
#[derive(Clone, Copy, Debug)]
struct Rig {
    process: Process,
    motion: Motion,
}

/// The memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct SimulationState {
    parameters: Parameters,
    /// Static gain from the power to T1, degC per %.
    gain: f32,
    second_heater: SecondHeater,
    /// The fan's level as announced, behind its lag, and the rig there; with less air and with more, for the secants.
    fan: f32,
    rig: Rig,
    less: Rig,
    more: Rig,
    power: f32,
    heat: f32,
    /// Rises on the last tick, without what the residuals are in the mean, degC; and what T1 and T2 should read above T0.
    rises: [f32; 2],
    expected: [f32; 2],
    /// Means of the residuals in training, degC.
    mean: [f32; 2],
    /// It is not known yet how the rig began.
    begins: bool,
    history: History,
    inlet: Option<Inlet>,
}

/// T0 and its mean, degC.
#[derive(Clone, Copy, Debug)]
struct Inlet {
    t0: f32,
    mean: f32,
    /// What T0's motion may have been at T1 and at T2, degC.
    moved: [f32; 2],
}

/// What the model says of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Simulated {
    heat: f32,
    rises: Rises,
    /// Rises on the tick before, degC.
    pub(super) before: [f32; 2],
    /// What T1 and T2 should read above T0 by their own heater, degC, and what the second heater adds.
    pub(super) expected: [f32; 2],
    pub(super) added: f32,
    /// By how much they would differ if one thing had always been otherwise.
    pub(super) regressors: Regressors<LASTING>,
}

impl Simulation {
    pub(super) fn start(&self, trained: &Trained) -> SimulationState {
        let (t, p) = (self.tuning, trained.parameters);
        let rig = |flow| Rig { process: Process::new(t, &p, flow), motion: trained.motion };
        let rig_as_learnt = rig(1.0);
        let [less, more] = t.hypotheses.flows().map(rig);
        SimulationState {
            parameters: p,
            gain: libm::expf(p.get(Parameter::Gain)),
            second_heater: trained.beside,
            fan: 1.0,
            rig: rig_as_learnt,
            less,
            more,
            power: trained.power,
            heat: rig_as_learnt.process.heat(trained.power),
            rises: [trained.rise; 2],
            expected: [trained.rise; 2],
            mean: trained.mean,
            begins: false,
            history: History::default(),
            inlet: None,
        }
    }

    /// Another recording begins, long after its power was last changed.
    pub(super) fn resume(&self, s: &mut SimulationState, power: f32, fan: f32, second_power: f32) {
        s.heat = s.rig.process.heat(power);
        s.power = power;
        s.fan = fan;
        s.second_heater = s.second_heater.resumed(second_power);
        for rig in [&mut s.rig, &mut s.less, &mut s.more] {
            rig.motion = Motion::steady(s.heat);
        }
        s.remember_anew();
        s.begins = true;
    }

    /// What has to be found before it is judged again; where `is_long`, until a rig has forgotten how it began, however slow it is.
    pub(super) fn begins(&self, s: &SimulationState, whitening: WhiteningFilter, is_long: bool) -> Start {
        let t = &self.tuning.slow;
        let settles = t.settles * s.parameters.residence();
        let settles = if is_long || settles <= t.anchored { settles } else { 0.0 };
        Start::new(s.rig.process, whitening, s.second_heater, self.inputs, (settles + t.anchored) as u32)
    }

    /// How the rig began is known, and so how it is.
    pub(super) fn settle(&self, s: &mut SimulationState, begun: &Begun) {
        for rig in [&mut s.rig, &mut s.less, &mut s.more] {
            rig.motion.add(&begun.motion, 1.0);
        }
        s.second_heater.add(&begun.beside, 1.0);
        s.mean.iter_mut().zip(begun.room).for_each(|(mean, room)| *mean += room);
        s.remember_anew();
        s.begins = false;
    }

    /// Follows an announced change of the fan, with its lag; gives what is left of it, none where there is none.
    pub(super) fn follow_fan(&self, s: &mut SimulationState, times: &Times, fan: f32) -> Option<f32> {
        let (t, left) = (self.tuning, fan - s.fan);
        if left.abs() < t.fan.same {
            return None;
        }
        s.fan += left * times.onset.fan.min(1.0);
        if (fan - s.fan).abs() < t.fan.same {
            s.fan = fan;
        }
        s.rig.process = Process::new(t, &s.parameters, s.fan);
        for (rig, flow) in [&mut s.less, &mut s.more].into_iter().zip(t.hypotheses.flows()) {
            rig.process = Process::new(t, &s.parameters, flow * s.fan);
        }
        Some(left)
    }

    /// One tick.
    pub(super) fn step(&self, s: &mut SimulationState, times: &Times, now: &Input) -> Simulated {
        let added = s.second_heater.step(now.second_power);
        if let Some(t0) = now.t0 {
            self.follow_inlet(s, times, t0);
        }
        s.history.push(s.heat, &s.rig.motion);
        let heat = s.rig.process.heat(self.inputs.drove(&mut s.power, now.power));
        let rises = s.rig.step(heat);
        let before = core::mem::replace(&mut s.rises, rises.y);
        let regressors = self.regressors(s, heat, &rises, before);
        let offsets = s.offsets();
        s.heat = heat;
        s.expected = core::array::from_fn(|m| rises.y[m] + offsets[m] + s.mean[m]);
        Simulated { heat, rises, before, expected: s.expected, added, regressors }
    }

    fn follow_inlet(&self, s: &mut SimulationState, times: &Times, t0: f32) {
        let inlet = s.inlet.get_or_insert(Inlet { t0, mean: t0, moved: [0.0; 2] });
        let above = t0 - inlet.mean;
        times.inlet.follow(&mut inlet.mean, t0);
        inlet.moved = [self.tuning.model.inlet_slope * (t0 - inlet.t0), above];
        inlet.t0 = t0;
    }

    /// Regressors of this tick, as if each thing had always been so.
    fn regressors(
        &self,
        s: &mut SimulationState,
        heat: f32,
        rises: &Rises,
        before: [f32; 2],
    ) -> Regressors<LASTING> {
        let (less, more) = (s.less.step(heat), s.more.step(heat));
        let y = rises.y;
        let [less_by, more_by] = self.tuning.hypotheses.secants();
        let mut regressors = [[0.0; 2]; LASTING];
        let mut put = |regressor: Regressor, value: [f32; 2]| regressors[regressor as usize] = value;
        put(Regressor::Power, y);
        put(Regressor::LessFlow, [(less.y[0] - y[0]) / less_by, (less.y[1] - y[1]) / less_by]);
        put(Regressor::MoreFlow, [(more.y[0] - y[0]) / more_by, (more.y[1] - y[1]) / more_by]);
        put(Regressor::Offset1, [1.0, 0.0]);
        put(Regressor::Offset2, [0.0, 1.0]);
        put(Regressor::Gain1, [y[0], 0.0]);
        put(Regressor::Gain2, [0.0, y[1]]);
        put(Regressor::Wall, rises.wall);
        put(Regressor::Shift, [before[0] - y[0], before[1] - y[1]]);
        regressors
    }
}

impl Rig {
    fn step(&mut self, heat: f32) -> Rises {
        self.process.step(&mut self.motion, heat)
    }

    fn rises(&self) -> Rises {
        self.process.rises(self.motion.m, self.motion.w)
    }
}

impl SimulationState {
    /// Whether nothing can be judged, since it is not known how the rig began.
    pub(super) fn is_beginning(&self) -> bool {
        self.begins
    }

    /// The model's heat at T1, behind the dead time, %, and by how much T1 rises with it, degC.
    pub(super) fn heat_at_t1(&self) -> [f32; 2] {
        let (heat, _) = self.rig.motion.air.at(self.rig.process.delay[0]);
        [heat, self.rises[0]]
    }

    /// The model, its state, and the heat of the last tick, %.
    pub(super) fn moving(&self) -> (&Process, &Motion, f32) {
        (&self.rig.process, &self.rig.motion, self.heat)
    }

    /// The model as learnt.
    pub(super) fn process(&self) -> &Process {
        &self.rig.process
    }

    /// As if it had been for long as it is now.
    fn remember_anew(&mut self) {
        self.history = History::default();
        for _ in 0..REMEMBERED {
            self.history.push(self.heat, &self.rig.motion);
        }
        self.rises = self.rig.rises().y;
    }

    fn offsets(&self) -> [f32; 2] {
        [self.parameters.get(Parameter::Offset1), self.parameters.get(Parameter::Offset2)]
    }

    /// What is measured above T0, degC, as a rise of the model.
    pub(super) fn as_rises(&self, y: [f32; 2]) -> [f32; 2] {
        let offsets = self.offsets();
        [y[0] - offsets[0] - self.mean[0], y[1] - offsets[1] - self.mean[1]]
    }

    /// The model as learnt on this tick, for what begins here.
    pub(super) fn nominal(&self, now: &Simulated) -> Nominal<'_> {
        Nominal {
            parameters: &self.parameters,
            fan: self.fan,
            process: &self.rig.process,
            motion: &self.rig.motion,
            history: &self.history,
            heat: now.heat,
            rises: now.rises,
            before: now.before,
            inlet: self.inlet.map_or([0.0; 2], |inlet| inlet.moved),
        }
    }

    /// The last tick once more, for those who ask afterwards.
    pub(super) fn last(&self) -> Simulated {
        Simulated {
            heat: self.heat,
            rises: self.rig.rises(),
            before: self.history.newest(&self.rig.process).y,
            expected: self.expected,
            added: self.second_heater.added(),
            regressors: Default::default(),
        }
    }

    /// The power was other by `theta` of `since` and is no longer since `until`; gives by how much the rises change, degC.
    pub(super) fn take_over(&mut self, theta: f32, since: &Motion, until: &Motion) -> [f32; 2] {
        let before = self.rig.rises().y;
        self.rig.motion.add(since, theta);
        self.rig.motion.add(until, -theta);
        let after = self.rig.rises().y;
        [after[0] - before[0], after[1] - before[1]]
    }

    /// The air flow for which the rig is simulated: 1 as learnt.
    pub(super) fn fan(&self) -> f32 {
        self.fan
    }

    /// Static gain from the power to T1, degC per %.
    pub(super) fn gain(&self) -> f32 {
        self.gain
    }

    /// Share of T1's rise that reaches T2.
    pub(super) fn reaches(&self) -> f32 {
        self.parameters.get(Parameter::Reaches2)
    }

    /// What T1 should read above T0 without what the residuals are in the mean, degC.
    pub(super) fn rise_of_t1(&self) -> f32 {
        self.rises[0] + self.offsets()[0]
    }

    /// Rises of the model on the last tick, degC.
    pub(super) fn rises(&self) -> [f32; 2] {
        self.rises
    }

    /// What T1 and T2 should read above T0 now, degC, with what the second heater adds and without.
    pub(super) fn expected(&self) -> [f32; 2] {
        self.expected.map(|rise| rise + self.second_heater.added())
    }

    pub(super) fn expected_by_own_heater(&self) -> [f32; 2] {
        self.expected
    }

    /// By how much T0 is above its mean, degC.
    pub(super) fn inlet_above(&self) -> f32 {
        self.inlet.map_or(0.0, |inlet| inlet.moved[1])
    }

    /// What was learnt, for people; `noise` in degC.
    pub(super) fn model(&self, sample_time: f32, noise: [f32; 2]) -> Model {
        let p = |which| self.parameters.get(which);
        let time = |which| sample_time * libm::expf(p(which));
        let (gain_beside, lag_beside) = self.second_heater.learnt();
        Model {
            gain: self.gain,
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
            noise,
        }
    }

    /// Finite as long as all of it is that stays.
    pub(super) fn sum(&self) -> f32 {
        let inlet = self.inlet.map_or(0.0, |inlet| inlet.t0 + inlet.mean);
        let lists = sum(&self.expected) + sum(&self.mean) + sum(&self.parameters.0);
        let motions = self.rig.motion.sum() + self.less.motion.sum() + self.more.motion.sum();
        lists + self.fan + self.gain + inlet + self.second_heater.added() + motions
    }
}

#[cfg(test)]
impl SimulationState {
    /// Places of the memory that a bit may flip in.
    pub(super) fn places(&mut self) -> [&mut f32; 9] {
        let Rig { process, motion } = &mut self.rig;
        let [_, m2] = &mut motion.m;
        [
            &mut motion.x,
            m2,
            &mut motion.w[0],
            &mut self.parameters.0[3],
            &mut process.gain[0],
            &mut self.more.process.lag[0],
            &mut self.mean[0],
            &mut self.power,
            &mut self.fan,
        ]
    }
}
