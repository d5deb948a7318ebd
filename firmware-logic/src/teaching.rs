//! A fault that somebody makes on purpose beside the running board, repetition by repetition, until its row is saved or dropped.

use core::fmt;

use fdi_core::diagnosis::name::Name;
use fdi_core::diagnosis::signature::{Signature, Symptoms};
use fdi_core::diagnosis::teach::{Repetition, Steady, common, tables, tells};
use fdi_core::{Config, diagnosis::config::DiagnosisConfig};

/// Repetitions that there is room for.
const REPETITIONS: usize = 8;
/// Ticks of the shortest repetition: 2 s by the default sample time.
const SHORTEST: u32 = 18;

/// What was shown so far.
#[derive(Clone, Debug, Default)]
pub struct Teaching {
    name: Name,
    repetitions: heapless::Vec<Steady, REPETITIONS>,
    current: Option<Repetition>,
}

/// Why it cannot be taught.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TeachError {
    /// Symptoms are there only while it monitors.
    NotMonitoring,
    /// A repetition has begun already.
    Begun,
    /// None has begun, or monitoring has ended meanwhile.
    NotBegun,
    /// The repetition is too short to say anything.
    TooShort,
    /// There is room for no more.
    Enough,
    /// Another name has repetitions that are neither saved nor dropped.
    Other(Name),
    /// There are no repetitions.
    Nothing,
    /// Nothing is certain that a rig without a fault does not show.
    Quiet,
    /// Some symptoms match this row of the isolation table, too: its place, from 1, and its number.
    Conflict(usize, u8),
    /// The tables are full.
    Full,
}

impl fmt::Display for TeachError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotMonitoring => "only while it monitors, see `status`",
            Self::Begun => "a repetition is under way, expected `teach end` first",
            Self::NotBegun => "no repetition is under way, or monitoring has ended meanwhile",
            Self::TooShort => "that was too short, expected some 20 s",
            Self::Enough => "that was enough, expected `teach save` or `teach drop`",
            Self::Other(name) => {
                return write!(f, "expected `teach save` or `teach drop` of {name} first");
            }
            Self::Nothing => "there is nothing yet, expected `teach NAME` first",
            Self::Quiet => "nothing of it is certain that a rig without a fault does not show",
            Self::Conflict(place, number) => {
                return write!(f, "some symptoms match row {place} of isolation, too (fiv {number})");
            }
            Self::Full => "the tables are full, expected `set diagnosis.isolation.N none` first",
        })
    }
}

impl Teaching {
    /// What it is called.
    pub fn name(&self) -> Name {
        self.name
    }

    /// The repetitions so far.
    pub fn repetitions(&self) -> &[Steady] {
        &self.repetitions
    }

    /// A repetition begins; which one, from 1.
    ///
    /// # Errors
    /// One is under way; there are enough; another name is not done with.
    pub fn begin(&mut self, name: Name) -> Result<usize, TeachError> {
        match self.current {
            Some(_) => Err(TeachError::Begun),
            None if self.repetitions.is_full() => Err(TeachError::Enough),
            None if name != self.name && !self.repetitions.is_empty() => Err(TeachError::Other(self.name)),
            None => {
                self.name = name;
                self.current = Some(Repetition::default());
                Ok(self.repetitions.len() + 1)
            }
        }
    }

    /// One tick; without symptoms, where nothing is monitored, what has begun is worth nothing.
    pub fn step(&mut self, symptoms: Option<&Symptoms>) {
        match (symptoms, &mut self.current) {
            (Some(symptoms), Some(repetition)) => repetition.push(symptoms),
            _ => self.current = None,
        }
    }

    /// The repetition ends; what was steady in it.
    ///
    /// # Errors
    /// None is under way; it was too short.
    pub fn end(&mut self) -> Result<Steady, TeachError> {
        let repetition = self.current.take().ok_or(TeachError::NotBegun)?;
        let long = Some(repetition).filter(|repetition| repetition.ticks() >= SHORTEST);
        let steady = long.and_then(|repetition| repetition.steady()).ok_or(TeachError::TooShort)?;
        self.repetitions.push(steady).map_err(|_| TeachError::Enough)?;
        Ok(steady)
    }

    /// Settings with the row that the repetitions have in common, and the row.
    ///
    /// # Errors
    /// Why it cannot stand; the row beside it, where there is one.
    pub fn proposed(&self, config: &Config) -> Result<(Config, Signature), (TeachError, Option<Signature>)> {
        if self.repetitions.is_empty() {
            return Err((TeachError::Nothing, None));
        }
        let mut config = config.clone();
        let number = tables::make_room(&mut config.diagnosis, self.name);
        let row = Signature { number, pattern: common(&self.repetitions), name: self.name };
        match put(&mut config.diagnosis, row) {
            Ok(()) => Ok((config, row)),
            Err(error) => Err((error, Some(row))),
        }
    }
}

fn put(config: &mut DiagnosisConfig, row: Signature) -> Result<(), TeachError> {
    if !tells(&row.pattern) {
        return Err(TeachError::Quiet);
    }
    if let Some((place, other)) = tables::conflicts(config, row.pattern).next() {
        return Err(TeachError::Conflict(place, other.number));
    }
    tables::add(config, row).map_err(|_| TeachError::Full)
}
