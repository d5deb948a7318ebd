//! The paper's adaptive observer: an ARX model of one thermistor's rise against the applied power, with its
//! static gain and bandwidth as features (paper, sections 2.3 and 3.2).
//!
//! ```
//! use fdi_core::Seconds;
//! use fdi_core::identify::observer::Observer;
//! use fdi_core::identify::{Bandwidth, IdentificationConfig};
//!
//! let observer = Observer::new(&IdentificationConfig::default(), Some(Bandwidth::ResidenceTime), Seconds(0.11))?;
//! let (mut state, mut y) = (observer.start(), 0.0);
//! let mut seen = observer.step(&mut state, Some(y), 0.0);
//! for k in 0..2000u32 {
//!     let power = if k.wrapping_mul(0x9E37_79B9) >> 31 == 0 { 50.0 } else { 30.0 };
//!     seen = observer.step(&mut state, Some(y), power);
//!     y += 0.2 * (0.3 * power - y); // 0.3 degC per %, a time constant of half a second
//! }
//! assert!(seen.static_gain.is_some_and(|gain| (gain - 0.3).abs() < 0.01));
//! assert!(seen.bandwidth.is_some_and(|rad_per_s| rad_per_s > 0.0));
//! # Ok::<(), fdi_core::ConfigError>(())
//! ```

use super::arx::{Arx, ArxState};
use super::config::{Bandwidth, IdentificationConfig};
use super::step_response::StepResponse;
use super::transfer::Transfer;
use crate::bounds::bounded;
use crate::error::ConfigError;
use crate::units::Seconds;

/// Orders of the model: past outputs, past inputs, and the delay of the newest input in ticks (paper, section 3.2: ARX(3,3,1)).
pub const NA: usize = 3;
/// See [`NA`].
pub const NB: usize = 3;
/// See [`NA`].
pub const NK: usize = 1;

/// Samples of the step response looked at for the rise time.
const MAX_STEPS: u16 = 64;
/// Samples of it computed in a tick. The reference rig takes 15: the bandwidth is that of the model just identified.
/// Of a slower one it comes a tick later for every so many samples.
const STEPS_A_TICK: usize = 15;
/// Share of the static gain that ends the rise time: 3 / tr is 1 / tau for a first-order model only at 95 %.
const RISE_LEVEL: f32 = 0.95;
/// Bounds on the time constant by the residence time, in answer times.
const TAU_MIN: f32 = 0.025;
const TAU_MAX: f32 = 2.5;

/// A validated observer.
#[derive(Clone, Copy, Debug)]
pub struct Observer {
    arx: Arx<NA, NB, NK, { NA + NB }>,
    /// `None` where nobody asks for it.
    bandwidth: Option<Bandwidth>,
    sample_time: f32,
    /// Dead time and half a sample, in s.
    lag: f32,
    answer_time: f32,
    gain_max: f32,
}

/// The memory of an [`Observer`].
#[derive(Clone, Copy, Debug)]
pub struct ObserverState {
    arx: ArxState<NA, NB, NK, { NA + NB }>,
    static_gain: Option<f32>,
    bandwidth: Option<f32>,
    /// The last attempt at the bandwidth failed.
    bandwidth_held: bool,
    /// Step response of the model as it was when the last one was done.
    response: Option<StepResponse<NA, NB>>,
}

/// What an observer says after one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Identified {
    /// One-step prediction in degC, made before this sample was learnt from.
    pub prediction: Option<f32>,
    /// Static gain in degC per %; the last valid one while the model has none.
    pub static_gain: Option<f32>,
    /// Bandwidth in rad/s; the last valid one while the model has none.
    pub bandwidth: Option<f32>,
    /// The model was not updated on this sample.
    pub held: bool,
    /// The static gain is an old one: the model is an integrator or beyond `gain_max`.
    pub gain_held: bool,
    /// The bandwidth is an old one: the model is unstable, or its step response never arrives.
    pub bandwidth_held: bool,
    /// The estimator was reset on this sample.
    pub diverged: bool,
    /// Resets since the start.
    pub resets: u32,
}

impl Observer {
    /// Builds an observer of the static gain, and of the bandwidth if one is given.
    ///
    /// # Errors
    /// The parameter that is out of bounds.
    pub fn new(
        c: &IdentificationConfig,
        bandwidth: Option<Bandwidth>,
        sample_time: Seconds,
    ) -> Result<Self, ConfigError> {
        Ok(Self {
            arx: Arx::new(c)?,
            bandwidth,
            sample_time: sample_time.0,
            lag: c.dead_time.0 + 0.5 * sample_time.0,
            answer_time: c.answer_time.0,
            gain_max: c.gain_max,
        })
    }

    /// An observer that knows nothing.
    pub fn start(&self) -> ObserverState {
        ObserverState {
            arx: self.arx.start(),
            static_gain: None,
            bandwidth: None,
            bandwidth_held: true,
            response: None,
        }
    }

    /// One sample: the rise `y[k]` in degC (`None` where it is invalid) and the power applied from now on, in %.
    pub fn step(&self, state: &mut ObserverState, y: Option<f32>, power: f32) -> Identified {
        let step = self.arx.step(&mut state.arx, y, power);
        let mut gain = None;
        if step.updated {
            let model = self.arx.transfer(&state.arx);
            gain = model.static_gain().filter(|g| g.abs() <= self.gain_max);
            state.static_gain = gain.or(state.static_gain);
            match self.bandwidth {
                Some(Bandwidth::RiseTime) => self.follow_response(state, &model, gain),
                Some(Bandwidth::ResidenceTime) => state.take_bandwidth(self.by_residence_time(&model, gain)),
                None => {}
            }
        } else if step.diverged {
            state.response = None;
        }
        Identified {
            prediction: step.prediction,
            static_gain: state.static_gain,
            bandwidth: state.bandwidth,
            held: !step.updated,
            gain_held: gain.is_none(),
            bandwidth_held: state.bandwidth_held || !step.updated,
            diverged: step.diverged,
            resets: state.arx.rls.resets,
        }
    }

    /// Computes the next samples of the step response, and begins a new one behind each that has arrived.
    fn follow_response(&self, state: &mut ObserverState, model: &Transfer<NA, NB>, gain: Option<f32>) {
        let Some(mut response) = state.response.or_else(|| begin_response(model, gain)) else {
            state.bandwidth_held = true;
            return;
        };
        let crossing = response.advance::<STEPS_A_TICK>();
        if crossing.is_none() && response.samples() < MAX_STEPS {
            state.response = Some(response);
            return;
        }
        state.response = None;
        let time = crossing.filter(|&samples| samples > 0.0);
        state.take_bandwidth(time.map(|samples| 3.0 / (samples * self.sample_time)));
    }

    fn by_residence_time(&self, model: &Transfer<NA, NB>, gain: Option<f32>) -> Option<f32> {
        if !has_response(model, gain?) {
            return None;
        }
        let tau = model.residence_time()? * self.sample_time - self.lag;
        Some(1.0 / bounded(tau, TAU_MIN * self.answer_time, TAU_MAX * self.answer_time))
    }

    /// The model as it stands.
    pub fn model(&self, state: &ObserverState) -> Transfer<NA, NB> {
        self.arx.transfer(&state.arx)
    }
}

impl ObserverState {
    /// Takes over a bandwidth, or keeps the last one.
    fn take_bandwidth(&mut self, bandwidth: Option<f32>) {
        self.bandwidth_held = bandwidth.is_none();
        self.bandwidth = bandwidth.or(self.bandwidth);
    }
}

fn begin_response(model: &Transfer<NA, NB>, gain: Option<f32>) -> Option<StepResponse<NA, NB>> {
    let gain = gain.filter(|&gain| has_response(model, gain))?;
    Some(StepResponse::new(*model, RISE_LEVEL * gain))
}

/// Whether the step response is that of a heater: it rises, and it ends.
fn has_response(model: &Transfer<NA, NB>, gain: f32) -> bool {
    gain > 0.0 && model.is_stable()
}
