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
//!
//! ```
//! use fdi_core::identify::rls::Rls;
//! use fdi_core::identify::{Adaptation, RlsConfig};
//!
//! // A line through points: y = 2 x + 1, with the regressor (x, 1).
//! let rls = Rls::<2>::new(&RlsConfig { adaptation: Adaptation::Forgetting { lambda: 0.99 }, d_initial: 1e4, d_max: 1e6 })?;
//! let mut state = rls.start();
//! for k in 0..100u8 {
//!     let x = f32::from(k % 7) / 7.0;
//!     rls.step(&mut state, &[x, 1.0], 2.0 * x + 1.0);
//! }
//! assert!((state.theta[0] - 2.0).abs() < 1e-3 && (state.theta[1] - 1.0).abs() < 1e-3);
//! # Ok::<(), fdi_core::ConfigError>(())
//! ```

/// Repeats `$body` for `$j` from 0 to below `$n`, at most 17, each time with a constant: the loops inside unroll, and
/// their indices need no check.
macro_rules! unrolled {
    ($j:ident < $n:ident $body:block) => {
        unrolled!(@ $j $n $body 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16)
    };
    (@ $j:ident $n:ident $body:block $($k:literal)*) => {{
        const { assert!($n <= 17) };
        $(if $k < $n { let $j = $k; $body; })*
    }};
}

use super::config::{Adaptation, RlsConfig};
use super::random_walk;
use crate::bounds::bounded;
use crate::error::ConfigError;
use crate::root::sqrt;
use crate::vector::dot;

/// alpha plus the squared innovation of no scaled sample comes near this.
const SIZE_LIMIT: f32 = 1e20;

/// So many columns of U are written out where code counts, too; the longer ones are left to a loop. Of thirteen columns, five, seven, nine and
/// all give 10,644, 10,536, 10,112 and 10,128 instructions a tick, and an image of 238.1, 238.5, 239.0 and 240.4 kB (measured with
/// `cargo bench-m4` and `tools/budget`).
const SHORT: usize = 9;

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
    /// How often the estimator was found diverged and started afresh.
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
    pub diverged: bool,
}

impl<const N: usize> Rls<N> {
    /// Builds an estimator.
    ///
    /// # Errors
    /// The parameter that is out of bounds.
    pub fn new(c: &RlsConfig) -> Result<Self, ConfigError> {
        c.validate()?;
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

    /// One sample `y` with its regressor `phi`, both scaled.
    ///
    /// Total: whatever comes in, the state stays finite; where it would not, it is reset and the update says `diverged`.
    #[inline]
    pub fn step(&self, state: &mut RlsState<N>, phi: &[f32; N], y: f32) -> Update {
        let mut sweep = self.sweep();
        unrolled!(j < N { self.column(&mut sweep, state, phi, j) });
        let (prediction, innovation) = correct(&sweep, state, phi, y);
        if !(sweep.alpha + innovation * innovation < SIZE_LIMIT) {
            self.restart(state, prediction, innovation)
        } else if self.r1 > 0.0 {
            self.walk(state, prediction, innovation)
        } else {
            Update { prediction, innovation, diverged: false }
        }
    }

    /// The same from parameters that are zero, so that `theta` becomes what a sample corrects: its innovation counts no more than `limit` of its
    /// standard deviations. Nothing walks at random here.
    #[inline(never)]
    pub(crate) fn correct_clipped(
        &self,
        state: &mut RlsState<N>,
        phi: &[f32; N],
        innovation: f32,
        limit: f32,
    ) {
        const { assert!(SHORT <= N) };
        let mut sweep = self.sweep();
        unrolled!(j < SHORT { self.column(&mut sweep, state, phi, j) });
        for j in SHORT..N {
            self.column(&mut sweep, state, phi, j);
        }
        let reach = limit * sqrt(sweep.alpha);
        let innovation = bounded(innovation, -reach, reach);
        if sweep.alpha + innovation * innovation < SIZE_LIMIT {
            let step = innovation * sweep.inv_alpha;
            state.theta = sweep.gain.map(|gain| gain * step);
        } else {
            self.restart(state, 0.0, innovation);
        }
    }

    #[inline(always)]
    fn sweep(&self) -> Sweep<N> {
        Sweep { gain: [0.0; N], alpha: self.alpha_0, inv_alpha: 1.0 / self.alpha_0 }
    }

    /// One column of Bierman's update.
    #[inline(always)]
    fn column(&self, sweep: &mut Sweep<N>, state: &mut RlsState<N>, phi: &[f32; N], j: usize) {
        let Sweep { gain, alpha, inv_alpha } = sweep;
        let RlsState { u, d, .. } = state;
        let f = if j == 0 { phi[0] } else { column_dot(u, phi, j) + phi[j] };
        let v = d[j] * f;
        let mu = -f * *inv_alpha;
        let previous = *alpha;
        *alpha += f * v;
        *inv_alpha = 1.0 / *alpha;
        d[j] = bound(d[j] * previous * *inv_alpha * self.inflation, self.d_max);
        for i in 0..j {
            let u_ij = u[i][j];
            u[i][j] = u_ij + gain[i] * mu;
            gain[i] += u_ij * v;
        }
        gain[j] = v;
    }

    /// Lets the parameters walk. Out of line, and last, so that forgetting does not pay for it.
    #[inline(never)]
    fn walk(&self, state: &mut RlsState<N>, prediction: f32, innovation: f32) -> Update {
        random_walk::propagate(&mut state.u, &mut state.d, self.r1);
        for d in &mut state.d {
            *d = bound(*d, self.d_max);
        }
        Update { prediction, innovation, diverged: false }
    }

    /// Starts afresh from numbers that have become useless.
    #[cold]
    #[inline(never)]
    fn restart(&self, state: &mut RlsState<N>, prediction: f32, innovation: f32) -> Update {
        *state = RlsState { resets: state.resets.saturating_add(1), ..self.start() };
        let finite = |x: f32| if x.is_finite() { x } else { 0.0 };
        Update { prediction: finite(prediction), innovation: finite(innovation), diverged: true }
    }
}

/// The parameters' part of the update, once the covariance has had its own: prediction and innovation.
#[inline(always)]
fn correct<const N: usize>(sweep: &Sweep<N>, state: &mut RlsState<N>, phi: &[f32; N], y: f32) -> (f32, f32) {
    let prediction = dot(&state.theta, phi);
    let innovation = y - prediction;
    let step = innovation * sweep.inv_alpha;
    for i in 0..N {
        state.theta[i] += sweep.gain[i] * step;
    }
    (prediction, innovation)
}

/// What Bierman's update hands from column to column.
struct Sweep<const N: usize> {
    gain: [f32; N],
    alpha: f32,
    inv_alpha: f32,
}

impl<const N: usize> RlsState<N> {
    /// Forgets how the parameters' errors go together, not how large they are: `U = I`.
    pub(crate) fn forget_correlations(&mut self) {
        self.u = [[0.0; N]; N];
    }

    /// D, which with `U = I` are the variances.
    pub(crate) fn d_mut(&mut self) -> &mut [f32; N] {
        &mut self.d
    }

    /// Diagonal of `P = U D U'`: variances of the scaled parameters in units of the noise variance.
    pub fn variances(&self) -> [f32; N] {
        core::array::from_fn(|i| {
            let above: f32 = (i + 1..N).map(|j| self.u[i][j] * self.u[i][j] * self.d[j]).sum();
            self.d[i] + above
        })
    }
}

/// Column j of U above its diagonal, times phi; j is at least 1.
#[inline(always)]
fn column_dot<const N: usize>(u: &[[f32; N]; N], phi: &[f32; N], j: usize) -> f32 {
    let mut sum = u[0][j] * phi[0];
    for i in 1..j {
        sum += u[i][j] * phi[i];
    }
    sum
}

/// Caps an element of D. Positive numbers are in the order of their bits, and everything that is none (NaN) lies above
/// them: it comes out as the cap, the vague end, from which data can be learnt again.
#[inline]
fn bound(d: f32, max: f32) -> f32 {
    f32::from_bits(d.to_bits().min(max.to_bits()))
}
