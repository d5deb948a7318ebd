//! The settings by name, as in the TOML file of the host, and how each is shown and changed.

use core::fmt;

use fdi_core::diagnosis::signature::MAX_ROWS;
use fdi_core::likelihood::taught::MAX_TAUGHT;
use fdi_core::settings::{Kind, Value};
use fdi_core::{Config, Setting};

use super::bits::bits;
use super::error::{Expected, SetError};
use super::response;
use super::table::{Table, set_row};
use super::text;
use crate::decimal::{self, Short};

/// The name of a setting, resolved.
#[derive(Clone, Copy)]
pub enum Name {
    /// One with a value of its own.
    Entry(&'static Setting),
    /// Row of a table, from 0; written from 1 on, as in `diagnosis.isolation.1`.
    Row(Table, usize),
    /// A fault of the user's own, from 0; written from 1 on, as in `likelihood.taught.1`.
    Response(usize),
}

impl Name {
    /// Looks up a whole name.
    ///
    /// # Errors
    /// [`SetError::Unknown`].
    pub fn find(name: &str) -> Result<Self, SetError<'_>> {
        if let Some(setting) = Config::settings().find(|setting| setting.name == name) {
            return Ok(Self::Entry(setting));
        }
        // Its place behind this beginning, from 0.
        let place = |start: &str, most: usize| {
            let number: usize = decimal::whole(name.strip_prefix(start)?)?;
            (1..=most).contains(&number).then(|| number - 1)
        };
        let row = |(table, start)| Some(Self::Row(table, place(start, MAX_ROWS)?));
        let response = || place(response::START, MAX_TAUGHT).map(Self::Response);
        Table::ALL.into_iter().find_map(row).or_else(response).ok_or(SetError::Unknown(name))
    }

    /// All names that have a value in `config`.
    pub fn all(config: &Config) -> impl Iterator<Item = Self> {
        let rows = |table: Table| (0..table.rows(config).len()).map(move |row| Self::Row(table, row));
        let rows = rows(Table::Detection).chain(rows(Table::Isolation));
        let responses = (0..config.likelihood.taught.len()).map(Self::Response);
        Config::settings().map(Self::Entry).chain(rows).chain(responses)
    }

    /// Whether the name begins so; of the number of a row all of it.
    pub fn starts_with(&self, beginning: &str) -> bool {
        match self {
            Self::Entry(setting) => setting.name.starts_with(beginning),
            Self::Row(table, row) => numbered(Table::ALL[*table as usize].1, *row, beginning),
            Self::Response(place) => numbered(response::START, *place, beginning),
        }
    }

    /// Whether the value is the same in both configurations, to the bit.
    pub fn same(&self, a: &Config, b: &Config) -> bool {
        match self {
            Self::Entry(setting) => bits(setting.kind, a.get(setting)) == bits(setting.kind, b.get(setting)),
            Self::Row(table, row) => table.rows(a).get(*row) == table.rows(b).get(*row),
            Self::Response(place) => a.likelihood.taught.get(*place) == b.likelihood.taught.get(*place),
        }
    }

    /// The value as text, with its unit.
    pub fn value(self, config: &Config) -> impl fmt::Display {
        fmt::from_fn(move |f| match self {
            Self::Entry(setting) => with_unit(f, setting, config.get(setting)),
            Self::Row(table, row) => match table.rows(config).get(row) {
                Some(signature) => {
                    write!(f, "{} {}", u32::from(signature.number), signature.pattern)?;
                    if signature.name.is_empty() { Ok(()) } else { write!(f, " {}", signature.name) }
                }
                None => f.write_str("none"),
            },
            Self::Response(place) => match config.likelihood.taught.get(place) {
                Some(taught) => response::write(f, taught),
                None => f.write_str("none"),
            },
        })
    }

    /// Writes a value into a configuration; whether it is in bounds is for the core to judge.
    ///
    /// # Errors
    /// What was expected instead.
    pub fn set<'a>(&self, config: &mut Config, name: &'a str, text: &'a str) -> Result<(), SetError<'a>> {
        match self {
            Self::Entry(setting) => {
                let wrong = |expected| SetError::Value { name, given: text, expected };
                let value = text::parse(setting.kind, text, decimal::parse).map_err(wrong)?;
                match (config.set(setting, value), setting.kind) {
                    (false, Kind::Whole { min, max }) => Err(wrong(Expected::Whole { min, max })),
                    _ => Ok(()), // what was read is of this kind
                }
            }
            Self::Row(table, row) => set_row(table.rows_mut(config), *row, name, text),
            Self::Response(place) => response::set(&mut config.likelihood.taught, *place, name, text),
        }
    }
}

fn with_unit(f: &mut fmt::Formatter<'_>, setting: &Setting, value: Value) -> fmt::Result {
    text::write(f, setting.kind, value, Short)?;
    if setting.unit.is_empty() { Ok(()) } else { write!(f, " {}", setting.unit) }
}

/// A setting with a value, to be shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Valued {
    /// The setting.
    pub setting: &'static Setting,
    /// The value.
    pub value: Value,
}

impl Valued {
    /// The limits that are wider than their defaults.
    pub fn wider_than_default(config: &Config) -> impl Iterator<Item = Self> {
        config.wider_than_default().map(|setting| Self { setting, value: config.get(setting) })
    }
}

impl fmt::Display for Valued {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = ", self.setting.name)?;
        with_unit(f, self.setting, self.value)
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Entry(setting) => f.write_str(setting.name),
            Self::Row(table, row) => write!(f, "{}{}", Table::ALL[*table as usize].1, row + 1),
            Self::Response(place) => write!(f, "{}{}", response::START, place + 1),
        }
    }
}

/// Whether a name with a number, from 0, begins so; of the number all of it.
fn numbered(start: &str, place: usize, beginning: &str) -> bool {
    start.starts_with(beginning) || beginning.strip_prefix(start).and_then(decimal::whole) == Some(place + 1)
}
