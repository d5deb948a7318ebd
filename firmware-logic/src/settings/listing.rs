//! The settings as lines for people: name, value, bounds.

use core::fmt;

use fdi_core::Config;

use super::schema::Name;
use crate::decimal::Short;

/// A line for each setting.
pub fn lines(config: &Config) -> impl Iterator<Item = impl fmt::Display> {
    Name::all(config).map(move |name| {
        fmt::from_fn(move |f| {
            write!(f, "{name} = {}", name.value(config))?;
            let Name::Entry(setting) = name else { return Ok(()) };
            match setting.kind.bounds() {
                Some((min, max)) => write!(f, "   ({} to {})", Short(min), Short(max)),
                None => Ok(()),
            }
        })
    })
}
