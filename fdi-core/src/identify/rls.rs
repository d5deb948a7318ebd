//! Recursive least squares with the covariance kept as `P = U D U'` (Bierman's measurement update).
//!
//! With forgetting and no excitation, the unfactored forms lose the definiteness of P in single precision and end in
//! NaN within minutes. Here U is unit upper triangular, D is positive by construction and capped, so P can neither lose
//! its sign nor grow without bound. Regressors should be scaled to about one.
//!
//! ```text
//! f = U' phi,  v = D f,  alpha_0 = lambda,  alpha_j = alpha_(j-1) + f_j v_j
//! D_j <- D_j alpha_(j-1) / (alpha_j lambda)
//! U, K by the recurrence in `update`;       theta <- theta + K (y - phi' theta) / alpha_N
//! ```
//!
//! Source: G. J. Bierman, "Factorization Methods for Discrete Sequential Estimation", 1977, section V.3; the
//! exponential forgetting is the division of D by lambda.

use super::random_walk;
use crate::error::{ConfigError, in_range};

/// How old data lose their weight.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "kebab-case", deny_unknown_fields)
)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Adaptation {
    /// Exponential forgetting; memory of about `1 / (1 - lambda)` samples.
    Forgetting {
        /// Forgetting factor, 0.5..=1.
        lambda: f32,
    },
    /// Kalman filter for parameters that walk at random.
    RandomWalk {
        /// Variance that each scaled parameter gains in a sample.
        r1: f32,
        /// Variance of the scaled measurement.
        r2: f32,
    },
}

impl Adaptation {
    /// Checks the factor or the variances.
    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        match *self {
            Self::Forgetting { lambda } => {
                in_range("identification.adaptation.forgetting.lambda", lambda, 0.5, 1.0)
            }
            Self::RandomWalk { r1, r2 } => {
                in_range("identification.adaptation.random-walk.r1", r1, 0.0, 1.0)?;
                in_range("identification.adaptation.random-walk.r2", r2, 1e-9, 1e6)
            }
        }
    }
}

/// Settings of the estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RlsConfig {
    /// How old data lose their weight.
    pub adaptation: Adaptation,
    /// D at the start and after a reset: the variance of a parameter nothing is known of.
    pub d_initial: f32,
    /// Cap on each element of D.
    pub d_max: f32,
}

/// Keeps D off zero, where an element could never learn again.
const D_MIN: f32 = 1e-12;
/// A sum of absolute parameters that no scaled model comes near.
const THETA_LIMIT: f32 = 1e6;

/// A validated estimator of `N` parameters.
#[derive(Clone, Copy, Debug)]
pub struct Rls<const N: usize> {
    /// alpha_0: lambda, or the measurement variance.
    alpha_0: f32,
    /// 1 / lambda, or 1.
    inflation: f32,
    /// Parameter variance gained in a sample; 0 with forgetting.
    r1: f32,
    d_initial: f32,
    d_max: f32,
}

/// The memory of an [`Rls`]: parameters and factored covariance.
#[derive(Clone, Copy, Debug)]
pub struct RlsState<const N: usize> {
    /// Parameters, in the scale of the regressors.
    pub theta: [f32; N],
    /// Unit upper triangular factor; only the part above the diagonal is used.
    u: [[f32; N]; N],
    d: [f32; N],
    /// How often the estimator was found sick and started afresh.
    pub resets: u32,
}

/// What one sample did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Update {
    /// Prediction made before the update.
    pub prediction: f32,
    /// y minus the prediction.
    pub innovation: f32,
    /// The numbers had become useless and the estimator was reset; not to be confused with a doubtful measurement.
    pub sick: bool,
}

impl<const N: usize> Rls<N> {
    /// Builds an estimator.
    ///
    /// # Errors
    /// The parameter that is out of bounds.
    pub fn new(c: &RlsConfig) -> Result<Self, ConfigError> {
        c.adaptation.validate()?;
        in_range("identification.d_initial", c.d_initial, 1e-6, 1e9)?;
        in_range("identification.d_max", c.d_max, 1.0, 1e9)?;
        let (alpha_0, inflation, r1) = match c.adaptation {
            Adaptation::Forgetting { lambda } => (lambda, 1.0 / lambda, 0.0),
            Adaptation::RandomWalk { r1, r2 } => (r2, 1.0, r1),
        };
        Ok(Self { alpha_0, inflation, r1, d_initial: c.d_initial, d_max: c.d_max })
    }

    /// An estimator that knows nothing: parameters zero.
    pub fn start(&self) -> RlsState<N> {
        RlsState { theta: [0.0; N], u: [[0.0; N]; N], d: [self.d_initial; N], resets: 0 }
    }

    /// Takes in one sample `y` with its regressor `phi`, both scaled.
    ///
    /// Total: whatever comes in, the state stays finite; where it would not, it is reset and the update says `sick`.
    pub fn step(&self, state: &mut RlsState<N>, phi: &[f32; N], y: f32) -> Update {
        let prediction = predict(&state.theta, phi);
        let innovation = y - prediction;
        let alpha = self.update(state, phi, innovation);
        let size: f32 = state.theta.iter().map(|t| t.abs()).sum();
        let healthy = alpha >= self.alpha_0 && alpha < f32::MAX && size < THETA_LIMIT;
        if !healthy {
            *state = RlsState { resets: state.resets.saturating_add(1), ..self.start() };
            let finite = |x: f32| if x.is_finite() { x } else { 0.0 };
            return Update { prediction: finite(prediction), innovation: finite(innovation), sick: true };
        }
        Update { prediction, innovation, sick: false }
    }

    /// Bierman's update; returns alpha_N, the innovation's variance in the units of alpha_0.
    #[inline]
    fn update(&self, state: &mut RlsState<N>, phi: &[f32; N], innovation: f32) -> f32 {
        let RlsState { theta, u, d, .. } = state;
        let mut gain = [0.0; N];
        let mut alpha = self.alpha_0;
        let mut inv_alpha = 1.0 / alpha;
        for j in 0..N {
            let mut f = phi[j];
            for i in 0..j {
                f += u[i][j] * phi[i];
            }
            let v = d[j] * f;
            let previous = alpha;
            let mu = -f * inv_alpha;
            alpha += f * v;
            inv_alpha = 1.0 / alpha;
            d[j] = bound(d[j] * previous * inv_alpha * self.inflation, self.d_max);
            gain[j] = v;
            for i in 0..j {
                let u_ij = u[i][j];
                u[i][j] = u_ij + gain[i] * mu;
                gain[i] += u_ij * v;
            }
        }
        let step = innovation * inv_alpha;
        for i in 0..N {
            theta[i] += gain[i] * step;
        }
        if self.r1 > 0.0 {
            random_walk::propagate(u, d, self.r1);
            for d_j in d.iter_mut() {
                *d_j = bound(*d_j, self.d_max);
            }
        }
        alpha
    }
}

impl<const N: usize> RlsState<N> {
    /// Diagonal of `P = U D U'`: variances of the scaled parameters in units of the noise variance.
    pub fn variances(&self) -> [f32; N] {
        core::array::from_fn(|i| {
            let above: f32 = (i + 1..N).map(|j| self.u[i][j] * self.u[i][j] * self.d[j]).sum();
            self.d[i] + above
        })
    }
}

/// One-step prediction phi' theta.
#[inline]
pub(crate) fn predict<const N: usize>(theta: &[f32; N], phi: &[f32; N]) -> f32 {
    let mut sum = 0.0;
    for i in 0..N {
        sum += theta[i] * phi[i];
    }
    sum
}

/// Keeps an element of D within its bounds. NaN comes out as the cap: the vague end, from which data can be learnt again.
#[inline]
fn bound(d: f32, max: f32) -> f32 {
    if d < D_MIN {
        D_MIN
    } else if d < max {
        d
    } else {
        max
    }
}
