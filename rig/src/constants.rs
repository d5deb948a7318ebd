//! Constants of the rig, each declared once.

/// A constant of the rig, as people read of it.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    /// Key in its section.
    pub name: &'static str,
    /// What it is, with its unit.
    pub about: &'static str,
    /// Its default, as TOML.
    pub default: &'static str,
    /// Smallest and largest value.
    pub bounds: [f64; 2],
}

/// Constants that belong together.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// Its name as a table of TOML.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Its constants, in order.
    pub constants: &'static [Constant],
}

/// Declares each constant once: what it is, its key, default and bounds. It gives the struct, its defaults, the check of the
/// bounds, the table from which commented TOML is written, and what a file may change of it. The rig itself holds the
/// sections of its ingredients, and starts from a preset.
macro_rules! constants {
    ($(#[doc = $about:literal])+ pub struct $Config:ident / $Changes:ident in $section:literal {
        $($(#[doc = $doc:literal])+ $name:ident: $Type:ty = $default:literal, $min:literal..=$max:literal;)+
    } $(from $preset:ident with {
        $($(#[doc = $group_doc:literal])+ $group:ident: $Group:ident / $GroupChanges:ident;)+
    })?) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug, PartialEq, serde::Serialize)]
        pub struct $Config {
            $(
                $(#[doc = $doc])+
                #[doc = concat!("\n\nDefault ", stringify!($default), ", ", stringify!($min), " to ", stringify!($max), ".")]
                pub $name: $Type,
            )+
            $($($(#[doc = $group_doc])+ pub $group: $Group,)+)?
        }

        /// What a file may change; what it leaves out stays.
        #[derive(serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(crate) struct $Changes {
            $($name: Option<$Type>,)+
            $($preset: Option<String>, $($group: Option<$GroupChanges>,)+)?
        }

        impl Default for $Config {
            fn default() -> Self {
                Self { $($name: $default,)+ $($($group: $Group::default(),)+)? }
            }
        }

        impl $Config {
            /// Every constant, in order.
            pub const CONSTANTS: &[$crate::constants::Constant] = &[$($crate::constants::Constant {
                name: stringify!($name),
                about: concat!($($doc),+),
                default: stringify!($default),
                bounds: [$min, $max],
            }),+];

            /// The section that these are.
            pub(crate) const SECTION: $crate::constants::Section = $crate::constants::Section {
                name: $section,
                about: concat!($($about),+),
                constants: Self::CONSTANTS,
            };

            $(
                /// These constants and those of every ingredient.
                pub const SECTIONS: &[$crate::constants::Section] = &[Self::SECTION, $($Group::SECTION),+];
            )?

            /// Checks every constant.
            ///
            /// # Errors
            /// The name of the first that is out of bounds, its value and the bounds.
            pub fn validate(&self) -> anyhow::Result<()> {
                let values: [f64; Self::CONSTANTS.len()] = [$(self.$name.into()),+];
                for (constant, value) in Self::CONSTANTS.iter().zip(values) {
                    let (name, [min, max]) = (constant.name, constant.bounds);
                    anyhow::ensure!(
                        value >= min && value <= max,
                        "{}.{name} is {value}, expected {min} to {max}",
                        $section
                    );
                }
                $($(self.$group.validate()?;)+)?
                Ok(())
            }

            /// The same with what a file changes.
            pub(crate) fn changed(mut self, changes: $Changes) -> Self {
                $(self.$name = changes.$name.unwrap_or(self.$name);)+
                $($(
                    if let Some(changes) = changes.$group {
                        self.$group = self.$group.changed(changes);
                    }
                )+)?
                self
            }
        }
    };
}
pub(crate) use constants;
