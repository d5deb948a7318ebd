//! ARX(NA, NB, NK) identified by recursive least squares, sample by sample, without intercept and without removal of
//! means: an offset of a sensor shows only because it changes the gain (specified so; see docs/theory.md).

use super::config::IdentificationConfig;
use super::rls::{Rls, RlsState};
use super::transfer::Transfer;
use crate::error::ConfigError;
use crate::vector::{dot, shift};

/// A validated ARX estimator; `N` must be `NA + NB`.
#[derive(Clone, Copy, Debug)]
pub struct Arx<const NA: usize, const NB: usize, const NK: usize, const N: usize> {
    rls: Rls<N>,
    inv_y_scale: f32,
    inv_u_scale: f32,
    y_scale: f32,
}

/// The memory of an [`Arx`].
#[derive(Clone, Copy, Debug)]
pub struct ArxState<const NA: usize, const NB: usize, const NK: usize, const N: usize> {
    /// The estimator.
    pub rls: RlsState<N>,
    /// Regressor of the next sample, scaled: -y[k-1] .. -y[k-NA], u[k-NK] .. u[k-NK-NB+1].
    phi: [f32; N],
    /// u[k-1] .. u[k-NK], scaled.
    delay: [f32; NK],
    /// Consecutive valid values of y and of u that lie in the past.
    y_known: u8,
    u_known: u8,
}

/// What one sample did to the model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArxStep {
    /// One-step prediction of y, made before the update; `None` until the regressor is complete.
    pub prediction: Option<f32>,
    /// Whether the parameters were updated; they are held on a missing sample and until the regressor has no gap.
    pub updated: bool,
    /// The estimator was reset, see [`super::rls::Update::diverged`].
    pub diverged: bool,
}

impl<const NA: usize, const NB: usize, const NK: usize, const N: usize> Arx<NA, NB, NK, N> {
    const ORDERS_FIT: () = assert!(
        NA + NB == N && NA >= 1 && NB >= 1 && NK >= 1 && NA < 256 && NB + NK < 256,
        "N must be NA + NB, each at least 1"
    );

    /// Builds the estimator.
    ///
    /// # Errors
    /// The parameter that is out of bounds.
    pub fn new(c: &IdentificationConfig) -> Result<Self, ConfigError> {
        let () = Self::ORDERS_FIT;
        c.validate()?;
        let (y_scale, u_scale) = (c.y_scale.0, c.u_scale.0);
        Ok(Self { rls: Rls::new(&c.rls())?, inv_y_scale: 1.0 / y_scale, inv_u_scale: 1.0 / u_scale, y_scale })
    }

    /// A model that knows nothing.
    pub fn start(&self) -> ArxState<NA, NB, NK, N> {
        ArxState { rls: self.rls.start(), phi: [0.0; N], delay: [0.0; NK], y_known: 0, u_known: 0 }
    }

    /// One sample: `y[k]` (`None` where it is invalid) and `u[k]`, the input applied from now to the next sample.
    pub fn step(&self, state: &mut ArxState<NA, NB, NK, N>, y: Option<f32>, u: f32) -> ArxStep {
        let complete = usize::from(state.y_known) >= NA && usize::from(state.u_known) >= NB + NK - 1;
        let mut step = ArxStep::default();
        if complete {
            match y {
                Some(y) => {
                    let update = self.rls.step(&mut state.rls, &state.phi, y * self.inv_y_scale);
                    step.prediction = Some(update.prediction * self.y_scale);
                    step.updated = !update.diverged;
                    step.diverged = update.diverged;
                }
                None => step.prediction = Some(dot(&state.rls.theta, &state.phi) * self.y_scale),
            }
        }
        self.remember(state, y, u);
        step
    }

    /// Shifts y[k] and u[k] into the regressor.
    fn remember(&self, state: &mut ArxState<NA, NB, NK, N>, y: Option<f32>, u: f32) {
        shift(&mut state.delay, u * self.inv_u_scale);
        shift(&mut state.phi, -y.unwrap_or(0.0) * self.inv_y_scale);
        state.phi[NA] = state.delay[NK - 1];
        state.y_known = if y.is_some() { state.y_known.saturating_add(1) } else { 0 };
        state.u_known = state.u_known.saturating_add(1);
    }

    /// The identified model, in the units of y and u.
    pub fn transfer(&self, state: &ArxState<NA, NB, NK, N>) -> Transfer<NA, NB> {
        let theta = &state.rls.theta;
        let to_units = self.y_scale * self.inv_u_scale;
        Transfer {
            a: core::array::from_fn(|i| theta[i]),
            b: core::array::from_fn(|i| theta[NA + i] * to_units),
            nk: NK,
        }
    }
}
