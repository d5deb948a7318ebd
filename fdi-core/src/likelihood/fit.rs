//! Models of the rig, fitted in fault-free operation by least squares without forgetting, then frozen.

use super::model::{Model, Simulation, shift};
use super::verdict::RejectReason;
use crate::error::ConfigError;
use crate::identify::config::{Adaptation, IdentificationConfig, RlsConfig};
use crate::identify::rls::{Rls, RlsState};
use crate::identify::transfer::Transfer;

/// Orders of power -> y1: enough for dead times up to five ticks, and for the noise, which shares the denominator.
pub(super) const NA: usize = 3;
pub(super) const NB: usize = 6;
const N: usize = NA + NB;
/// Orders of y1 -> y2, which has no delay of a tick.
pub(super) const HA: usize = 2;
pub(super) const HB: usize = 4;
const HN: usize = HA + HB;

/// power -> y1 and y1 -> y2. In series they make power -> y2, better than a direct fit would: T2 is slow, and a direct
/// fit takes slow disturbance for slow dynamics.
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

/// The estimator of both models; the second uses the first [`HN`] of its parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    rls: Rls<N>,
    inv_y_scale: f32,
    inv_u_scale: f32,
    y_scale: f32,
}

/// Its memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct FitState {
    heat: RlsState<N>,
    along: RlsState<N>,
    /// Samples in a row that were valid.
    whole: usize,
    /// Measured values where a simulation has its own: the regressors, and the state that simulations begin in.
    past: Simulations,
}

impl Fit {
    pub(super) fn new(c: &IdentificationConfig) -> Result<Self, ConfigError> {
        let adaptation = Adaptation::Forgetting { lambda: 1.0 };
        let rls = RlsConfig { adaptation, d_initial: c.d_initial, d_max: c.d_max };
        let (y_scale, u_scale) = (c.y_scale.0, c.u_scale.0);
        Ok(Self { rls: Rls::new(&rls)?, inv_y_scale: 1.0 / y_scale, inv_u_scale: 1.0 / u_scale, y_scale })
    }

    pub(super) fn start(&self) -> FitState {
        let none = self.rls.start();
        FitState { heat: none, along: none, whole: 0, past: Simulations::default() }
    }

    /// Takes in one sample: rises in degC, `None` where invalid, and the power in % applied from now on.
    pub(super) fn step(&self, s: &mut FitState, y: [Option<f32>; 2], u: f32) {
        let past = &mut s.past;
        let [y1, y2] = [y[0].unwrap_or(past.y1.y[0]), y[1].unwrap_or(past.y2.y[0])];
        let usable = y[0].is_some() && y[1].is_some();
        let complete = usable && s.whole >= NB;
        s.whole = if usable { s.whole.saturating_add(1) } else { 0 };
        if complete {
            let phi = regressor(&past.y1, self.inv_y_scale, self.inv_u_scale);
            self.rls.step_first(N, &mut s.heat, &phi, y1 * self.inv_y_scale);
        }
        shift(&mut past.y1.y, y1);
        shift(&mut past.y1.u, u);
        shift(&mut past.y2.u, y1); // its newest input is of this tick
        if complete {
            let phi = regressor(&past.y2, self.inv_y_scale, self.inv_y_scale);
            self.rls.step_first(HN, &mut s.along, &phi, y2 * self.inv_y_scale);
        }
        shift(&mut past.y2.y, y2);
        past.along = past.y2;
    }

    /// The models, and simulations that go on from the last sample; or why they can't be used.
    pub(super) fn finish(&self, s: &FitState) -> Result<(Models, Simulations), RejectReason> {
        let heat = model(&s.heat.theta, self.y_scale * self.inv_u_scale);
        let along = model(&s.along.theta, 1.0);
        if !(is_stable(heat.a) && is_stable([along.a[0], along.a[1], 0.0])) {
            return Err(RejectReason::Unstable);
        }
        let sound = |gain: f32| gain > 0.0 && gain.is_finite();
        if !(sound(heat.gain()) && sound(along.gain())) {
            return Err(RejectReason::Gain);
        }
        let mut simulations = s.past;
        let next = heat.output(&simulations.y1);
        shift(&mut simulations.y1.y, next);
        Ok((Models { heat, along }, simulations))
    }
}

/// Past outputs, negated, and inputs, as far as there are; scaled.
fn regressor<const A: usize, const B: usize>(
    past: &Simulation<A, B>,
    y_scale: f32,
    u_scale: f32,
) -> [f32; N] {
    let mut phi = [0.0; N];
    let scaled = past.y.iter().map(|y| -y * y_scale).chain(past.u.iter().map(|u| u * u_scale));
    phi.iter_mut().zip(scaled).for_each(|(phi, x)| *phi = x);
    phi
}

/// The model in the order of a regressor; `scale` brings the coefficients of the input to units.
fn model<const A: usize, const B: usize>(theta: &[f32; N], scale: f32) -> Model<A, B> {
    const { assert!(A + B <= N) };
    Model { a: core::array::from_fn(|i| theta[i]), b: core::array::from_fn(|i| theta[A + i] * scale) }
}

fn is_stable(a: [f32; NA]) -> bool {
    Transfer { a, b: [0.0; 3], nk: 1 }.is_stable()
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
