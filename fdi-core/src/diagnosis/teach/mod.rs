//! Signatures of faults that somebody makes on purpose: the paper's signatures "must be captured on test experiments". What the
//! residuals do in each [`Repetition`] says what is [`Steady`] in it, what all of them have in common is the row ([`common`]), and
//! [`tables`] say whether it can stand beside the rows that are there.
//!
//! ```
//! use fdi_core::diagnosis::signature::Symptom;
//! use fdi_core::diagnosis::teach::{Repetition, common};
//!
//! let repetition = |rbw1| {
//!     let mut repetition = Repetition::default();
//!     let symptoms = [Symptom::Normal, Symptom::High, Symptom::Normal, Symptom::Low, rbw1];
//!     (0..100).for_each(|_| repetition.push(&symptoms));
//!     repetition.steady().unwrap()
//! };
//! let [first, second] = [repetition(Symptom::Normal), repetition(Symptom::High)];
//! assert_eq!(common(&[first, second]).to_string(), "0 +1 0 -1 x");
//! ```

mod repetition;
mod row;
pub mod tables;

pub use repetition::{Repetition, Steady};
pub use row::{common, tells};
