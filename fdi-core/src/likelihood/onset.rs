//! The regressors since the assumed onset of a fault: the models since then with another air flow, more power, a constant power; lags,
//! ramps and constants that begin there.

use super::process::{Motion, Parameters, Process, Rises};
use super::regressor::{COUNT, PROCESS, Regressor, Regressors, SENSORS};
use super::tuning::{HypothesisTuning, Tuned};
use super::whitening::{Past, REMEMBERS, WhiteningFilter};

/// Power and motion of the last ticks, so that a change of power or flow may begin before it shows.
pub(super) const REMEMBERED: usize = 24;

/// What the model did lately.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct History {
    heat: [f32; REMEMBERED],
    states: [(f32, [f32; 2], [f32; 2]); REMEMBERED],
    newest: usize,
}

impl History {
    pub(super) fn push(&mut self, heat: f32, motion: &Motion) {
        self.newest = (self.newest + 1) % REMEMBERED;
        self.heat[self.newest % REMEMBERED] = heat;
        self.states[self.newest % REMEMBERED] = (motion.x, motion.m, motion.w);
    }

    fn place(&self, ago: usize) -> usize {
        (self.newest + REMEMBERED - ago.min(REMEMBERED - 1)) % REMEMBERED
    }

    /// Rises of the newest tick that is remembered.
    pub(super) fn newest(&self, process: &Process) -> Rises {
        let (_, m, w) = self.states[self.newest % REMEMBERED];
        process.rises(m, w)
    }
}

/// A model since the onset whose air flow approaches `flow` with the fan's lag.
#[derive(Clone, Copy, Debug, Default)]
struct Flowing {
    motion: Motion,
    process: Process,
}

/// The memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Onset {
    /// Ticks since, and those since the sensors' regressors began.
    pub(super) age: u32,
    pub(super) sensors_age: u32,
    flow_age: f32,
    /// What the process does begins anew with the next tick, as if it had begun so many ticks before.
    pub(super) process_again: Option<usize>,
    /// Less flow is about half of it; for so many ticks the whitening filters have yet to forget that it was not before.
    half_closed: bool,
    settles: usize,
    less: Flowing,
    more: Flowing,
    pub(super) power: Motion,
    constant: Motion,
    lagged: [f32; 2],
    lost: [f32; 2],
    power_before: [f32; 2],
    past: [Past; COUNT],
}

/// What does not change.
#[derive(Clone, Copy, Debug)]
pub(super) struct OnsetConstants {
    /// Ticks by which a change of power or flow begins before it shows.
    pub(super) lead: usize,
    /// Shares of both lags of a clogged thermistor; of the fan's lag.
    pub(super) lags: [f32; 2],
    pub(super) fan: f32,
    /// Minutes a tick.
    pub(super) minutes: f32,
}

/// The model as learnt on this tick.
pub(super) struct Nominal<'a> {
    pub(super) parameters: &'a Parameters,
    /// The air flow that it has, 1 as learnt.
    pub(super) fan: f32,
    pub(super) process: &'a Process,
    pub(super) motion: &'a Motion,
    pub(super) history: &'a History,
    pub(super) heat: f32,
    pub(super) rises: Rises,
    /// Rises a tick ago.
    pub(super) before: [f32; 2],
    /// What T0's motion may have been at T1 and at T2, degC.
    pub(super) inlet: [f32; 2],
}

impl Onset {
    /// Begins on this tick, the first that shows anything.
    #[inline(never)]
    fn begin(&mut self, c: &OnsetConstants, now: &Nominal) {
        *self = Self { lagged: [now.before[0]; 2], ..Self::default() };
        self.begin_process(c, now, c.lead);
    }

    /// What the process does began so many ticks before this one.
    fn begin_process(&mut self, c: &OnsetConstants, now: &Nominal, lead: usize) {
        self.process_again = None;
        for regressor in PROCESS {
            self.past[regressor as usize] = Past::default();
        }
        (self.flow_age, self.power, self.constant) = (0.0, Motion::default(), Motion::default());
        self.power_before = [0.0; 2];
        let lead = lead.min(REMEMBERED - 2);
        let (x, m, w) = now.history.states[now.history.place(lead)];
        // The air that has left the heater since is pushed again, so that the ring must be that of then.
        let mut past = *now.motion;
        past.air.back(lead + 1);
        let then = Motion { x, m, w, air: past.air };
        self.less = Flowing { motion: then, process: *now.process };
        self.more = Flowing { motion: then, process: *now.process };
        for ago in (0..lead).rev() {
            let heat = now.history.heat[now.history.place(ago)];
            self.advance(c, now, heat);
        }
    }

    fn flows(&self, tuning: Tuned) -> [f32; 2] {
        let t = &tuning.hypotheses;
        let [less, more] = t.flows();
        [if self.half_closed { t.half_closed().1 } else { less }, more]
    }

    /// A loss of air turns out to be `loss`, 1/f - 1: from some size on, all that the process does is computed anew, with less flow that is about half of it.
    pub(super) fn close(&mut self, t: &HypothesisTuning, loss: f32) {
        if !self.half_closed && loss > t.half_closed().0 {
            self.half_closed = true;
            self.process_again = Some(self.flow_age as usize);
            self.settles = REMEMBERS;
        }
    }

    /// Whether the regressors still show how the process began anew.
    pub(super) fn is_settling(&self) -> bool {
        self.settles > 0
    }

    /// A tick of the models.
    fn advance(&mut self, c: &OnsetConstants, now: &Nominal, heat: f32) -> [Rises; 4] {
        // The fan's lag: the coefficients follow while the flow still moves.
        let approach = 1.0 - libm::expf(-(self.flow_age + 0.5) * c.fan);
        if self.flow_age * c.fan < 8.0 {
            let flows = self.flows(now.process.tuning);
            for (model, flow) in [&mut self.less, &mut self.more].into_iter().zip(flows) {
                model.process.blow(now.parameters, now.fan * (1.0 + (flow - 1.0) * approach));
            }
            self.flow_age += 1.0;
        }
        [
            self.less.process.step(&mut self.less.motion, heat),
            self.more.process.step(&mut self.more.motion, heat),
            now.process.step(&mut self.power, heat),
            now.process.step(&mut self.constant, 1.0),
        ]
    }

    /// The regressors of this tick, and the same whitened.
    #[inline(never)]
    pub(super) fn step(
        &mut self,
        c: &OnsetConstants,
        whitening: &WhiteningFilter,
        now: &Nominal,
    ) -> [Regressors; 2] {
        if self.age == 0 {
            self.begin(c, now);
        } else if let Some(lead) = self.process_again {
            self.begin_process(c, now, lead);
        }
        self.settles = self.settles.saturating_sub(1);
        let [less, more, power, constant] = self.advance(c, now, now.heat);
        let y = now.rises.y;
        for (lagged, share) in self.lagged.iter_mut().zip(c.lags) {
            *lagged += share * (y[0] - *lagged);
        }
        for (lost, share) in self.lost.iter_mut().zip(c.lags) {
            *lost += share * (y[0] - *lost);
        }
        let ramp = self.sensors_age as f32 * c.minutes;
        self.age = self.age.saturating_add(1);
        self.sensors_age = self.sensors_age.saturating_add(1);
        let mut regressors = [[0.0; 2]; COUNT];
        let mut put = |regressor: Regressor, value: [f32; 2]| regressors[regressor as usize] = value;
        let [less_by, more_by] = self.flows(now.process.tuning).map(|flow| 1.0 / flow - 1.0);
        let change = |to: Rises, by: f32| [(to.y[0] - y[0]) / by, (to.y[1] - y[1]) / by];
        put(Regressor::Power, power.y);
        let before = core::mem::replace(&mut self.power_before, power.y);
        put(Regressor::Late, [before[0] - power.y[0], before[1] - power.y[1]]);
        put(Regressor::LessFlow, change(less, less_by));
        put(Regressor::MoreFlow, change(more, more_by));
        put(Regressor::Constant, constant.y);
        put(Regressor::Ramp1, [ramp, 0.0]);
        put(Regressor::Ramp2, [0.0, ramp]);
        put(Regressor::ShortLag, [self.lagged[0] - y[0], 0.0]);
        put(Regressor::LongLag, [self.lagged[1] - y[0], 0.0]);
        put(Regressor::ShortLoss, [self.lost[0], 0.0]);
        put(Regressor::LongLoss, [self.lost[1], 0.0]);
        put(Regressor::Offset1, [1.0, 0.0]);
        put(Regressor::Offset2, [0.0, 1.0]);
        put(Regressor::Gain1, [y[0], 0.0]);
        put(Regressor::Gain2, [0.0, y[1]]);
        put(Regressor::Inlet1, [now.inlet[0], 0.0]);
        put(Regressor::Inlet2, [0.0, now.inlet[1]]);
        put(Regressor::Exchanged, [y[1] - y[0], y[0] - y[1]]);
        put(Regressor::Wall, now.rises.wall);
        put(Regressor::Shift, [now.before[0] - y[0], now.before[1] - y[1]]);
        let mut whitened = [[0.0; 2]; COUNT];
        whitening.step_all(&mut self.past, &regressors, &mut whitened);
        [regressors, whitened]
    }

    /// A tick without samples: the models go on, and no regressor is whitened, as no residual is.
    pub(super) fn pass(&mut self, c: &OnsetConstants, whitening: &WhiteningFilter, now: &Nominal) {
        let past = self.past;
        self.step(c, whitening, now);
        self.past = past;
    }

    /// The sensors' regressors begin anew with the next tick, what the process does goes on.
    pub(super) fn restart_sensors(&mut self, rise: f32) {
        self.sensors_age = 0;
        self.lagged = [rise; 2];
        self.lost = [0.0; 2];
        for regressor in SENSORS {
            self.past[regressor as usize] = Past::default();
        }
    }
}

#[cfg(test)]
mod tests;
