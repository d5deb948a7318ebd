//! Faults that a user has shown to the rig: what each changes is kept as a [`Response`], and is a further hypothesis of the bank.
//!
//! The mean of the residuals over some repetitions is kept in the bank's own terms, as the [`Effects`] that explain it: a thermistor
//! that reads otherwise, a gain, a lag, power, flow. So it holds at other powers, too, and whatever the excitation does meanwhile.
//! A taught fault is told *beside* what the bank says without it, which it does not change.
//!
//! ```
//! use fdi_core::likelihood::taught::Response;
//!
//! let cap = Response::new("cap".parse().unwrap(), &[0.0, 0.0, 0.0, -1.5, 0.0, -0.25, 0.0, 0.0, 0.0, 0.0, 0.0]);
//! assert_eq!(cap.effects, [0, 0, 0, -150, 0, -250, 0, 0, 0, 0, 0]);
//! ```

mod response;
mod weigh;

pub use response::{Changed, EFFECTS, Effects, Full, MAX_TAUGHT, Mean, Response, Responses, names, put};
pub(super) use response::{REGRESSORS, of_hypothesis, spreads};
pub(super) use weigh::{Weighed, likeliest, weigh};
