//! The name that a user gives to a fault of his own.
//!
//! ```
//! use fdi_core::name::Name;
//!
//! let name: Name = "hand".parse().unwrap();
//! assert_eq!(name.as_str(), "hand");
//! assert!("two words".parse::<Name>().is_err());
//! ```

use core::fmt;

/// Bytes that the longest name takes.
pub const NAME_BYTES: usize = 12;

/// A letter, then letters, digits, `-` and `_`; or nothing at all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Name([u8; NAME_BYTES]);

impl Name {
    /// No name.
    pub const NONE: Self = Self([0; NAME_BYTES]);

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        *self == Self::NONE
    }

    /// The name as text.
    #[inline]
    pub fn as_str(&self) -> &str {
        let used = self.0.split(|byte| *byte == 0).next().unwrap_or_default();
        core::str::from_utf8(used).unwrap_or_default() // ASCII, by the only ways to make one
    }

    /// Its bytes, with zeros behind it.
    pub fn bytes(&self) -> [u8; NAME_BYTES] {
        self.0
    }

    /// The name that these bytes are; none where they are not one.
    #[inline]
    pub fn from_bytes(bytes: [u8; NAME_BYTES]) -> Self {
        let name = Self(bytes);
        name.as_str().parse().unwrap_or_default()
    }
}

impl fmt::Display for Name {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

/// Why a text is no [`Name`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NameError;

impl fmt::Display for NameError {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected a name: a letter, then letters, digits, - or _, at most {NAME_BYTES} in all")
    }
}

impl core::error::Error for NameError {}

impl core::str::FromStr for Name {
    type Err = NameError;

    #[inline]
    fn from_str(text: &str) -> Result<Self, NameError> {
        let mut bytes = [0; NAME_BYTES];
        let fits = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_');
        if !text.starts_with(|first: char| first.is_ascii_alphabetic()) || !text.bytes().all(fits) {
            return Err(NameError);
        }
        let place = bytes.get_mut(..text.len()).ok_or(NameError)?;
        place.copy_from_slice(text.as_bytes());
        Ok(Self(bytes))
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Name {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Name {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text;
        impl serde::de::Visitor<'_> for Text {
            type Value = Name;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Display::fmt(&NameError, f)
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Name, E> {
                text.parse().map_err(|_| E::invalid_value(serde::de::Unexpected::Str(text), &self))
            }
        }
        deserializer.deserialize_str(Text)
    }
}
