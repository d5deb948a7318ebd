//! The supply voltage of the heater, where it is measured: a divider at an input of its own, against VDDA.
//!
//! ```
//! use fdi_core::AdcCode;
//! use fdi_core::sense::supply::{Supply, SupplyConfig, SupplyState};
//! use fdi_core::units::Volt;
//!
//! let config = SupplyConfig { nominal_voltage: Volt(12.0), full_scale_voltage: Volt(16.5) };
//! let supply = Supply::new(&config)?;
//! let mut state = SupplyState::default();
//! supply.step(&mut state, AdcCode(4095.0 * 10.8 / 16.5));
//! assert!(state.share().is_some_and(|share| (share - 0.9).abs() < 1e-5));
//! # Ok::<(), fdi_core::ConfigError>(())
//! ```

use crate::error::{ConfigError, above};
use crate::settings::{check, settings};
use crate::units::{AdcCode, Volt};
use core::ops::RangeInclusive;

/// A share of the nominal voltage outside of these is a broken wire or divider, or no supply at all: it is not believed.
pub(crate) const PLAUSIBLE: RangeInclusive<f32> = 0.5..=1.2;

settings! {
    /// Supply voltage of the heater, where it is measured: a known input of the likelihood diagnosis.
    pub struct SupplyConfig: Supply "supply." {
        /// Voltage at which the heater has its nominal power. 0: the supply is not measured.
        nominal_voltage: Volt = 0.0, 0.0..=1000.0;
        /// Voltage at which the input reads full scale: VDDA times (R1 + R2) / R2 of the divider.
        full_scale_voltage: Volt = 16.5, 1.0..=10e3;
    }
}

/// The input, ready to convert.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supply {
    /// Share of the nominal voltage for each count; 0 where it is not measured.
    share_per_count: f32,
}

/// What was measured last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SupplyState {
    share: Option<f32>,
    lost: u32,
}

impl Supply {
    /// Builds the input.
    ///
    /// # Errors
    /// The parameter that is out of bounds, or a nominal voltage that the input cannot read.
    pub fn new(c: &SupplyConfig) -> Result<Self, ConfigError> {
        check(SupplyConfig::SETTINGS[0], c)?;
        let (nominal, full_scale) = (c.nominal_voltage.0, c.full_scale_voltage.0);
        above("supply.full_scale_voltage", full_scale, "supply.nominal_voltage", nominal)?;
        let measured = nominal > 0.0;
        let share_per_count = if measured { full_scale / nominal / AdcCode::FULL_SCALE } else { 0.0 };
        Ok(Self { share_per_count })
    }

    /// Takes in a code. One that is none, or stands for no supply that a heater has, is counted, and the last that did stays:
    /// it is nearer to the truth than the nominal voltage.
    pub fn step(&self, state: &mut SupplyState, code: AdcCode) {
        if self.share_per_count == 0.0 {
            *state = SupplyState::default();
            return;
        }
        let share = code.0 * self.share_per_count;
        if code.0 < AdcCode::FULL_SCALE && PLAUSIBLE.contains(&share) {
            state.share = Some(share);
        } else {
            state.lost = state.lost.saturating_add(1);
        }
    }

    /// The code at a share of the nominal voltage; 0 where the supply is not measured.
    pub fn code(&self, share: f32) -> AdcCode {
        AdcCode(if self.share_per_count > 0.0 { share / self.share_per_count } else { 0.0 })
    }
}

impl SupplyState {
    /// Share of the nominal voltage as last measured; None where it is not, or was never read.
    pub fn share(&self) -> Option<f32> {
        self.share
    }

    /// Samples so far that could not be used; saturates.
    pub fn lost(&self) -> u32 {
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MEASURED: SupplyConfig =
        SupplyConfig { nominal_voltage: Volt(12.0), full_scale_voltage: Volt(16.5) };

    #[test]
    fn what_is_not_measured_is_not_known() {
        let (supply, mut state) = (Supply::new(&SupplyConfig::default()).unwrap(), SupplyState::default());
        supply.step(&mut state, AdcCode(3000.0));
        assert_eq!((state.share(), state.lost()), (None, 0));
    }

    #[test]
    fn what_no_supply_has_is_counted_and_the_last_that_was_one_stays() {
        let (supply, mut state) = (Supply::new(&MEASURED).unwrap(), SupplyState::default());
        supply.step(&mut state, AdcCode(f32::NAN));
        assert_eq!((state.share(), state.lost()), (None, 1));
        supply.step(&mut state, supply.code(0.9));
        let measured = state.share();
        assert!(measured.is_some_and(|share| (share - 0.9).abs() < 1e-6));
        for code in [0.0, 1000.0, 4095.0, -3000.0, f32::INFINITY, f32::NAN] {
            supply.step(&mut state, AdcCode(code));
        }
        assert_eq!((state.share(), state.lost()), (measured, 7));
    }

    /// An input that is overdriven reads full scale, whatever the supply is.
    #[test]
    fn full_scale_is_no_supply_though_it_would_be_one() {
        let config = SupplyConfig { nominal_voltage: Volt(16.0), ..MEASURED };
        let (supply, mut state) = (Supply::new(&config).unwrap(), SupplyState::default());
        supply.step(&mut state, AdcCode(4095.0));
        assert_eq!((state.share(), state.lost()), (None, 1));
        supply.step(&mut state, AdcCode(4094.0));
        assert!(state.share().is_some_and(|share| share > 1.03));
    }

    #[test]
    fn a_nominal_voltage_beyond_the_input_is_refused() {
        let config = SupplyConfig { nominal_voltage: Volt(24.0), ..MEASURED };
        let refused = Supply::new(&config).unwrap_err();
        assert!(matches!(refused, ConfigError::NotAbove { name: "supply.full_scale_voltage", .. }));
    }
}
