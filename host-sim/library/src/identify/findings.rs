//! What is read off an estimate: parameters, static gain, bandwidth, poles, fits.

use serde::Serialize;

use super::estimate::{Estimate, Uncertain};
use super::model::{Model, Signals};
use super::poles::{Complex, roots};

/// What a model says, flat in the JSON object. What does not exist is null.
#[derive(Clone, Debug, Serialize)]
pub struct Findings {
    /// a1 .. aNA, b1 .. bNB.
    pub parameters: Vec<Parameter>,
    /// Variance of the equation error, in units of y squared.
    pub noise_variance: f64,
    /// B(1) / A(1) with its standard deviation, in units of y per unit of u.
    pub static_gain: Option<Uncertain>,
    /// Steady output while the input is zero, in units of y; null where it was not estimated.
    pub output_at_zero_input: Option<Uncertain>,
    /// 3 / t95 with the rise time t95 of the step response, rad/s.
    pub bandwidth_rad_s: Option<f64>,
    /// Why there is no bandwidth.
    pub bandwidth_reason: Option<&'static str>,
    /// Mean residence time, s: time constants and dead time together.
    pub residence_time_s: Option<f64>,
    /// Whether all poles lie inside the unit circle.
    pub stable: bool,
    /// Poles, the largest first.
    pub poles: Vec<Complex>,
}

/// A parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// a1, b1 ..
    pub name: String,
    /// Estimate.
    pub value: f64,
    /// Standard deviation; null where the data do not determine the parameter, whose value is then arbitrary.
    pub sd: Option<f64>,
}

/// Fits of a model in a range, %; null if y never moves there or the model's output is beyond all numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fits {
    /// Of the one-step prediction.
    pub one_step_fit_pct: Option<f64>,
    /// Of the simulation.
    pub simulated_fit_pct: Option<f64>,
}

impl Fits {
    /// Fits of `model` in `s`.
    pub fn new(model: &Model, s: &Signals) -> Self {
        Self {
            one_step_fit_pct: model.fit(s, &model.predict(s)),
            simulated_fit_pct: model.fit(s, &model.simulate(s)),
        }
    }
}

impl Findings {
    /// Reads everything off an estimate; `ts` is the sample time in s.
    pub fn new(e: &Estimate, ts: f64) -> Self {
        let values = e.model.a.iter().chain(&e.model.b);
        let named = e.model.order.names().zip(values).zip(&e.sd);
        let poles = roots(&e.model.a);
        let bandwidth = bandwidth(e, &poles, ts);
        Self {
            parameters: named.map(|((name, &value), &sd)| Parameter { name, value, sd }).collect(),
            noise_variance: e.noise_variance,
            static_gain: e.static_gain,
            output_at_zero_input: e.output_at_zero,
            bandwidth_rad_s: bandwidth.ok(),
            bandwidth_reason: bandwidth.err(),
            residence_time_s: bandwidth
                .ok()
                .and_then(|_| e.model.transfer().residence_time())
                .map(|n| f64::from(n) * ts),
            stable: is_stable(&poles),
            poles,
        }
    }
}

/// Whether all `poles`, the largest first, lie inside the unit circle.
pub(super) fn is_stable(poles: &[Complex]) -> bool {
    poles.first().is_none_or(|p| p.abs() < 1.0)
}

/// Share of the static gain that ends the rise time: 3 / t is 1 / tau of a first-order process only at 95 %.
const RISE_LEVEL: f32 = 0.95;
const MAX_STEPS: u16 = u16::MAX;

/// 3 / t95 in rad/s, or why there is none.
fn bandwidth(e: &Estimate, poles: &[Complex], ts: f64) -> Result<f64, &'static str> {
    if !is_stable(poles) {
        return Err("the model is unstable");
    }
    let Some(gain) = e.static_gain.map(|gain| gain.value as f32).filter(|&gain| gain != 0.0) else {
        return Err("there is no static gain");
    };
    if e.sd.contains(&None) {
        return Err("the data do not determine all parameters; lower the order");
    }
    let mut transfer = e.model.transfer();
    transfer.b = transfer.b.map(|b| b * gain.signum()); // a falling step response, seen from below, rises
    let rise = transfer.rise_time(RISE_LEVEL * gain.abs(), MAX_STEPS);
    let samples = rise.ok_or("the step response does not reach 95 % within 65535 samples")?;
    Ok(3.0 / (f64::from(samples) * ts))
}

#[cfg(test)]
mod tests {
    use super::super::model::Order;
    use super::*;

    /// A lag with the pole `pole`, static gain `gain` and delay of `nk` samples.
    fn lag(pole: f64, gain: f64, nk: usize) -> Estimate {
        Estimate {
            model: Model { order: Order { na: 1, nb: 1, nk }, a: vec![-pole], b: vec![gain * (1.0 - pole)] },
            sd: vec![Some(0.1), Some(0.1)],
            noise_variance: 1.0,
            residuals: vec![],
            weights: vec![],
            static_gain: Some(Uncertain { value: gain, sd: 0.1 }),
            output_at_zero: None,
        }
    }

    #[test]
    fn bandwidth_of_a_lag_is_one_over_its_time_constant_whatever_the_sign_of_the_gain() {
        let pole = (-0.01f64).exp(); // tau = 100 samples of 0.5 s
        for gain in [2.0, -2.0] {
            let f = Findings::new(&lag(pole, gain, 1), 0.5);
            let (bandwidth, residence) = (f.bandwidth_rad_s.unwrap(), f.residence_time_s.unwrap());
            assert!((bandwidth * 50.0 - 1.0).abs() < 0.003, "{bandwidth}");
            assert!((residence - 50.25).abs() < 0.01, "{residence}"); // tau and half a sample
            assert!(f.stable && f.bandwidth_reason.is_none());
        }
    }

    #[test]
    fn a_delay_adds_to_the_residence_time() {
        let [near, far] = [1, 11].map(|nk| Findings::new(&lag(0.9, 1.0, nk), 2.0).residence_time_s.unwrap());
        assert!((far - near - 20.0).abs() < 1e-3, "{near} {far}");
    }

    #[test]
    fn without_a_bandwidth_it_says_why() {
        let reason = |e: &Estimate| Findings::new(e, 1.0).bandwidth_reason.unwrap();
        assert_eq!(reason(&lag(1.01, 1.0, 1)), "the model is unstable");
        assert_eq!(reason(&Estimate { static_gain: None, ..lag(0.9, 1.0, 1) }), "there is no static gain");
        let undetermined = Estimate { sd: vec![Some(0.1), None], ..lag(0.9, 1.0, 1) };
        assert!(reason(&undetermined).contains("lower the order"));
        assert!(reason(&lag(0.99999, 1.0, 1)).contains("65535 samples"));
        assert_eq!(reason(&lag(0.9, 0.0, 1)), "there is no static gain");
    }
}
