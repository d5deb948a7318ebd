//! The seven residuals of the paper (section 3.2): what is compared with its nominal value.
//!
//! ```
//! use fdi_core::diagnosis::residual::{Residual, features};
//! use fdi_core::identify::observer::Identified;
//!
//! let model = |prediction, gain| Identified {
//!     prediction: Some(prediction),
//!     static_gain: Some(gain),
//!     bandwidth: Some(2.0),
//!     ..Identified::default()
//! };
//! // T1 is 12.5 degC above the ambient and T2 11.5, at 41 % of heater power.
//! let now = features(Some(12.5), Some(11.5), 41.0, &model(12.4, 0.30), &model(11.5, 0.28)).expect("all is known");
//! assert_eq!(now[Residual::Ry12 as usize], 1.0);
//! assert_eq!(now[Residual::Rsg1 as usize], 0.30);
//! // Without T2 there is nothing to compare.
//! assert!(features(Some(12.5), None, 41.0, &model(12.4, 0.30), &model(11.5, 0.28)).is_none());
//! ```

use crate::identify::observer::Identified;

/// Number of residuals.
pub const RESIDUALS: usize = 7;

/// A residual, in the order of the figures. The first two are shown, the other five decide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Residual {
    /// y1 minus its one-step prediction, degC.
    Ry1,
    /// y2 minus its one-step prediction, degC.
    Ry2,
    /// Applied heater power minus its nominal mean, %.
    Rap,
    /// y1 - y2 minus the nominal heat loss delta12, degC.
    Ry12,
    /// Static gain of MS1 minus its nominal mean, degC per %.
    Rsg1,
    /// Static gain of MS2 minus its nominal mean, degC per %.
    Rsg2,
    /// Bandwidth of MS1 minus its nominal mean, rad/s.
    Rbw1,
}

/// All residuals, in order.
pub const ALL: [Residual; RESIDUALS] = [
    Residual::Ry1,
    Residual::Ry2,
    Residual::Rap,
    Residual::Ry12,
    Residual::Rsg1,
    Residual::Rsg2,
    Residual::Rbw1,
];

/// The five residuals of a signature, in the paper's order {rAP; ry12; rsg1; rsg2; rbw1}.
pub const DECISIVE: [Residual; 5] =
    [Residual::Rap, Residual::Ry12, Residual::Rsg1, Residual::Rsg2, Residual::Rbw1];

/// Where the decisive ones begin among all.
pub const FIRST_DECISIVE: usize = RESIDUALS - DECISIVE.len();

const _: () = assert!(FIRST_DECISIVE == DECISIVE[0] as usize && DECISIVE[4] as usize == RESIDUALS - 1);

/// What the residuals are made of, before any nominal value is subtracted: `None` where a part of it is not defined.
///
/// `y1`, `y2` in degC above the room, `power` in %.
pub fn features(
    y1: Option<f32>,
    y2: Option<f32>,
    power: f32,
    ms1: &Identified,
    ms2: &Identified,
) -> Option<[f32; RESIDUALS]> {
    let (y1, y2) = (y1?, y2?);
    Some([
        y1 - ms1.prediction?,
        y2 - ms2.prediction?,
        power,
        y1 - y2,
        ms1.static_gain?,
        ms2.static_gain?,
        ms1.bandwidth?,
    ])
}
