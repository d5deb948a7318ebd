//! Training: the model's parameters in one pass by an extended Kalman filter, from the first heat on; then, with the model frozen, what is normal
//! for its residuals; a gate behind.
//!
//! The filter is recursive least squares on the sensitivities (`tangent.rs`), each residual first whitened by a fixed share of the one
//! before. Parameters are scaled by the standard deviations of their priors, which are wide, and in ticks: a sample time that suits the plant is all
//! that it asks for.

mod cold;
mod filter;
mod noise;
mod sense;

use super::inputs::Inputs;
use super::process::{COUNT, LONGEST, Motion, Parameter, Parameters, Process};
use super::second_heater::SecondHeater;
use super::tuning::{PriorTuning, Tuned};
use super::verdict::RejectReason;
use super::whitening::{ResidualStatistics, WhiteningFilter};
use crate::bounds::larger;
use crate::error::ConfigError;
use crate::identify::config::{Adaptation, RlsConfig};
use crate::identify::rls::Rls;
use crate::vector::sum;
pub(super) use cold::Cold;
use filter::Filter;
pub(super) use sense::make_twin;

/// Priors of the parameters, mean and standard deviation, where neither the answer time nor the usual gain says more.
const fn prior(t: &PriorTuning) -> [(f32, f32); COUNT] {
    [
        (0.0, t.wide),      // by the usual one
        (0.0, t.heater_sd), // by the answer time
        (t.delay1, t.delay_sd),
        (t.lag1, t.lag_sd),
        (t.wall1, t.wall_sd),
        (t.reaches, t.reaches_sd),
        (t.delay2, t.delay_sd),
        (t.lag2, t.lag_sd),
        (t.wall2, t.wall_sd),
        (0.0, t.wide), // by the answer time
        (0.0, t.offset_sd),
        (0.0, t.offset_sd),
        (0.0, t.curvature_sd),
    ]
}

/// Longest dead time of T1 and T2 together, ticks: the transport holds it for a lower air flow, too.
pub(super) fn longest_delay(tuning: &Tuned) -> f32 {
    tuning.range.longest_delay * LONGEST
}

/// How far training has come.
#[derive(Clone, Copy, Debug)]
pub(super) struct Training {
    parameters: Parameters,
    process: Process,
    motion: Motion,
    phase: Phase,
    statistics: ResidualStatistics,
    beside: SecondHeater,
    power: f32,
    curvature_error: f32,
    ticks: u32,
    count: u32,
}

#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one, and nowhere to box it")]
enum Phase {
    /// The model is fitted.
    Fitting(Filter),
    /// It is frozen, and its residuals are watched.
    Checking,
}

/// What training gives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trained {
    pub(super) parameters: Parameters,
    pub(super) motion: Motion,
    pub(super) whitening: WhiteningFilter,
    pub(super) mean: [f32; 2],
    pub(super) beside: SecondHeater,
    /// Power applied since the last tick, %.
    pub(super) power: f32,
    /// Rise of T1 at which it was learnt, degC.
    pub(super) rise: f32,
    /// Standard deviation of [`Parameter::Curvature`].
    pub(super) curvature_error: f32,
}

/// Lengths of both parts in samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trainer {
    rls: Rls<COUNT>,
    prior: [(f32, f32); COUNT],
    /// Dead time and four time constants, ticks.
    answer: f32,
    inputs: Inputs,
    tuning: Tuned,
    pub(super) fit_samples: u32,
    pub(super) check_samples: u32,
}

impl Trainer {
    /// Samples that training takes.
    pub(super) fn samples(&self) -> u32 {
        self.fit_samples.saturating_add(self.check_samples)
    }
}

impl Training {
    /// Finite as long as all of it is that what follows would not refuse.
    pub(super) fn sum(&self) -> f32 {
        sum(&self.parameters.0) + self.motion.sum() + self.beside.added() + self.power
    }
}

impl Trainer {
    /// Of a plant that answers within `answer` ticks and has about the gain `usual`, degC per %.
    pub(super) fn new(
        tuning: Tuned,
        fit_samples: u32,
        check_samples: u32,
        answer: f32,
        usual: f32,
    ) -> Result<Self, ConfigError> {
        let t = &tuning.prior;
        let mut prior = prior(t);
        prior[Parameter::Gain as usize].0 = libm::logf(usual);
        prior[Parameter::Heater as usize].0 = libm::logf(t.heater * answer);
        prior[Parameter::WallTime as usize].0 = libm::logf(t.wall_time * answer);
        let adaptation = Adaptation::RandomWalk { r1: 0.0, r2: 1.0 };
        let rls = Rls::new(&RlsConfig { adaptation, d_initial: 1.0, d_max: 1.0 })?;
        Ok(Self { rls, prior, answer, inputs: Inputs::ALL, tuning, fit_samples, check_samples })
    }

    /// The same of a rig that lacks some inputs.
    pub(super) fn with(mut self, inputs: Inputs) -> Self {
        self.inputs = inputs;
        let t = &self.tuning.prior;
        if !inputs.t0 {
            self.prior[Parameter::Offset1 as usize].1 = t.intercept_sd;
            self.prior[Parameter::Offset2 as usize].1 = t.intercept_sd;
        }
        if !inputs.t2 {
            let (heater, _) = self.prior[Parameter::Heater as usize];
            self.prior[Parameter::Reaches2 as usize] = (t.second_heater, t.reaches_sd);
            self.prior[Parameter::Lag2 as usize] = (heater, t.wide);
        }
        self
    }

    /// Mean and standard deviation of what each parameter may be.
    pub(super) fn priors(&self) -> [(f32, f32); COUNT] {
        self.prior
    }

    pub(super) fn start(&self) -> Training {
        let parameters = Parameters(self.prior.map(|(mean, _)| mean));
        Training {
            parameters,
            process: Process::new(self.tuning, &parameters, 1.0),
            motion: Motion::default(),
            phase: Phase::Fitting(Filter::new(self.tuning, self.rls.start(), &self.prior, self.answer)),
            statistics: ResidualStatistics::default(),
            beside: SecondHeater::default(),
            power: 0.0,
            curvature_error: 0.0,
            ticks: 0,
            count: 0,
        }
    }

    /// One tick: rises over T0 where valid, degC, and the powers applied from now on, %: T1's own, and that beside it. `fit_to_learn` says whether it is one of undisturbed
    /// operation; those before, while it heats up, serve the fit as well.
    ///
    /// # Errors
    /// Why what was learnt can't be trusted.
    pub(super) fn step(
        &self,
        s: &mut Training,
        cold: &Cold,
        y: [Option<f32>; 2],
        [u, beside]: [f32; 2],
        fit_to_learn: bool,
    ) -> Result<Option<Trained>, RejectReason> {
        let power = self.inputs.drove(&mut s.power, u);
        let whole = match y {
            [Some(y1), Some(y2)] => Some([y1, y2]),
            _ => None,
        };
        if let Phase::Fitting(filter) = &mut s.phase {
            let Some(y) = whole else {
                if filter.started {
                    s.ticks = s.ticks.saturating_add(1);
                    filter.pass(&s.parameters, &s.process, &mut s.motion, power);
                    s.beside.step(beside);
                }
                return Ok(None);
            };
            if !filter.started {
                filter.begin(&mut s.parameters, &mut s.motion, cold, y, u, self.inputs);
                s.beside = SecondHeater::steady(&s.parameters, beside);
                s.process = Process::new(self.tuning, &s.parameters, 1.0);
                return Ok(None);
            }
            s.ticks = s.ticks.saturating_add(1);
            if fit_to_learn && s.count == 0 {
                filter.reopen();
            }
            let e = filter.step(
                self,
                &mut s.parameters,
                &mut s.process,
                &mut s.motion,
                (&mut s.beside, beside),
                y,
                power,
                s.ticks,
                fit_to_learn,
            );
            if fit_to_learn {
                s.count += 1;
                if 2 * s.count > self.fit_samples {
                    s.statistics.push(e, y);
                }
            }
            if s.count >= self.fit_samples {
                s.count = 0;
                // A step of the mains while it learns bends the model, and the filter is as sure of that: no bend is surer than that there is none.
                let bend = s.parameters.get(Parameter::Curvature).abs();
                s.curvature_error = larger(filter.error(Parameter::Curvature), bend);
                s.phase = Phase::Checking;
            }
            return Ok(None);
        }
        let rises = s.process.step(&mut s.motion, s.process.heat(power));
        let added = if self.inputs.t2 { 0.0 } else { s.beside.step(beside) };
        if let (Some(y), true) = (whole, fit_to_learn) {
            let y = y.map(|y| y - added);
            let offsets = [s.parameters.get(Parameter::Offset1), s.parameters.get(Parameter::Offset2)];
            s.statistics.push(core::array::from_fn(|m| y[m] - rises.y[m] - offsets[m]), y);
            s.count += 1;
        }
        if s.count < self.check_samples {
            return Ok(None);
        }
        if !self.inputs.t2 {
            make_twin(&mut s.parameters, &mut s.motion);
        }
        let delay = s.parameters.get(Parameter::Delay1) + s.parameters.get(Parameter::Delay2);
        if delay >= longest_delay(&self.tuning) {
            return Err(RejectReason::DeadTime);
        }
        Ok(Some(Trained {
            parameters: s.parameters,
            motion: s.motion,
            whitening: s.statistics.finish(&self.tuning.whitening, self.inputs.channels())?,
            mean: s.statistics.mean(),
            beside: s.beside,
            power: u,
            rise: s.statistics.level(0),
            curvature_error: s.curvature_error,
        }))
    }
}

#[cfg(test)]
mod tests;
