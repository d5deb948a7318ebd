//! Models of the rig, fitted in fault-free operation by least squares without forgetting, then frozen.

use super::model::{Model, Simulation, shift};
use super::verdict::Distrust;
use crate::error::ConfigError;
use crate::identify::arx::{Arx, ArxState};
use crate::identify::observer::IdentificationConfig;
use crate::identify::rls::{Adaptation, RlsConfig};

/// Orders of power -> y1: enough for dead times up to five ticks, and for the noise, which shares the denominator.
pub(super) const NA: usize = 3;
pub(super) const NB: usize = 6;
const N: usize = NA + NB;
/// Orders of y1 -> y2, which has no delay of a tick.
pub(super) const HA: usize = 2;
pub(super) const HB: usize = 4;
const HN: usize = HA + HB;

/// power -> y1 and y1 -> y2. In series they make power -> y2, better than a direct fit would: T2 is slow, and a direct
/// fit takes slow wander for slow dynamics.
#[derive(Clone, Copy, Debug)]
pub(super) struct Models {
    pub(super) heat: Model<NA, NB>,
    pub(super) along: Model<HA, HB>,
}

/// The models at work.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Simulations {
    /// y1 from the power.
    pub(super) y1: Simulation<NA, NB>,
    /// y2 from the simulated y1.
    pub(super) y2: Simulation<HA, HB>,
    /// y2 from the measured y1.
    pub(super) along: Simulation<HA, HB>,
}

/// The estimators of both models.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    heat: Arx<NA, NB, 1, N>,
    along: Arx<HA, HB, 1, HN>,
}

/// Their memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct FitState {
    heat: ArxState<NA, NB, 1, N>,
    along: ArxState<HA, HB, 1, HN>,
    /// y2 of the tick before: an [`Arx`] knows no input without a delay, so its output comes a tick late.
    y2: Option<f32>,
    /// Measured values where a simulation has its own: the state that it begins in.
    past: Simulations,
}

impl Fit {
    pub(super) fn new(c: &IdentificationConfig) -> Result<Self, ConfigError> {
        let adaptation = Adaptation::Forgetting { lambda: 1.0 };
        let rls = RlsConfig { adaptation, d_initial: c.d_initial, d_max: c.d_max };
        Ok(Self {
            heat: Arx::new(&rls, c.y_scale.0, c.u_scale.0)?,
            along: Arx::new(&rls, c.y_scale.0, c.y_scale.0)?,
        })
    }

    pub(super) fn start(&self) -> FitState {
        FitState {
            heat: self.heat.start(),
            along: self.along.start(),
            y2: None,
            past: Simulations::default(),
        }
    }

    /// Takes in one sample: rises in degC, `None` where invalid, and the power in % applied from now on.
    pub(super) fn step(&self, s: &mut FitState, y: [Option<f32>; 2], u: f32) {
        let past = &mut s.past;
        let [y1, y2] = [y[0].unwrap_or(past.y1.y[0]), y[1].unwrap_or(past.y2.y[0])];
        let before = core::mem::replace(&mut s.y2, y[1]);
        self.heat.step_looped(&mut s.heat, y[0], u);
        self.along.step_looped(&mut s.along, before.filter(|_| y[0].is_some()), y1);
        shift(&mut past.y1.y, y1);
        shift(&mut past.y1.u, u);
        for far in [&mut past.y2, &mut past.along] {
            shift(&mut far.y, y2);
            shift(&mut far.u, y1);
        }
    }

    /// The models, and simulations that go on from the last sample; or why they can't be used.
    pub(super) fn finish(&self, s: &FitState) -> Result<(Models, Simulations), Distrust> {
        let (heat, along) = (self.heat.transfer(&s.heat), self.along.transfer(&s.along));
        let positive = |gain: Option<f32>| gain.is_some_and(|gain| gain > 0.0);
        if !(heat.is_stable() && along.is_stable()) {
            return Err(Distrust::Unstable);
        }
        if !(positive(heat.static_gain()) && positive(along.static_gain())) {
            return Err(Distrust::Gain);
        }
        let models = Models { heat: Model { a: heat.a, b: heat.b }, along: Model { a: along.a, b: along.b } };
        let mut simulations = s.past;
        let next = models.heat.output(&simulations.y1);
        shift(&mut simulations.y1.y, next);
        Ok((models, simulations))
    }
}

impl Models {
    /// The next tick: what y1 and y2 should be now from the power alone, and y2 from the measured y1, degC.
    pub(super) fn step(&self, s: &mut Simulations, y1_measured: f32, u: f32) -> [f32; 3] {
        let y1 = s.y1.y[0];
        let y2 = self.along.step(&mut s.y2, y1);
        let along = self.along.step(&mut s.along, y1_measured);
        self.heat.step(&mut s.y1, u);
        [y1, y2, along]
    }

    /// Ticks from a change of the power to the first sample that clearly shows it.
    pub(super) fn lead(&self) -> usize {
        let visible = 0.12 * self.heat.gain();
        let mut unit = Simulation::default();
        (1..NB).find(|_| self.heat.step(&mut unit, 1.0) >= visible).unwrap_or(NB)
    }
}
