//! How settings are declared.

/// Declares a struct of settings.
///
/// ```ignore
/// settings! {
///     /// Temperature controller.
///     pub struct PidConfig: Pid "pid." {
///         /// Proportional gain Kp.
///         kp: f32 = 2.4, 0.0..=1000.0, in "%/degC";
///         /// Integral time Ti.
///         ti: Seconds = 0.5, 0.01..=1e4, was "pid.t_i";
///         /// Highest output.
///         output_max: Percent = 100.0, 0.0..=100.0, limit above;
///     }
/// }
/// ```
///
/// `Pid` is the group and `pid.` the beginning of the names: a struct that serves several groups has several. Then each setting:
/// documentation, field, type, default; bounds, where it is a number; its unit, where the type has none; the name that it
/// once had, which keeps its id. `limit` marks what a protection rests on, and says where it is wider: `above` or `below` its default, or
/// when a switch is `on` or `off`; `within 16 answers` bounds a time by so many `identification.answer_time`. `and { name: Type = default; }` adds fields that are no settings.
///
/// It gives the struct with documented fields, `Default`, `SETTINGS` (a table of [`Setting`](super::Setting) for each group),
/// `ABOUT` (what people read), `check` for the bounds, and access to a field by its place.
macro_rules! settings {
    ($(#[doc = $about:literal])+ pub struct $Config:ident: $($Group:ident $prefix:literal),+ { $($settings:tt)+ }) => {
        $crate::settings::settings!(@struct [Copy] [$($about)+] $Config { $($settings)+ } {});
        $crate::settings::settings!(@tables [$($about)+] $Config [$($Group $prefix),+] { $($settings)+ });
    };
    ($(#[doc = $about:literal])+ pub struct $Config:ident: $Group:ident $prefix:literal $settings:tt and $others:tt) => {
        $crate::settings::settings!(@struct [] [$($about)+] $Config $settings $others);
        $crate::settings::settings!(@tables [$($about)+] $Config [$Group $prefix] $settings);
    };

    (@struct [$($Copy:ident)?] [$($about:literal)+] $Config:ident
        { $($(#[doc = $doc:literal])+ $field:ident: $Type:ty = $default:expr
            $(, $min:literal..=$max:literal)? $(, in $unit:literal)? $(, was $was:literal)?
            $(, limit $side:ident $(within $answers:literal answers)?)?;)+ }
        { $($(#[doc = $other_doc:literal])+ $other:ident: $Other:ty = $other_default:expr;)* }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, $($Copy,)? Debug, PartialEq)]
        #[cfg_attr(
            feature = "serde",
            derive(serde::Serialize, serde::Deserialize),
            serde(default, deny_unknown_fields)
        )]
        pub struct $Config {
            $(
                $(#[doc = $doc])+
                #[doc = concat!(
                    "\n\nDefault ", stringify!($default)
                    $(, ", ", stringify!($min), " to ", stringify!($max))? $(, ", in ", $unit)?, "."
                )]
                pub $field: $Type,
            )+
            $($(#[doc = $other_doc])+ pub $other: $Other,)*
        }

        impl Default for $Config {
            fn default() -> Self {
                Self {
                    $($field: <$Type as $crate::settings::FieldType>::new($default),)+
                    $($other: $other_default,)*
                }
            }
        }

        impl $crate::settings::Fields for $Config {
            fn field(&self, index: usize) -> Option<&dyn $crate::settings::Field> {
                $crate::settings::settings!(@index $($field)+);
                match index {
                    $(index if index == Index::$field as usize => Some(&self.$field),)+
                    _ => None,
                }
            }

            fn field_mut(&mut self, index: usize) -> Option<&mut dyn $crate::settings::Field> {
                $crate::settings::settings!(@index $($field)+);
                match index {
                    $(index if index == Index::$field as usize => Some(&mut self.$field),)+
                    _ => None,
                }
            }
        }
    };

    (@tables [$($about:literal)+] $Config:ident [$($Group:ident $prefix:literal),+] $settings:tt) => {
        impl $Config {
            /// What it is about.
            pub(crate) const GROUP_ABOUT: &'static str = concat!($($about, "\n"),+);
            /// Its settings, a table for each group.
            pub(crate) const SETTINGS: [&'static [$crate::settings::Setting]; { [$($prefix),+].len() }] =
                [$($crate::settings::settings!(@table $Group $prefix $settings)),+];
            /// What people read of them.
            pub(crate) const ABOUT: &'static [$crate::settings::About] = $crate::settings::settings!(@about $settings);
        }
    };

    (@table $Group:ident $prefix:literal
        { $($(#[doc = $doc:literal])+ $field:ident: $Type:ty = $default:expr
            $(, $min:literal..=$max:literal)? $(, in $unit:literal)? $(, was $was:literal)?
            $(, limit $side:ident $(within $answers:literal answers)?)?;)+ }
    ) => {{
        $crate::settings::settings!(@index $($field)+);
        &[$($crate::settings::Setting {
            name: concat!($prefix, stringify!($field)),
            id: $crate::settings::id($crate::settings::settings!(@first $($was,)? concat!($prefix, stringify!($field)))),
            unit: $crate::settings::settings!(@first $($unit,)? <$Type as $crate::settings::FieldType>::UNIT),
            kind: <$Type as $crate::settings::FieldType>::KIND$(.within($min as f32, $max as f32))?,
            group: $crate::settings::Group::$Group,
            index: Index::$field as u8,
            limit: $crate::settings::settings!(
                @first $($crate::settings::settings!(@limit $side ($default) ($($answers)?)),)? None
            ),
        }),+]
    }};

    (@about
        { $($(#[doc = $doc:literal])+ $field:ident: $Type:ty = $default:expr
            $(, $min:literal..=$max:literal)? $(, in $unit:literal)? $(, was $was:literal)?
            $(, limit $side:ident $(within $answers:literal answers)?)?;)+ }
    ) => {
        &[$($crate::settings::About {
            text: concat!($($doc, "\n"),+),
            was: $crate::settings::settings!(@first $(Some($was),)? None),
        }),+]
    };

    (@index $($field:ident)+) => {
        #[allow(non_camel_case_types)]
        enum Index { $($field),+ }
    };

    (@limit above ($default:expr) ($($answers:literal)?)) => {
        $crate::settings::settings!(@limit Above $default, $($answers)?)
    };
    (@limit below ($default:expr) ($($answers:literal)?)) => {
        $crate::settings::settings!(@limit Below $default, $($answers)?)
    };
    (@limit on ($default:expr) ()) => { $crate::settings::settings!(@limit Above 0.0,) };
    (@limit off ($default:expr) ()) => { $crate::settings::settings!(@limit Below 1.0,) };
    (@limit $Side:ident $default:expr, $($answers:literal)?) => {
        Some($crate::settings::Limit {
            wider: $crate::settings::Wider::$Side,
            default: $default as f32,
            answers: $crate::settings::settings!(@first $($answers,)? 0),
        })
    };

    (@first $first:expr $(, $rest:expr)?) => { $first };
}
pub(crate) use settings;
