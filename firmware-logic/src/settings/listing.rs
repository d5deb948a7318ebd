//! The schema of the settings, for people: name, default, bounds.

use core::fmt;

use fdi_core::{Config, ConfigError, Instrument};

use super::schema::Name;
use crate::decimal::Short;

/// One line of the listing.
pub struct Line {
    name: Name,
    config: Config,
}

/// A line for each setting, in the order of the TOML file of the host.
pub fn lines() -> impl Iterator<Item = Line> {
    let names: heapless::Vec<Name, 128> = Name::all(&Config::default()).collect();
    names.into_iter().map(|name| Line { name, config: Config::default() })
}

impl Line {
    /// Bounds of a number: what the core answers to one that is certainly too large.
    fn bounds(&self) -> Option<(f32, f32)> {
        let Name::Entry(entry) = self.name else { return None };
        let mut config = self.config.clone();
        let text = ["1e10", "65535", "255"];
        text.iter().find(|text| self.name.set(&mut config, entry.name, text).is_ok())?;
        match Instrument::new(&config) {
            Err(ConfigError::OutOfRange { name, min, max, .. }) if name == entry.name => Some((min, max)),
            _ => None,
        }
    }
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}", self.name, self.name.value(&self.config))?;
        match self.bounds() {
            Some((min, max)) => write!(f, "   ({} to {})", Short(min), Short(max)),
            None => Ok(()),
        }
    }
}
