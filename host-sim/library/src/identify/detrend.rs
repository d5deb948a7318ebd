//! What is done about the values that u and y have at rest.

use anyhow::Context;
use serde::{Deserialize, Serialize};

use super::estimate::{Estimate, estimate, estimate_with_constant};
use super::model::{Order, Signals, mean, rms};

/// What is done about the values that u and y have at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Detrend {
    /// As offset if y is clearly not zero when u is, else as none; the report says which.
    #[default]
    Auto,
    /// Both as they are.
    None,
    /// Both without their means.
    Mean,
    /// What y is when u is zero is estimated together with the model.
    Offset,
}

/// An estimate, and what was taken off u and y for it.
#[derive(Clone, Debug)]
pub struct Detrended {
    /// What was done; never [`Detrend::Auto`].
    pub detrend: Detrend,
    /// Taken off u and y.
    pub offsets: (f64, f64),
    /// The estimate.
    pub estimate: Estimate,
}

/// An offset of less than so many of its standard deviations may be chance. More than the usual 3, since coloured
/// residuals make the standard deviations too small.
const OFFSET_SDS: f64 = 5.0;
/// An offset of less than this share of the root mean square of y does little harm.
const OFFSET_SHARE: f64 = 0.05;

/// Estimates a model from `s` in the way asked for.
///
/// # Errors
/// Those of [`estimate`]; an offset was asked for that the data do not determine.
pub fn detrended(s: &Signals, detrend: Detrend, order: Order, lambda: f64) -> anyhow::Result<Detrended> {
    let less = |detrend, (u, y)| {
        let estimate = estimate(&s.minus(u, y), order, lambda)?;
        Ok(Detrended { detrend, offsets: (u, y), estimate })
    };
    let less_offset = || {
        let estimate = estimate_with_constant(s, order, lambda)?;
        let zero = estimate.output_at_zero.context(
            "the data do not determine the output at zero input: expected --detrend none or --detrend mean",
        )?;
        Ok(Detrended { detrend: Detrend::Offset, offsets: (0.0, zero.value), estimate })
    };
    match detrend {
        Detrend::None => less(Detrend::None, (0.0, 0.0)),
        Detrend::Mean => less(Detrend::Mean, (mean(&s.u), mean(&s.y))),
        Detrend::Offset => less_offset(),
        Detrend::Auto => match less_offset() {
            Ok(found) if found.matters(s) => Ok(found),
            _ => less(Detrend::None, (0.0, 0.0)),
        },
    }
}

impl Detrended {
    /// Whether the offset is no chance, and large enough to falsify the gain.
    fn matters(&self, s: &Signals) -> bool {
        self.estimate.output_at_zero.is_some_and(|zero| {
            zero.value.abs() > OFFSET_SDS * zero.sd && zero.value.abs() > OFFSET_SHARE * rms(&s.y)
        })
    }
}
