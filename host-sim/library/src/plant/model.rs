//! A model that is learnt once by the core's own estimator, and then frozen.

use anyhow::ensure;
use fdi_core::identify::rls::Rls;
use fdi_core::identify::{Adaptation, RlsConfig};

use super::settings::Model;

/// Parameters that a model has room for. Those that it does not use see a regressor of 0 and stay 0.
pub(super) const PARAMETERS: usize = 16;

/// Each counts as much as any other: nothing is forgotten while a model is learnt. The variance at the start is the trainer's: nothing is known.
const LEARN: RlsConfig =
    RlsConfig { adaptation: Adaptation::Forgetting { lambda: 1.0 }, d_initial: 1e4, d_max: 1e5 };

/// Mean and standard deviation of a signal while nothing is wrong.
#[derive(Clone, Copy, Debug)]
pub(super) struct Usual {
    /// Mean.
    pub(super) mean: f32,
    /// Standard deviation; 1 of a signal that never moved.
    pub(super) sd: f32,
}

impl Usual {
    /// Of the values that there are.
    pub(super) fn of(values: &[f32]) -> Self {
        let n = values.len().max(1) as f64;
        let mean = values.iter().map(|x| f64::from(*x)).sum::<f64>() / n;
        let variance = values.iter().map(|x| (f64::from(*x) - mean).powi(2)).sum::<f64>() / n;
        let sd = variance.sqrt() as f32;
        Self { mean: mean as f32, sd: if sd > 0.0 { sd } else { 1.0 } }
    }

    /// A value in standard deviations.
    pub(super) fn scaled(&self, x: f32) -> f32 {
        (x - self.mean) / self.sd
    }
}

/// A model as it was learnt.
#[derive(Clone, Debug)]
pub(super) struct Frozen {
    target: usize,
    /// Signal and age of each regressor, in samples.
    lags: Vec<(usize, usize)>,
    theta: [f32; PARAMETERS],
}

impl Frozen {
    /// Learns from scaled signals.
    ///
    /// # Errors
    /// The signals are shorter than the model's memory.
    pub(super) fn learn(model: &Model, scaled: &[Vec<f32>]) -> anyhow::Result<Self> {
        let of =
            |signal: usize, from: usize, order: usize| (from..from + order).map(move |age| (signal - 1, age));
        let inputs = model.inputs.iter().flat_map(|input| of(input.signal, input.delay, input.order));
        let lags: Vec<_> = of(model.output, 1, model.order).chain(inputs).collect();
        let mut learnt = Self { target: model.output - 1, lags, theta: [0.0; PARAMETERS] };
        let count = scaled[learnt.target].len();
        ensure!(
            count > learnt.oldest() + PARAMETERS,
            "model {}: nothing can be learnt from {count} samples",
            model.name
        );
        let rls = Rls::<PARAMETERS>::new(&LEARN)?;
        let mut state = rls.start();
        for k in learnt.oldest()..count {
            rls.step(&mut state, &learnt.regressor(scaled, k), scaled[learnt.target][k]);
        }
        learnt.theta = state.theta;
        Ok(learnt)
    }

    /// What it leaves of each sample, made from those before it; 0 while it lacks some.
    pub(super) fn innovations(&self, scaled: &[Vec<f32>]) -> Vec<f32> {
        let left = |k: usize| {
            if k < self.oldest() {
                return 0.0;
            }
            let regressor = self.regressor(scaled, k);
            scaled[self.target][k] - self.theta.iter().zip(&regressor).map(|(a, x)| a * x).sum::<f32>()
        };
        (0..scaled[self.target].len()).map(left).collect()
    }

    fn oldest(&self) -> usize {
        self.lags.iter().map(|(_, age)| *age).max().unwrap_or(0)
    }

    /// Past values, and the constant behind them.
    fn regressor(&self, scaled: &[Vec<f32>], k: usize) -> [f32; PARAMETERS] {
        let mut regressor = [0.0; PARAMETERS];
        for (x, (signal, age)) in regressor.iter_mut().zip(&self.lags) {
            *x = scaled[*signal][k - age];
        }
        regressor[self.lags.len()] = 1.0;
        regressor
    }
}
