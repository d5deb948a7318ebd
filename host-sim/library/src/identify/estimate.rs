//! Least squares over a recording by the core's recursion: sample by sample, in single precision, as on the board.
//!
//! Lagged values of a signal that is sampled fast are nearly the same, and in single precision their small differences,
//! which hold the dynamics, drown. The regressors are therefore backward differences, taken in double precision and each
//! scaled to a root mean square of one (the delta operator; R. H. Middleton, G. C. Goodwin, "Digital Control and
//! Estimation", 1990):
//!
//! ```text
//! y[k] - y[k-1] = sum_(i < NA) alpha_i D^i y[k-1] + sum_(i < NB) beta_i D^i u[k-NK],   D x[k] = x[k] - x[k-1]
//! D^i x[k] = sum_(j <= i) (-1)^j binomial(i, j) x[k-j]
//! ```
//!
//! which is the ARX model in other coordinates: same data, same minimum. One estimator of the largest size serves all
//! orders, as a regressor that is always zero changes no other number.

use std::ops::Range;

use anyhow::{bail, ensure};
use fdi_core::identify::rls::{Rls, RlsState};
use fdi_core::identify::{Adaptation, RlsConfig};

use super::model::{Model, ORDER_MAX, Order, Signals, mean, rms};

/// D at the start: a scaled parameter is expected within 1e4 or so of zero.
const D_INITIAL: f32 = 1e8;
/// A scaled variance above this share of [`D_INITIAL`] comes from the start, not from the data. Below it, the start
/// pulls an estimate by less than this share.
const UNDETERMINED: f64 = 1e-3;

/// Those of the largest order, and a constant.
const PARAMETERS_MAX: usize = 2 * ORDER_MAX + 1;
type Estimator = Rls<PARAMETERS_MAX>;
type State = RlsState<PARAMETERS_MAX>;

/// An identified model and how sure it is.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The model.
    pub model: Model,
    /// Standard deviations of a1 .. aNA, b1 .. bNB; `None` where the data do not determine the parameter.
    pub sd: Vec<Option<f64>>,
    /// Variance of the equation error, in units of y squared.
    pub noise_variance: f64,
    /// y minus its one-step prediction by the final model, from row [`Order::memory`] on.
    pub residuals: Vec<f64>,
    /// What each residual weighed: `lambda^(age in samples)`.
    pub weights: Vec<f64>,
    /// Static gain B(1) / A(1), in units of y per unit of u; `None` on an integrator and where the data do not determine
    /// it.
    pub static_gain: Option<Uncertain>,
    /// Steady output at zero input, in units of y; `None` where it was not estimated, and where there is no static gain.
    pub output_at_zero: Option<Uncertain>,
}

/// A number with its standard deviation by the delta method.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Uncertain {
    /// The estimate.
    pub value: f64,
    /// Its standard deviation.
    pub sd: f64,
}

/// Identifies a model of `order` from `s`, forgetting by `lambda`. Its output is zero when its input is.
///
/// # Errors
/// Too few rows, or too short a memory, for so many parameters; numbers that the estimator could not live with.
pub fn estimate(s: &Signals, order: Order, lambda: f64) -> anyhow::Result<Estimate> {
    solve(s, order, lambda, None)
}

/// The same with one parameter more: a constant in the equation, from which follows the output at zero input. Unlike the
/// removal of means it is right for a transient, too, whose means are no steady state (L. Ljung, "System Identification",
/// 2nd edition, 1999, section 14.1).
///
/// # Errors
/// Those of [`estimate`].
pub fn estimate_with_constant(s: &Signals, order: Order, lambda: f64) -> anyhow::Result<Estimate> {
    let removed = Removed { u: mean(&s.u), y: mean(&s.y) }; // so that the constant is no near copy of u and y
    solve(&s.minus(removed.u, removed.y), order, lambda, Some(removed))
}

/// What was taken off the signals before the estimation.
#[derive(Clone, Copy, Debug)]
struct Removed {
    u: f64,
    y: f64,
}

/// Estimates, with a constant if something was `removed`.
fn solve(s: &Signals, order: Order, lambda: f64, removed: Option<Removed>) -> anyhow::Result<Estimate> {
    let parameters = order.parameters() + usize::from(removed.is_some());
    let (rows, least) = (s.y.len(), order.memory() + parameters + 1);
    ensure!(rows >= least, "{rows} rows are too few: {parameters} parameters need at least {least}");
    let weights = weights(rows - order.memory(), lambda);
    let total: f64 = weights.iter().sum();
    let spread = spread(&weights);
    let freedom = total - spread * parameters as f64;
    ensure!(freedom > 0.0, "a memory of {total:.1} rows is too short: raise --lambda or lower --order");

    let basis = Basis::new(s, order, removed.is_some());
    let rls = Rls::new(&RlsConfig {
        adaptation: Adaptation::Forgetting { lambda: lambda as f32 },
        d_initial: D_INITIAL,
        d_max: D_INITIAL,
    })?;
    let state = learn(&rls, s, &basis)?;
    let (model, constant) = (basis.model(&state), basis.constant_of(&state));
    let measured = &s.y[order.memory()..];
    let residuals: Vec<f64> =
        measured.iter().zip(model.predict(s)).map(|(y, predicted)| y - predicted - constant).collect();
    let squares: f64 = residuals.iter().zip(&weights).map(|(e, w)| w * e * e).sum();
    let noise_variance = squares / freedom;
    ensure!(noise_variance.is_finite(), "the values are too large to be squared: scale them down");
    let uncertainty = Uncertainty {
        rls: &rls,
        state: &state,
        lambda,
        noise_sd: (spread * noise_variance).sqrt(),
        basis: &basis,
    };
    let (sd, static_gain) = (uncertainty.of_parameters(), uncertainty.of_gain(&model));
    let output_at_zero = removed.and_then(|removed| uncertainty.of_output_at_zero(&model, constant, removed));
    Ok(Estimate { model, sd, noise_variance, residuals, weights, static_gain, output_at_zero })
}

/// `lambda^(n-1) .. lambda^0`.
fn weights(n: usize, lambda: f64) -> Vec<f64> {
    let mut weights = vec![1.0; n];
    for i in (1..n).rev() {
        weights[i - 1] = weights[i] * lambda;
    }
    weights
}

/// `sum w^2 / sum w`: with weights w, the covariance of the parameters is this times the noise variance times P. It is
/// exact with lambda = 1, and else holds as far as the regressors look alike throughout.
fn spread(weights: &[f64]) -> f64 {
    weights.iter().map(|w| w * w).sum::<f64>() / weights.iter().sum::<f64>()
}

/// Runs the estimator over all rows.
fn learn(rls: &Estimator, s: &Signals, basis: &Basis) -> anyhow::Result<State> {
    let mut state = rls.start();
    for k in basis.order.memory()..s.y.len() {
        let update = rls.step(&mut state, &basis.regressor(s, k), basis.target(s, k));
        if update.diverged {
            bail!("the estimator diverged at row {k} of the range: lower --order, or --detrend offset");
        }
    }
    Ok(state)
}

/// `D^0 x[k] .. D^(n-1) x[k]`; the rest is zero.
fn differences(x: &[f64], k: usize, n: usize) -> [f64; ORDER_MAX] {
    let mut d = [0.0; ORDER_MAX];
    for i in 0..n {
        d[i] = x[k - i];
    }
    for i in 1..n {
        for j in (i..n).rev() {
            d[j] = d[j - 1] - d[j];
        }
    }
    d
}

/// `(-1)^j binomial(i, j)`: the weight of x[k-j] in `D^i x[k]`.
fn weight_in_difference(i: usize, j: usize) -> f64 {
    (0..j).fold(1.0, |c, m| -c * (i as f64 - m as f64) / (m as f64 + 1.0))
}

/// The coordinates of the estimator: scaled differences.
#[derive(Clone, Debug)]
struct Basis {
    order: Order,
    /// Whether the last regressor is a constant.
    constant: bool,
    /// Root mean square of y[k] - y[k-1].
    target: f64,
    /// Root mean squares of the regressors: NA differences of y, NB of u.
    scale: [f64; PARAMETERS_MAX],
}

impl Basis {
    /// Fits the scales to a recording. A difference that is always zero takes the scale of its signal.
    fn new(s: &Signals, order: Order, constant: bool) -> Self {
        let size =
            |x: &[f64], i: usize| rms(&(i..x.len()).map(|k| differences(x, k, i + 1)[i]).collect::<Vec<_>>());
        let or = |size: f64, other: f64| if size > 0.0 { size } else { other };
        let (y, u) = (or(rms(&s.y), 1.0), or(rms(&s.u), 1.0));
        let mut scale = [1.0; PARAMETERS_MAX];
        for i in 0..order.na {
            scale[i] = or(size(&s.y, i), y);
        }
        for i in 0..order.nb {
            scale[order.na + i] = or(size(&s.u, i), u);
        }
        Self { order, constant, target: or(size(&s.y, 1), y), scale }
    }

    fn regressor(&self, s: &Signals, k: usize) -> [f32; PARAMETERS_MAX] {
        let Order { na, nb, nk } = self.order;
        let (y, u) = (differences(&s.y, k - 1, na), differences(&s.u, k - nk, nb));
        let one = f64::from(u8::from(self.constant));
        std::array::from_fn(|i| match i {
            i if i < na => (y[i] / self.scale[i]) as f32,
            i if i < na + nb => (u[i - na] / self.scale[i]) as f32,
            i if i == na + nb => one as f32,
            _ => 0.0,
        })
    }

    fn target(&self, s: &Signals, k: usize) -> f32 {
        ((s.y[k] - s.y[k - 1]) / self.target) as f32
    }

    /// What `a1 .. aNA, b1 .. bNB` gain from a unit of each scaled parameter: `row` is the index of the coefficient.
    fn row(&self, row: usize) -> [f64; PARAMETERS_MAX] {
        let Order { na, nb, .. } = self.order;
        let (first, count, sign) = if row < na { (0, na, -1.0) } else { (na, nb, 1.0) };
        let mut gained = [0.0; PARAMETERS_MAX];
        for i in 0..count {
            let weight = weight_in_difference(i, row - first);
            gained[first + i] = sign * weight * self.target / self.scale[first + i];
        }
        gained
    }

    /// What the constant gains from a unit of each scaled parameter.
    fn constant_row(&self) -> [f64; PARAMETERS_MAX] {
        let mut gained = [0.0; PARAMETERS_MAX];
        gained[self.order.parameters()] = self.target;
        gained
    }

    /// The constant that the estimator has found; without one, zero.
    fn constant_of(&self, state: &State) -> f64 {
        dot(&self.constant_row(), &state.theta.map(f64::from))
    }

    /// Sum of some rows.
    fn sum(&self, rows: Range<usize>) -> [f64; PARAMETERS_MAX] {
        rows.map(|row| self.row(row)).fold([0.0; PARAMETERS_MAX], |s, r| std::array::from_fn(|i| s[i] + r[i]))
    }

    /// The ARX model that the estimator has found.
    fn model(&self, state: &State) -> Model {
        let theta = state.theta.map(f64::from);
        let mut coefficients: Vec<f64> =
            (0..self.order.parameters()).map(|i| dot(&self.row(i), &theta)).collect();
        coefficients[0] -= 1.0; // y[k-1] of the target
        let b = coefficients.split_off(self.order.na);
        Model { order: self.order, a: coefficients, b }
    }
}

fn dot(x: &[f64; PARAMETERS_MAX], y: &[f64; PARAMETERS_MAX]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// How far off the results may be.
struct Uncertainty<'a> {
    rls: &'a Estimator,
    state: &'a State,
    lambda: f64,
    /// Standard deviation of a scaled parameter whose variance P is 1, in units of y.
    noise_sd: f64,
    basis: &'a Basis,
}

impl Uncertainty<'_> {
    /// Standard deviations of the parameters.
    fn of_parameters(&self) -> Vec<Option<f64>> {
        (0..self.basis.order.parameters()).map(|i| self.sd_along(&self.basis.row(i))).collect()
    }

    /// Static gain and its standard deviation: `A(1) dG = dB(1) - G dA(1)`; none where A(1) or B(1) is undetermined.
    fn of_gain(&self, model: &Model) -> Option<Uncertain> {
        let (a, b) = self.slopes_at_1()?;
        let value = model.static_gain()?;
        let slope = std::array::from_fn(|i| (b[i] - value * a[i]) / model.a_at_1());
        Some(Uncertain { value, sd: self.sd_along(&slope)? })
    }

    /// Steady output `y0` at zero input: `A(1) (y0 - y removed) = constant - B(1) u removed`, and likewise its
    /// differential.
    fn of_output_at_zero(&self, model: &Model, constant: f64, removed: Removed) -> Option<Uncertain> {
        let (a, b) = self.slopes_at_1()?;
        let c = self.basis.constant_row();
        let rise = constant / model.a_at_1() - model.static_gain()? * removed.u;
        let slope = std::array::from_fn(|i| (c[i] - removed.u * b[i] - rise * a[i]) / model.a_at_1());
        Some(Uncertain { value: removed.y + rise, sd: self.sd_along(&slope)? })
    }

    /// What A(1) and B(1) gain from a unit of each scaled parameter, if the data determine both.
    fn slopes_at_1(&self) -> Option<([f64; PARAMETERS_MAX], [f64; PARAMETERS_MAX])> {
        let Order { na, .. } = self.basis.order;
        let (a, b) = (self.basis.sum(0..na), self.basis.sum(na..self.basis.order.parameters()));
        self.sd_along(&a).and(self.sd_along(&b))?;
        Some((a, b))
    }

    /// Standard deviation of `g' theta`; `None` if the data do not determine it.
    fn sd_along(&self, g: &[f64; PARAMETERS_MAX]) -> Option<f64> {
        let length = dot(g, g).sqrt();
        let variance = self.variance_along(&g.map(|x| x / length));
        let determined = (0.0..UNDETERMINED * f64::from(D_INITIAL)).contains(&variance);
        determined.then(|| length * variance.sqrt() * self.noise_sd / self.basis.target)
    }

    /// `g' P g`, by asking a copy of the estimator what it would make of a sample: from theta = 0, the regressor g and
    /// the output 1 it learns `theta = P g / (lambda + g' P g)`.
    fn variance_along(&self, g: &[f64; PARAMETERS_MAX]) -> f64 {
        let mut copy = *self.state;
        copy.theta = [0.0; PARAMETERS_MAX];
        self.rls.step(&mut copy, &g.map(|x| x as f32), 1.0);
        let learnt = dot(&copy.theta.map(f64::from), g);
        self.lambda * learnt / (1.0 - learnt)
    }
}

#[cfg(test)]
mod tests;
