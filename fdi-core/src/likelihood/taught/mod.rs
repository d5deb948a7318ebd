//! Faults that a user has shown to the rig: the mean of the residuals over some repetitions is a column of its own, and a further
//! hypothesis beside those that follow from the model.
//!
//! What is captured, and how long after the onset, stands in a [`Response`]; [`Capture`] takes it from the [`Departure`] of each tick.
//! A taught fault is judged by the same residuals and nuisances as all others, and changes nothing of what is said of them.

mod capture;
mod recall;
mod response;

pub use capture::{Capture, Captured};
pub(super) use recall::{Recall, Recalled, likeliest};
pub use response::{INTERVALS, MOST, Response, Responses};
pub(super) use response::validate;

use super::verdict::Magnitude;

/// What the residuals of T1 and T2 are since something stirs, on one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Departure {
    /// Ticks since it stirs, 0 on the first.
    pub age: u32,
    /// Measured less expected, slow change taken off, degC.
    pub residuals: [f32; 2],
}

/// A taught fault, told.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TaughtFinding {
    /// Its place among the responses, from 0.
    pub place: u8,
    /// Probability among all that were considered, 0..=1.
    pub confidence: f32,
    /// How large it is, % of what was taught.
    pub magnitude: Magnitude,
}
