//! How the numbers of the method are declared.

/// Declares the numbers of a part of the method.
///
/// ```ignore
/// tuning! {
///     /// Charts on the whitened residuals.
///     pub struct ChartTuning: charts {
///         /// An innovation is clipped here, so that a spike counts once.
///         clip = 6.0, "standard deviations", chosen "";
///     }
/// }
/// ```
///
/// Each has documentation, name, default, unit and origin: `derived` with its formula or source, `measured` with where, or `chosen` with what speaks for
/// it, if anything does. It gives a struct with a field each, its `DEFAULT`, and `PART`, what people read of it.
macro_rules! tuning {
    ($(#[doc = $about:literal])+ pub struct $Part:ident: $part:ident {
        $($(#[doc = $doc:literal])+ $entry:ident = $default:expr, $unit:literal, $origin:ident $source:literal;)+
    }) => {
        $(#[doc = $about])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "tuning", derive(serde::Deserialize), serde(default, deny_unknown_fields))]
        pub struct $Part {
            $(
                $(#[doc = $doc])+
                #[doc = concat!("\n\nDefault ", stringify!($default), ", in ", $unit, ".")]
                pub $entry: f32,
            )+
        }

        impl $Part {
            /// The numbers that the method was tuned to.
            pub const DEFAULT: Self = Self { $($entry: $default,)+ };
            /// What people read of it.
            #[cfg(feature = "tuning")]
            pub(super) const PART: super::Part = super::Part {
                name: stringify!($part),
                about: concat!($($about, "\n"),+),
                entries: &[$(super::Entry {
                    name: concat!("tuning.", stringify!($part), ".", stringify!($entry)),
                    about: concat!($($doc, "\n"),+),
                    unit: $unit,
                    origin: super::tuning!(@origin $origin),
                    source: $source,
                    value: |tuning| tuning.$part.$entry,
                }),+],
            };
        }

        impl Default for $Part {
            fn default() -> Self {
                Self::DEFAULT
            }
        }
    };

    (@origin derived) => { super::Origin::Derived };
    (@origin measured) => { super::Origin::Measured };
    (@origin chosen) => { super::Origin::Chosen };
}
pub(super) use tuning;
