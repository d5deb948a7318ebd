//! Recursive least squares as others write it: the same work as `fdi_core::identify::rls`, for comparison only.

mod full_matrix;
mod regressor;
mod textbook;

use fdi_core::identify::rls::Rls;
use fdi_core::identify::{Adaptation, RlsConfig};

pub use full_matrix::FullMatrix;
pub use regressor::Regressor;
pub use textbook::Textbook;

/// Forgetting factor of every peer: the instrument's.
pub const LAMBDA: f32 = 0.95;
/// Diagonal of P at the start: the instrument's.
pub const P_INITIAL: f32 = 1e4;
/// Cap on D: the instrument's.
const D_MAX: f32 = 1e5;

/// The instrument's own estimator, of any order.
pub fn ours<const N: usize>() -> Rls<N> {
    let adaptation = Adaptation::Forgetting { lambda: LAMBDA };
    Rls::new(&RlsConfig { adaptation, d_initial: P_INITIAL, d_max: D_MAX }).expect("constants within bounds")
}
