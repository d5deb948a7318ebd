//! Other numbers than the default: for campaigns, on a host.

use std::boxed::Box;
use std::sync::Mutex;
use std::vec::Vec;

use serde::de::Error;
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Part, Tuned, Tuning};
use crate::likelihood::hypothesis::{COUNT, Hypothesis, rows};

/// The numbers, and the tables that follow from them.
#[derive(Debug)]
pub(super) struct Method {
    pub(super) tuning: Tuning,
    pub(super) hypotheses: [Hypothesis; COUNT],
}

impl Method {
    const fn new(tuning: Tuning) -> Self {
        Self { hypotheses: rows(&tuning), tuning }
    }
}

static DEFAULT: Method = Method::new(Tuning::DEFAULT);

impl Default for Tuned {
    fn default() -> Self {
        Self { of: &DEFAULT }
    }
}

impl From<Tuning> for Tuned {
    /// Each is made once, and stays.
    fn from(tuning: Tuning) -> Self {
        static OTHERS: Mutex<Vec<&Method>> = Mutex::new(Vec::new());
        if tuning == Tuning::DEFAULT {
            return Self::default();
        }
        let mut others = OTHERS.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(of) = others.iter().find(|method| method.tuning == tuning) {
            return Self { of };
        }
        let of: &Method = Box::leak(Box::new(Method::new(tuning)));
        others.push(of);
        Self { of }
    }
}

/// Only what differs from the default is written.
impl Serialize for Tuned {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let parts = Tuning::PARTS.iter().map(|part| (part, Others { part, tuning: self }));
        let parts: Vec<_> = parts.filter(|(_, others)| others.entries().next().is_some()).collect();
        let mut map = serializer.serialize_map(Some(parts.len()))?;
        for (part, others) in parts {
            map.serialize_entry(part.name, &others)?;
        }
        map.end()
    }
}

/// The numbers of a part that are not the default.
struct Others<'a> {
    part: &'static Part,
    tuning: &'a Tuning,
}

impl Others<'_> {
    fn entries(&self) -> impl Iterator<Item = (&'static str, f32)> {
        let values = self.part.entries.iter().map(|entry| {
            let name = entry.name.rsplit_once('.').map_or(entry.name, |(_, name)| name);
            (name, (entry.value)(self.tuning), (entry.value)(&Tuning::DEFAULT))
        });
        values.filter_map(|(name, value, default)| (value != default).then_some((name, value)))
    }
}

impl Serialize for Others<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.entries())
    }
}

impl<'de> Deserialize<'de> for Tuned {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let tuning = Tuning::deserialize(deserializer)?;
        let mut entries = Tuning::PARTS.iter().flat_map(|part| part.entries);
        match entries.find(|entry| !(entry.value)(&tuning).is_finite()) {
            Some(entry) => Err(D::Error::custom(format_args!("{} is not finite", entry.name))),
            None => Ok(tuning.into()),
        }
    }
}
