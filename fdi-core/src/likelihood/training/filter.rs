//! The extended Kalman filter of training.

use super::super::inputs::Inputs;
use super::super::process::{COUNT, Motion, Parameter, Parameters, Process};
use super::super::second_heater::{SecondHeater, SecondHeaterTangent};
use super::super::tangent::Tangent;
use super::super::tuning::Tuned;
use super::Trainer;
use super::cold::Cold;
use super::noise::ResidualNoise;
use super::sense::bound;
use crate::bounds::{bounded, larger};
use crate::identify::rls::RlsState;
use crate::root::sqrt;

/// What is not learnt before the lags are.
const HELD: [Parameter; 3] = [Parameter::Curvature, Parameter::Offset1, Parameter::Offset2];
/// What the first heat alone shows well.
const STANDS: [usize; 3] =
    [Parameter::Offset1 as usize, Parameter::Offset2 as usize, Parameter::Curvature as usize];

/// The extended Kalman filter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filter {
    rls: RlsState<COUNT>,
    sd: [f32; COUNT],
    tangent: Tangent,
    beside: SecondHeaterTangent,
    gradient: [[f32; COUNT]; 2],
    /// That of the tick before, and in its place what the update makes of both.
    before: [[f32; COUNT]; 2],
    residual: [f32; 2],
    noise: [ResidualNoise; 2],
    answer: f32,
    /// On which tick T1 and T2 answered to the heat.
    answered: [Option<u32>; 2],
    pub(super) started: bool,
    tuning: Tuned,
}

impl Filter {
    /// Nothing has been seen yet.
    pub(super) fn new(tuning: Tuned, rls: RlsState<COUNT>, prior: &[(f32, f32); COUNT], answer: f32) -> Self {
        Self {
            rls,
            sd: prior.map(|(_, sd)| sd),
            answer,
            tangent: Tangent::default(),
            beside: SecondHeaterTangent::default(),
            gradient: [[0.0; COUNT]; 2],
            before: [[0.0; COUNT]; 2],
            residual: [0.0; 2],
            noise: [ResidualNoise::new(tuning); 2],
            answered: [None; 2],
            started: false,
            tuning,
        }
    }

    /// Begins cold, with the offsets as they are read, or warm, from about where the rig is.
    pub(super) fn begin(
        &mut self,
        p: &mut Parameters,
        motion: &mut Motion,
        cold: &Cold,
        y: [f32; 2],
        u: f32,
        inputs: Inputs,
    ) {
        self.started = true;
        if !inputs.t0 {
            self.answered = [Some(0); 2];
            *motion = Motion::steady(u);
            p.set(Parameter::Offset1, y[0] - libm::expf(p.get(Parameter::Gain)) * u);
            return;
        }
        let t = &*self.tuning;
        if y.iter().all(|y| y.abs() < t.cold.below) {
            let mut cold = *cold;
            cold.step(t, y.map(Some), true);
            for (m, which) in [Parameter::Offset1, Parameter::Offset2].into_iter().enumerate() {
                let (mean, sd) = cold.offset(t, m);
                p.set(which, mean);
                self.sd[which as usize] = sd;
            }
            return;
        }
        self.answered = [Some(0); 2];
        if u > self.tuning.filter.warm_power && y[0] > 0.0 {
            p.set(Parameter::Gain, libm::logf(y[0] / u));
            *motion = Motion::steady(u);
        }
    }

    /// Standard deviation of a parameter as far as it is known.
    pub(super) fn error(&self, of: Parameter) -> f32 {
        self.sd[of as usize] * sqrt(larger(0.0, self.rls.variances()[of as usize]))
    }

    /// The first heat has shown about how the rig answers, from a model that was wrong: what moves is learnt anew from there.
    pub(super) fn reopen(&mut self) {
        let variances = self.rls.variances();
        self.rls.forget_correlations();
        for (i, (d, was)) in self.rls.d_mut().iter_mut().zip(variances).enumerate() {
            let moves = !STANDS.contains(&i);
            *d = if moves { larger(was, self.tuning.filter.reopened) } else { was };
        }
    }

    /// A tick without samples: the model goes on, and the residuals as far as they are known.
    pub(super) fn pass(&mut self, p: &Parameters, process: &Process, motion: &mut Motion, power: f32) {
        self.tangent.step(p, process, motion, power, &mut self.gradient);
        for (e, noise) in self.residual.iter_mut().zip(&self.noise) {
            *e *= noise.whitening().0;
        }
    }

    /// One tick; gives the residuals, degC.
    #[expect(clippy::too_many_arguments, reason = "the parts of a training, borrowed one by one")]
    pub(super) fn step(
        &mut self,
        trainer: &Trainer,
        p: &mut Parameters,
        process: &mut Process,
        motion: &mut Motion,
        (beside, power_beside): (&mut SecondHeater, f32),
        y: [f32; 2],
        power: f32,
        ticks: u32,
        learning: bool,
    ) -> [f32; 2] {
        core::mem::swap(&mut self.before, &mut self.gradient);
        let mut rises = self.tangent.step(p, process, motion, power, &mut self.gradient);
        let (inputs, tuning) = (trainer.inputs, trainer.tuning);
        let t = &tuning.filter;
        if !inputs.t2 {
            let (added, by) = self.beside.step(beside, p, power_beside);
            rises.y = rises.y.map(|y| y + added);
            for (which, by) in [Parameter::Gain, Parameter::Reaches2, Parameter::Lag2].into_iter().zip(by) {
                self.gradient[0][which as usize] += by;
            }
        }
        let offsets = [p.get(Parameter::Offset1), p.get(Parameter::Offset2)];
        let e: [f32; 2] = core::array::from_fn(|m| y[m] - rises.y[m] - offsets[m]);
        self.listen(p, [y[0] - offsets[0], y[1] - offsets[1]], ticks);
        let first = t.first_error * libm::expf(-(ticks as f32) / (t.first_answers * self.answer));
        for m in 0..2 {
            if self.answered[m].is_none() || (m == 1 && !inputs.t2) {
                continue;
            }
            if learning {
                self.noise[m].follow(e[m], self.residual[m]);
            }
            if !learning {
                // The first heat fits anything as long as the lags are wrong.
                for held in HELD {
                    self.gradient[m][held as usize] = 0.0;
                }
            }
            let (rho, sigma) = self.noise[m].whitening();
            let wrong = first * (y[m] - offsets[m]);
            let scale = 1.0 / sqrt(t.inflation * sigma * sigma + wrong * wrong);
            let phi = &mut self.before[m];
            for i in 0..COUNT {
                phi[i] = scale * self.sd[i] * (self.gradient[m][i] - rho * phi[i]);
            }
            let innovation = scale * (e[m] - rho * self.residual[m]);
            trainer.rls.correct_clipped(&mut self.rls, phi, innovation, t.clip);
            for i in 0..COUNT {
                p.0[i] += self.sd[i] * bounded(self.rls.theta[i], -t.largest_step, t.largest_step);
            }
        }
        self.residual = e;
        bound(trainer, p);
        *process = Process::new(tuning, p, 1.0);
        if !inputs.t2 {
            beside.follow(p);
        }
        e
    }

    /// Until a thermistor answers to the first heat, its dead time is at least as long as that has been.
    fn listen(&mut self, p: &mut Parameters, rise: [f32; 2], ticks: u32) {
        let now = ticks as f32;
        let t = &self.tuning.filter;
        if self.answered[0].is_none() && rise[0] > t.answers {
            self.answered[0] = Some(ticks);
            let delay = larger(p.get(Parameter::Delay1), now - self.tuning.model.shows_after);
            p.set(Parameter::Delay1, delay);
        }
        if self.answered[1].is_none() && rise[1] > t.answers {
            self.answered[1] = Some(ticks);
            let later = t.later * (now - self.answered[0].map_or(now, |first| first as f32));
            let delay = larger(p.get(Parameter::Delay2), later);
            p.set(Parameter::Delay2, delay);
        }
    }
}
