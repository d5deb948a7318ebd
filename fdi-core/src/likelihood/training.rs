//! Training: the model's parameters in one pass by an extended Kalman filter, from the first heat on; then, with the model frozen, what is normal
//! for its residuals; a gate behind.
//!
//! The filter is recursive least squares on the sensitivities (`tangent.rs`), each residual first whitened by a fixed share of the one
//! before. Parameters are scaled by the standard deviations of their priors, which are wide, and in ticks: a sample time that suits the plant is all
//! that it asks for.

use super::beside::{self, Beside, BesideTangent};
use super::inputs::Inputs;
use super::ladder::{Ladder, ResidualStatistics};
use super::process::{COUNT, LONGEST, Motion, Parameter, Parameters, Process};
use super::tangent::Tangent;
use super::verdict::RejectReason;
use crate::bounds::{bounded, larger};
use crate::error::ConfigError;
use crate::filter::LowPass;
use crate::identify::config::{Adaptation, RlsConfig};
use crate::identify::rls::{Rls, RlsState};
use crate::root::sqrt;

/// Priors of the parameters, mean and standard deviation, where neither the answer time nor the usual gain says more.
const PRIOR: [(f32, f32); COUNT] = [
    (0.0, 0.7),   // gain: by the usual one
    (0.0, 0.8),   // heater: by the answer time
    (0.9, 1.4),   // dead time, ticks
    (-0.1, 1.0),  // T1: a tick
    (0.03, 0.06), // wall at T1
    (0.9, 0.2),   // what reaches T2
    (1.1, 1.4),   // transport, ticks
    (1.3, 1.0),   // T2: 4 ticks
    (0.02, 0.06), // wall at T2
    (0.0, 0.7),   // wall: by the answer time
    (0.0, 1.5),   // offsets
    (0.0, 1.5),
    (0.0, 0.015), // curvature
];
/// The heater's time constant as a share of the answer time; the wall's, and its bounds, in answer times.
const HEATER_SHARE: f32 = 0.22;
const WALL_ANSWERS: f32 = 15.0;
const WALL_BOUNDS: (f32, f32) = (2.0, 60.0);
/// Standard deviation of the offsets where they were read from the cold rig, degC.
const COLD_SD: f32 = 0.15;
const COLD_LEAST_SD: f32 = 0.05;
/// Samples over which they are read, and those of late.
const COLD_MEMORY: f32 = 100.0;
const COLD_RECENT: f32 = 20.0;
/// A rig whose rises are below this is cold, and T1 and T2 answer when theirs grows by so much, degC.
const COLD: f32 = 3.0;
const ANSWERS: f32 = 0.5;
/// Bounds of what must not run away: ln of the heater's time, dead times, what reaches T2, ln of the wall's time.
const HEATER: (f32, f32) = (-1.0, 7.0);
const REACHES: (f32, f32) = (0.05, 1.2);
/// And of the offsets, degC; of an intercept in its standard deviations.
const OFFSET: f32 = 20.0;
const OFFSET_SPAN: f32 = 10.0;
/// A residual is whitened by so much of the one before, and has this standard deviation, degC, until both are known.
const RHO: f32 = 0.6;
const SIGMA: f32 = 0.1;
/// Memories of the residuals' mean and covariances, ticks, and the bounds of what follows from them.
const NOISE_MEMORY: LowPass = LowPass::over(200.0);
const RHOS: (f32, f32) = (0.0, 0.95);
const LEAST_SIGMA: f32 = 0.02;
const NOISE_VARIANCE: f32 = SIGMA * SIGMA / (1.0 - RHO * RHO);
/// How much vaguer a tick is than its noise; at first by a share of the rise, dying out within so many answer times: the model is still wrong.
const VAGUE: f32 = 2.25;
const FIRST_ERROR: f32 = 0.1;
const FIRST_ANSWERS: f32 = 6.0;
/// No tick moves a parameter by more than this share of its prior, nor counts for more than so many standard deviations.
const LARGEST_STEP: f32 = 0.3;
const LIMIT: f32 = 4.0;
/// Longest dead time of T1 and T2 together, ticks: the transport holds it for a lower air flow, too.
const LONGEST_DELAY: f32 = 0.7 * LONGEST;
/// What is not learnt before the lags are.
const HELD: [Parameter; 3] = [Parameter::Curvature, Parameter::Offset1, Parameter::Offset2];
/// What the first heat alone shows well, and the least variance that all others begin learning with, of their prior's.
const STANDS: [usize; 3] =
    [Parameter::Offset1 as usize, Parameter::Offset2 as usize, Parameter::Curvature as usize];
const REOPENED: f32 = 0.1;
/// T1's own lag is no more than this share of it and the heater's, when learning begins.
const OWN_SHARE: f32 = 0.3;
/// Without T0 the intercept is known no better than this, degC.
const INTERCEPT_SD: f32 = 30.0;
/// Residual means are taken over by this share.
const MEAN_SHARE: f32 = 0.7;

/// What T1 and T2 read above T0 while nothing heats: what thermistors differ by.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cold {
    samples: f32,
    mean: [f32; 2],
    recent: [f32; 2],
}

impl Cold {
    /// A tick; `resting` says that nothing heats.
    pub(super) fn step(&mut self, y: [Option<f32>; 2], resting: bool) {
        let [Some(y1), Some(y2)] = y else { return };
        if !resting || larger(y1.abs(), y2.abs()) > COLD {
            self.samples = 0.0;
            return;
        }
        self.samples = (self.samples + 1.0).min(COLD_MEMORY);
        for (m, y) in [y1, y2].into_iter().enumerate() {
            self.mean[m] += (y - self.mean[m]) / self.samples;
            self.recent[m] += (y - self.recent[m]) / self.samples.min(COLD_RECENT);
        }
    }

    /// What a thermistor differs by from T0, and the standard deviation of that, degC. A trend says that it is not at rest yet.
    fn offset(&self, m: usize) -> (f32, f32) {
        let trend = (self.recent[m] - self.mean[m]).abs();
        (self.recent[m], larger(COLD_LEAST_SD, COLD_SD / sqrt(self.samples.min(COLD_RECENT))) + trend)
    }
}

/// How far training has come.
#[derive(Clone, Copy, Debug)]
pub(super) struct Training {
    parameters: Parameters,
    process: Process,
    motion: Motion,
    phase: Phase,
    statistics: ResidualStatistics,
    beside: Beside,
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

/// The extended Kalman filter.
#[derive(Clone, Copy, Debug)]
struct Filter {
    rls: RlsState<COUNT>,
    sd: [f32; COUNT],
    tangent: Tangent,
    beside: BesideTangent,
    gradient: [[f32; COUNT]; 2],
    residual: [f32; 2],
    noise: [ResidualNoise; 2],
    answer: f32,
    /// On which tick T1 and T2 answered to the heat.
    answered: [Option<u32>; 2],
    started: bool,
}

/// What is known of a residual's noise: mean, variance and covariance with the one before.
#[derive(Clone, Copy, Debug)]
struct ResidualNoise {
    mean: f32,
    variance: f32,
    covariance: f32,
}

impl ResidualNoise {
    const UNKNOWN: Self = Self { mean: 0.0, variance: NOISE_VARIANCE, covariance: RHO * NOISE_VARIANCE };

    fn follow(&mut self, e: f32, before: f32) {
        NOISE_MEMORY.follow(&mut self.mean, e);
        let (now, then) = (bounded(e - self.mean, -1.0, 1.0), bounded(before - self.mean, -1.0, 1.0));
        NOISE_MEMORY.follow(&mut self.variance, now * now);
        NOISE_MEMORY.follow(&mut self.covariance, now * then);
    }

    /// The share of the residual before that whitens this one, and the standard deviation of what is left, degC.
    fn whitening(&self) -> (f32, f32) {
        let rho = bounded(self.covariance / self.variance, RHOS.0, RHOS.1);
        (rho, larger(LEAST_SIGMA, sqrt(self.variance * (1.0 - rho * rho))))
    }
}

/// What training gives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trained {
    pub(super) parameters: Parameters,
    pub(super) motion: Motion,
    pub(super) ladder: Ladder,
    pub(super) mean: [f32; 2],
    pub(super) beside: Beside,
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
    pub(super) fit_samples: u32,
    pub(super) check_samples: u32,
}

impl Trainer {
    /// Of a plant that answers within `answer` ticks and has about the gain `usual`, degC per %.
    pub(super) fn new(
        fit_samples: u32,
        check_samples: u32,
        answer: f32,
        usual: f32,
    ) -> Result<Self, ConfigError> {
        let mut prior = PRIOR;
        prior[Parameter::Gain as usize].0 = libm::logf(usual);
        prior[Parameter::Heater as usize].0 = libm::logf(HEATER_SHARE * answer);
        prior[Parameter::WallTime as usize].0 = libm::logf(WALL_ANSWERS * answer);
        let adaptation = Adaptation::RandomWalk { r1: 0.0, r2: 1.0 };
        let rls = Rls::new(&RlsConfig { adaptation, d_initial: 1.0, d_max: 1.0 })?;
        Ok(Self { rls, prior, answer, inputs: Inputs::ALL, fit_samples, check_samples })
    }

    /// The same of a rig that lacks some inputs.
    pub(super) fn with(mut self, inputs: Inputs) -> Self {
        self.inputs = inputs;
        if !inputs.t0 {
            self.prior[Parameter::Offset1 as usize].1 = INTERCEPT_SD;
            self.prior[Parameter::Offset2 as usize].1 = INTERCEPT_SD;
        }
        if !inputs.t2 {
            let (heater, _) = self.prior[Parameter::Heater as usize];
            self.prior[Parameter::Reaches2 as usize] = beside::SHARE;
            self.prior[Parameter::Lag2 as usize] = (heater + beside::LAG.0, beside::LAG.1);
        }
        self
    }

    pub(super) fn start(&self) -> Training {
        let parameters = Parameters(self.prior.map(|(mean, _)| mean));
        Training {
            parameters,
            process: Process::new(&parameters, 1.0),
            motion: Motion::default(),
            phase: Phase::Fitting(Filter {
                rls: self.rls.start(),
                sd: self.prior.map(|(_, sd)| sd),
                answer: self.answer,
                tangent: Tangent::default(),
                beside: BesideTangent::default(),
                gradient: [[0.0; COUNT]; 2],
                residual: [0.0; 2],
                noise: [ResidualNoise::UNKNOWN; 2],
                answered: [None; 2],
                started: false,
            }),
            statistics: ResidualStatistics::default(),
            beside: Beside::default(),
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
                s.beside = Beside::steady(&s.parameters, beside);
                s.process = Process::new(&s.parameters, 1.0);
                return Ok(None);
            }
            s.ticks = s.ticks.saturating_add(1);
            if fit_to_learn && s.count == 0 {
                filter.reopen(&mut s.parameters, self.inputs);
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
                s.curvature_error = filter.error(Parameter::Curvature);
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
        if delay >= LONGEST_DELAY {
            return Err(RejectReason::DeadTime);
        }
        Ok(Some(Trained {
            parameters: s.parameters,
            motion: s.motion,
            ladder: s.statistics.finish(self.inputs.channels())?,
            mean: s.statistics.mean().map(|mean| MEAN_SHARE * mean),
            beside: s.beside,
            power: u,
            rise: s.statistics.level(0),
            curvature_error: s.curvature_error,
        }))
    }
}

impl Filter {
    /// Begins cold, with the offsets as they are read, or warm, from about where the rig is.
    fn begin(
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
        if y.iter().all(|y| y.abs() < COLD) {
            let mut cold = *cold;
            cold.step(y.map(Some), true);
            for (m, which) in [Parameter::Offset1, Parameter::Offset2].into_iter().enumerate() {
                let (mean, sd) = cold.offset(m);
                p.set(which, mean);
                self.sd[which as usize] = sd;
            }
            return;
        }
        self.answered = [Some(0); 2];
        if u > 1.0 && y[0] > 0.0 {
            p.set(Parameter::Gain, libm::logf(y[0] / u));
            *motion = Motion::steady(u);
        }
    }

    /// Standard deviation of a parameter as far as it is known.
    fn error(&self, of: Parameter) -> f32 {
        self.sd[of as usize] * sqrt(larger(0.0, self.rls.variances()[of as usize]))
    }

    /// The first heat has shown about how the rig answers, from a model that was wrong: what moves is learnt anew from there.
    fn reopen(&mut self, p: &mut Parameters, inputs: Inputs) {
        if inputs.t2 {
            exchange_lags(p);
        }
        let variances = self.rls.variances();
        self.rls.forget_correlations();
        for (i, (d, was)) in self.rls.d_mut().iter_mut().zip(variances).enumerate() {
            let moves = !STANDS.contains(&i);
            *d = if moves { larger(was, REOPENED) } else { was };
        }
    }

    /// A tick without samples: the model goes on, and the residuals as far as they are known.
    fn pass(&mut self, p: &Parameters, process: &Process, motion: &mut Motion, power: f32) {
        (_, self.gradient) = self.tangent.step(p, process, motion, power);
        for (e, noise) in self.residual.iter_mut().zip(&self.noise) {
            *e *= noise.whitening().0;
        }
    }

    /// One tick; gives the residuals, degC.
    #[expect(clippy::too_many_arguments, reason = "the parts of a training, borrowed one by one")]
    fn step(
        &mut self,
        trainer: &Trainer,
        p: &mut Parameters,
        process: &mut Process,
        motion: &mut Motion,
        (beside, power_beside): (&mut Beside, f32),
        y: [f32; 2],
        power: f32,
        ticks: u32,
        learning: bool,
    ) -> [f32; 2] {
        let (mut rises, mut gradient) = self.tangent.step(p, process, motion, power);
        let inputs = trainer.inputs;
        if !inputs.t2 {
            let (added, by) = self.beside.step(beside, p, power_beside);
            rises.y = rises.y.map(|y| y + added);
            for (which, by) in [Parameter::Gain, Parameter::Reaches2, Parameter::Lag2].into_iter().zip(by) {
                gradient[0][which as usize] += by;
            }
        }
        let offsets = [p.get(Parameter::Offset1), p.get(Parameter::Offset2)];
        let e: [f32; 2] = core::array::from_fn(|m| y[m] - rises.y[m] - offsets[m]);
        self.listen(p, [y[0] - offsets[0], y[1] - offsets[1]], ticks);
        let first = FIRST_ERROR * libm::expf(-(ticks as f32) / (FIRST_ANSWERS * self.answer));
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
                    gradient[m][held as usize] = 0.0;
                }
            }
            let (rho, sigma) = self.noise[m].whitening();
            let wrong = first * (y[m] - offsets[m]);
            let scale = 1.0 / sqrt(VAGUE * sigma * sigma + wrong * wrong);
            let phi: [f32; COUNT] =
                core::array::from_fn(|i| scale * self.sd[i] * (gradient[m][i] - rho * self.gradient[m][i]));
            let innovation = scale * (e[m] - rho * self.residual[m]);
            self.rls.theta = [0.0; COUNT];
            trainer.rls.step_clipped(&mut self.rls, &phi, innovation, LIMIT);
            for i in 0..COUNT {
                p.0[i] += self.sd[i] * bounded(self.rls.theta[i], -LARGEST_STEP, LARGEST_STEP);
            }
        }
        self.gradient = gradient;
        self.residual = e;
        bound(p, self.answer, inputs);
        *process = Process::new(p, 1.0);
        if !inputs.t2 {
            beside.follow(p);
        }
        e
    }

    /// Until a thermistor answers to the first heat, its dead time is at least as long as that has been.
    fn listen(&mut self, p: &mut Parameters, rise: [f32; 2], ticks: u32) {
        let now = ticks as f32;
        if self.answered[0].is_none() && rise[0] > ANSWERS {
            self.answered[0] = Some(ticks);
            let delay = larger(p.get(Parameter::Delay1), now - 1.5);
            p.set(Parameter::Delay1, delay);
        }
        if self.answered[1].is_none() && rise[1] > ANSWERS {
            self.answered[1] = Some(ticks);
            let later = 0.5 * (now - self.answered[0].map_or(now, |first| first as f32));
            let delay = larger(p.get(Parameter::Delay2), later);
            p.set(Parameter::Delay2, delay);
        }
    }
}

/// For T1 its own lag and the heater's can be exchanged: the longer is taken for the heater's, which T2 has as well, and T2's so that its
/// whole delay stays.
fn exchange_lags(p: &mut Parameters) {
    use Parameter::{Heater, Lag1, Lag2};
    let [heater, lag1, lag2] = [Heater, Lag1, Lag2].map(|which| libm::expf(p.get(which)));
    let both = heater + lag1;
    if lag1 > OWN_SHARE * both {
        let longer = larger(heater, lag1).max((1.0 - OWN_SHARE) * both);
        p.set(Heater, libm::logf(longer));
        p.set(Lag1, libm::logf(larger(0.1, both - longer)));
        p.set(Lag2, libm::logf(larger(0.2 * lag2, lag2 + heater - longer)));
    }
}

/// A T2 that is missing is T1's twin: what was learnt in its place is kept elsewhere.
fn make_twin(p: &mut Parameters, motion: &mut Motion) {
    use Parameter::{Delay2, Lag1, Lag2, Offset1, Offset2, Reaches2, Wall2};
    for (which, value) in
        [(Reaches2, 1.0), (Delay2, 0.0), (Wall2, 0.0), (Lag2, p.get(Lag1)), (Offset2, p.get(Offset1))]
    {
        p.set(which, value);
    }
    motion.m[1] = motion.m[0];
    motion.w[1] = motion.w[0];
}

/// Holds the parameters where the model means something.
fn bound(p: &mut Parameters, answer: f32, inputs: Inputs) {
    let mut within =
        |which: Parameter, (low, high): (f32, f32)| p.set(which, bounded(p.get(which), low, high));
    within(Parameter::Heater, HEATER);
    within(Parameter::Delay1, (0.0, LONGEST_DELAY));
    within(Parameter::Delay2, (0.0, LONGEST_DELAY));
    within(Parameter::Reaches2, if inputs.t2 { REACHES } else { beside::SHARES });
    let wall = |answers: f32| libm::logf(answers * answer);
    within(Parameter::WallTime, (wall(WALL_BOUNDS.0), wall(WALL_BOUNDS.1)));
    within(Parameter::Lag1, (-3.0, 6.0));
    within(Parameter::Lag2, (-3.0, 6.0));
    within(Parameter::Wall1, (-0.2, 0.6));
    within(Parameter::Wall2, (-0.2, 0.6));
    within(Parameter::Gain, (-6.0, 3.0));
    let offset = if inputs.t0 { OFFSET } else { OFFSET_SPAN * INTERCEPT_SD };
    within(Parameter::Offset1, (-offset, offset));
    within(Parameter::Offset2, (-offset, offset));
    within(Parameter::Curvature, (-0.2, 0.2));
}

#[cfg(test)]
mod tests;
