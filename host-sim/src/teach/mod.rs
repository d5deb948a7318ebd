//! Signatures of faults that somebody has made on purpose, from a recording: the paper's signatures "must be captured on test
//! experiments". A row is proposed for each name, put into the tables if it can stand beside the others, and tried on the recording.

mod marks;
mod proposal;
mod text;
mod trial;

use anyhow::Context;
use fdi_core::Config;
use fdi_core::diagnosis::signature::{MAX_ROWS, Signature, Symptoms};
use fdi_core::diagnosis::teach::tables;

pub use marks::{Marks, Span};
pub use proposal::Proposal;
pub use trial::{Quiet, Trial};

use crate::experiment::{Record, tick_time};

/// The symptoms of the low-passed residuals over a recording.
pub struct Watch {
    sample_time: f64,
    /// Tick by tick; `None` where nothing was monitored.
    symptoms: Vec<Option<Symptoms>>,
}

impl Watch {
    /// What the core said of each tick.
    pub fn of(record: &Record) -> Self {
        let symptoms = record.rows.iter().map(|row| Some(row.report.filtered?.symptoms)).collect();
        Self { sample_time: record.sample_time, symptoms }
    }

    /// Ticks that were monitored, with their times in s.
    fn monitored(&self) -> impl Iterator<Item = (f64, &Symptoms)> {
        let timed = (0..).map(|tick| tick_time(tick, self.sample_time)).zip(&self.symptoms);
        timed.filter_map(|(time, symptoms)| Some((time, symptoms.as_ref()?)))
    }
}

/// A row of the isolation table that some symptoms match together with the new one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conflict {
    /// Where it stands, from 1.
    pub place: usize,
    /// The row.
    pub row: Signature,
    /// It asks for nothing else at all.
    pub same: bool,
}

/// What has become of one name.
pub struct Lesson {
    /// The row, and what it rests on.
    pub proposal: Proposal,
    /// Rows that the same symptoms can match; with any of them the row is in no table.
    pub conflicts: Vec<Conflict>,
    /// What recordings without a fault say of it.
    pub quiet: Quiet,
    /// How the tables with all new rows do on the recording; `None` for a row that is in none.
    pub trial: Option<Trial>,
}

/// What was taught: the lessons, and the settings with the new rows.
pub struct Taught {
    /// One for each name.
    pub lessons: Vec<Lesson>,
    /// The settings that were given, with every row that can stand.
    pub config: Config,
}

impl Taught {
    /// Proposes a row for each name and tries all of them together, those that `quiet` recordings without a fault do not show. A row
    /// of the same name in the settings is taught anew.
    ///
    /// # Errors
    /// A span that was not monitored; more rows than a table holds.
    pub fn of(watch: &Watch, config: &Config, marks: &[Marks], quiet: &[Watch]) -> anyhow::Result<Self> {
        let mut config = config.clone();
        let mut lessons = Vec::new();
        for marks in marks {
            let before = config.diagnosis.clone();
            let number = tables::make_room(&mut config.diagnosis, marks.name);
            let proposal = Proposal::of(watch, marks, number)?;
            let pattern = proposal.row.pattern;
            let conflicts = tables::conflicts(&config.diagnosis, pattern)
                .map(|(place, row)| Conflict { place, row: *row, same: row.pattern == pattern })
                .collect();
            let mut lesson = Lesson { proposal, conflicts, quiet: Quiet::default(), trial: None };
            if lesson.stands() {
                let added = tables::add(&mut config.diagnosis, lesson.proposal.row).ok();
                added.with_context(|| {
                    format!("a table holds {MAX_ROWS} rows: take one away before {} is taught", marks.name)
                })?;
                lesson.quiet = Quiet::of(quiet, &config, number);
            }
            if !lesson.stands() {
                config.diagnosis = before; // a row of this name that works is not taken away
            }
            lessons.push(lesson);
        }
        for lesson in lessons.iter_mut().filter(|lesson| lesson.stands()) {
            lesson.trial = Some(Trial::of(watch, &config, lesson.proposal.row.number, marks));
        }
        Ok(Self { lessons, config })
    }

    /// Whether every row is in the tables.
    pub fn all_stand(&self) -> bool {
        self.lessons.iter().all(Lesson::stands)
    }
}

impl Lesson {
    /// Whether the row is in the tables.
    pub fn stands(&self) -> bool {
        self.conflicts.is_empty() && self.proposal.tells() && self.quiet.named == 0
    }
}

#[cfg(test)]
mod tests;
