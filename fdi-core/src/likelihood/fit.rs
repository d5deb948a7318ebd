//! Models of the rig, fitted in fault-free operation by least squares without forgetting, then frozen.

use super::verdict::RejectReason;
use crate::error::ConfigError;
use crate::identify::config::{Adaptation, IdentificationConfig, RlsConfig};
use crate::identify::rls::{Rls, RlsState};
use crate::identify::simulation::Simulation;
use crate::identify::transfer::Transfer;
use crate::vector::shift;

/// Orders of power -> y1: six taps hold dead times up to five ticks, and the noise shares the denominator. Chosen on the reference rig
/// (docs/diagnosis.md, section 1).
pub(super) const NA: usize = 3;
pub(super) const NB: usize = 6;
const N: usize = NA + NB;
/// Orders of y1 -> y2, which has no delay of a tick: chosen on the reference rig, too.
pub(super) const HA: usize = 2;
pub(super) const HB: usize = 4;
const HN: usize = HA + HB;

/// A change of the power is visible in T1 once its step response has reached this share of the static gain: more than noise
/// makes of the taps that belong to the dead time. Tuned on the reference rig.
const VISIBLE: f32 = 0.12;

/// power -> y1 and y1 -> y2. In series they make power -> y2, better than a direct fit would: T2 is slow, and a direct
/// fit takes slow disturbance for slow dynamics.
#[derive(Clone, Copy, Debug)]
pub(super) struct Models {
    pub(super) heater_to_t1: Transfer<NA, NB>,
    pub(super) t1_to_t2: Transfer<HA, HB>,
}

/// The models at work.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Simulations {
    /// y1 from the power.
    pub(super) y1: Simulation<NA, NB>,
    /// y2 from the simulated y1.
    pub(super) y2: Simulation<HA, HB>,
    /// y2 from the measured y1.
    pub(super) y2_of_y1: Simulation<HA, HB>,
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
    heater_to_t1: RlsState<N>,
    t1_to_t2: RlsState<N>,
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
        FitState { heater_to_t1: none, t1_to_t2: none, whole: 0, past: Simulations::default() }
    }

    /// One sample: rises in degC, `None` where invalid, and the power in % applied from now on.
    pub(super) fn step(&self, s: &mut FitState, y: [Option<f32>; 2], u: f32) {
        let past = &mut s.past;
        let [y1, y2] = [y[0].unwrap_or(past.y1.y[0]), y[1].unwrap_or(past.y2.y[0])];
        let usable = y[0].is_some() && y[1].is_some();
        let complete = usable && s.whole >= NB;
        s.whole = if usable { s.whole.saturating_add(1) } else { 0 };
        if complete {
            let phi = regressor(&past.y1, self.inv_y_scale, self.inv_u_scale);
            self.rls.step_first(N, &mut s.heater_to_t1, &phi, y1 * self.inv_y_scale);
        }
        shift(&mut past.y1.y, y1);
        shift(&mut past.y1.u, u);
        shift(&mut past.y2.u, y1); // its newest input is of this tick
        if complete {
            let phi = regressor(&past.y2, self.inv_y_scale, self.inv_y_scale);
            self.rls.step_first(HN, &mut s.t1_to_t2, &phi, y2 * self.inv_y_scale);
        }
        shift(&mut past.y2.y, y2);
        past.y2_of_y1 = past.y2;
    }

    /// The models, and simulations that go on from the last sample; or why they can't be used.
    pub(super) fn finish(&self, s: &FitState) -> Result<(Models, Simulations), RejectReason> {
        let heater_to_t1 = model(&s.heater_to_t1.theta, self.y_scale * self.inv_u_scale, 1);
        let t1_to_t2 = model(&s.t1_to_t2.theta, 1.0, 0);
        if !(heater_to_t1.is_stable() && t1_to_t2.is_stable()) {
            return Err(RejectReason::Unstable);
        }
        let sound = |gain: f32| gain > 0.0 && gain.is_finite();
        if !(sound(heater_to_t1.gain()) && sound(t1_to_t2.gain())) {
            return Err(RejectReason::Gain);
        }
        let mut simulations = s.past;
        let next = heater_to_t1.output(&simulations.y1);
        shift(&mut simulations.y1.y, next);
        Ok((Models { heater_to_t1, t1_to_t2 }, simulations))
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
fn model<const A: usize, const B: usize>(theta: &[f32; N], scale: f32, nk: usize) -> Transfer<A, B> {
    const { assert!(A + B <= N) };
    Transfer { a: core::array::from_fn(|i| theta[i]), b: core::array::from_fn(|i| theta[A + i] * scale), nk }
}

impl Models {
    /// The next tick: what y1 and y2 should be now from the power alone, and y2 from the measured y1, degC.
    pub(super) fn step(&self, s: &mut Simulations, y1_measured: f32, u: f32) -> [f32; 3] {
        let y1 = s.y1.y[0];
        let y2 = self.t1_to_t2.simulate(&mut s.y2, y1);
        let y2_of_y1 = self.t1_to_t2.simulate(&mut s.y2_of_y1, y1_measured);
        self.heater_to_t1.simulate(&mut s.y1, u);
        [y1, y2, y2_of_y1]
    }

    /// Ticks from a change of the power to the first sample that clearly shows it.
    pub(super) fn dead_ticks(&self) -> usize {
        let visible = VISIBLE * self.heater_to_t1.gain();
        let mut unit = Simulation::default();
        (1..NB).find(|_| self.heater_to_t1.simulate(&mut unit, 1.0) >= visible).unwrap_or(NB)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{Celsius, Percent};

    /// A rig of the models' own form, in f64: what it does is found again, and the simulation goes on where it is.
    #[test]
    fn a_rig_of_the_models_form_is_found_again() {
        let config = IdentificationConfig {
            y_scale: Celsius(12.5),
            u_scale: Percent(41.7),
            ..IdentificationConfig::default()
        };
        let fit = Fit::new(&config).unwrap();
        let (mut s, mut seed) = (fit.start(), 5u32);
        let (mut y1, mut y2, mut u) = ([0.0f64; 2], [0.0f64; 2], [0.0f64; 3]);
        for k in 0..2000 {
            // y1 = 0.8 y1 + 0.02 u[k-2] + 0.03 u[k-3];  y2 = 0.6 y2 + 0.3 y1 + 0.06 y1[k-1]
            let next = 0.8 * y1[0] + 0.02 * u[1] + 0.03 * u[2];
            y1 = [next, y1[0]];
            y2 = [0.6 * y2[0] + 0.3 * y1[0] + 0.06 * y1[1], y2[0]];
            seed = seed.wrapping_mul(1664525).wrapping_add(1013904223);
            let power = if seed >> 31 == 0 { 35.0 } else { 45.0 };
            u = [power, u[0], u[1]];
            let lost = k % 97 == 5;
            fit.step(&mut s, [(!lost).then_some(y1[0] as f32), Some(y2[0] as f32)], power as f32);
        }
        let (models, mut simulations) = fit.finish(&s).unwrap();
        assert!((models.heater_to_t1.gain() - 0.25).abs() < 1e-3, "{models:?}");
        assert!((models.t1_to_t2.gain() - 0.9).abs() < 1e-3, "{models:?}");
        assert_eq!(models.dead_ticks(), 3, "0.02 of 0.25 is not visible yet, 0.066 is");
        for _ in 0..50 {
            let next = 0.8 * y1[0] + 0.02 * u[1] + 0.03 * u[2];
            y1 = [next, y1[0]];
            y2 = [0.6 * y2[0] + 0.3 * y1[0] + 0.06 * y1[1], y2[0]];
            u = [60.0, u[0], u[1]];
            let [s1, s2, s3] = models.step(&mut simulations, y1[0] as f32, 60.0);
            for (simulated, wanted) in [(s1, y1[0]), (s2, y2[0]), (s3, y2[0])] {
                assert!((f64::from(simulated) - wanted).abs() < 0.02, "{simulated} instead of {wanted}");
            }
        }
    }

    #[test]
    fn what_has_not_been_excited_is_no_model() {
        let fit = Fit::new(&IdentificationConfig::default()).unwrap();
        assert_eq!(fit.finish(&fit.start()).err(), Some(RejectReason::Gain), "nothing seen");
    }
}
