//! Recursive least squares as others write it: the same work as `fdi_core::identify::rls`, for comparison only.

mod full_matrix;
mod textbook;

pub use full_matrix::FullMatrix;
pub use textbook::Textbook;

/// Forgetting factor of every peer: the instrument's.
pub const LAMBDA: f32 = 0.95;
/// Diagonal of P at the start: the instrument's.
pub const P_INITIAL: f32 = 1e4;
