//! Units as types: a number crosses a boundary of this crate with its unit, and is a raw `f32` only inside a loop.

use crate::settings::{Field, FieldType, Kind, Value};

macro_rules! unit {
    ($(#[$doc:meta])* $name:ident, $symbol:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub struct $name(pub f32);

        impl Field for $name {
            fn value(&self) -> Value {
                self.0.value()
            }

            fn set(&mut self, value: Value) -> bool {
                self.0.set(value)
            }
        }

        impl FieldType for $name {
            type Plain = f32;
            const UNIT: &'static str = $symbol;
            const KIND: Kind = f32::KIND;

            fn new(plain: f32) -> Self {
                Self(plain)
            }
        }

        impl core::fmt::Display for $name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                core::fmt::Display::fmt(&self.0, f)?;
                f.write_str(concat!(" ", $symbol))
            }
        }
    };
}

unit!(
    /// Temperature, or a difference of temperatures, in degrees Celsius.
    Celsius, "degC");
unit!(
    /// Share of the full heater power, 0..100 %.
    Percent, "%");
unit!(
    /// Time in seconds.
    Seconds, "s");
unit!(
    /// Ratiometric 12-bit ADC code, 0..=4095; a mean of several conversions has decimals. NaN means "no sample".
    AdcCode, "counts");
unit!(
    /// Electrical resistance in ohm.
    Ohm, "ohm");

unit!(
    /// Voltage in volt.
    Volt, "V");

impl AdcCode {
    /// Code at the full scale (input at VDDA).
    pub const FULL_SCALE: f32 = 4095.0;
}

impl Seconds {
    /// The number of ticks of length `sample_time` that this duration takes, rounded up; saturates.
    ///
    /// A tick that lies on the boundary to within a thousandth of a tick counts as on it.
    pub fn ticks(self, sample_time: Seconds) -> u32 {
        libm::ceilf(self.0 / sample_time.0 - 1e-3) as u32
    }
}
