//! Faults that somebody has made on purpose, from a recording: the paper's signatures "must be captured on test experiments". A row is
//! proposed for each name, put into the tables if it can stand beside the others, and tried on the recording. Beside it the likelihood diagnosis is taught
//! what the fault changes.

mod marks;
mod proposal;
mod text;
mod trial;

use anyhow::Context;
use fdi_core::diagnosis::signature::{MAX_ROWS, Signature, Symptoms};
use fdi_core::diagnosis::teach::tables;
use fdi_core::likelihood::taught::{self, Changed, MAX_TAUGHT, Response};
use fdi_core::name::Name;
use fdi_core::{Config, Instrument, Report};

pub use marks::{Marks, Span};
pub use proposal::Proposal;
pub use trial::{Quiet, Trial};

use crate::experiment::tick_time;

/// What both diagnoses say over a recording.
pub struct Diagnoses {
    /// Ts in s.
    pub sample_time: f64,
    /// Tick by tick.
    pub said: Vec<Said>,
}

/// What both diagnoses say on a tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Said {
    /// The symptoms of the low-passed residuals; `None` where nothing was monitored.
    symptoms: Option<Symptoms>,
    /// What an alarm of the likelihood diagnosis has changed.
    changed: Option<Changed>,
    /// The taught fault that it sees.
    taught: Option<Name>,
}

impl Said {
    /// What an instrument has just said.
    pub fn of(instrument: &Instrument, report: &Report) -> Self {
        Self {
            symptoms: report.filtered.map(|verdict| verdict.symptoms),
            changed: instrument.likelihood().changed(),
            taught: report.likelihood.taught.map(|taught| taught.name),
        }
    }
}

impl Diagnoses {
    /// Every tick with its time in s.
    fn ticks(&self) -> impl Iterator<Item = (f64, &Said)> {
        (0..).map(|tick| tick_time(tick, self.sample_time)).zip(&self.said)
    }

    /// Ticks that were monitored, with their times in s.
    fn monitored(&self) -> impl Iterator<Item = (f64, &Symptoms)> {
        self.ticks().filter_map(|(time, said)| Some((time, said.symptoms.as_ref()?)))
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
    /// The response that the name had.
    before: Option<Response>,
    /// What recordings without a fault say of the response.
    pub quiet_recall: Quiet,
    /// How the likelihood diagnosis does with all new responses; `None` for one that is not taught.
    pub recall: Option<Trial>,
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
    pub fn of(
        diagnoses: &Diagnoses,
        config: &Config,
        marks: &[Marks],
        quiet: &[Diagnoses],
    ) -> anyhow::Result<Self> {
        let mut config = config.clone();
        let mut lessons = Vec::new();
        for marks in marks {
            let before = config.diagnosis.clone();
            let number = tables::make_room(&mut config.diagnosis, marks.name);
            let proposal = Proposal::of(diagnoses, marks, number)?;
            let pattern = proposal.row.pattern;
            let conflicts = tables::conflicts(&config.diagnosis, pattern)
                .map(|(place, row)| Conflict { place, row: *row, same: row.pattern == pattern })
                .collect();
            let mut lesson = Lesson {
                proposal,
                conflicts,
                quiet: Quiet::default(),
                trial: None,
                before: None,
                quiet_recall: Quiet::default(),
                recall: None,
            };
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
            if let Some(response) = lesson.proposal.response {
                let known = |known: &&Response| known.name == marks.name;
                lesson.before = config.likelihood.taught.iter().find(known).copied();
                taught::put(&mut config.likelihood.taught, response).ok().with_context(|| {
                    format!("{MAX_TAUGHT} faults can be taught: take one away before {} is", marks.name)
                })?;
            }
            lessons.push(lesson);
        }
        for lesson in lessons.iter_mut().filter(|lesson| lesson.stands()) {
            lesson.trial = Some(Trial::of(diagnoses, &config, lesson.proposal.row.number, marks));
        }
        Ok(Self { lessons, config })
    }

    /// Tries the responses: `diagnoses` and `quiet` are the same recordings with [`Self::config`]'s responses in force from their start on. One that a
    /// recording without a fault shows is taken away, and what the name had before put back.
    pub fn recall(&mut self, diagnoses: &Diagnoses, marks: &[Marks], quiet: &[Diagnoses]) {
        for lesson in &mut self.lessons {
            let Some(Response { name, .. }) = lesson.proposal.response else { continue };
            lesson.quiet_recall = Quiet::recalled(quiet, name);
            if lesson.quiet_recall.named == 0 {
                lesson.recall = Some(Trial::recalled(diagnoses, marks, name));
                continue;
            }
            let taught = &mut self.config.likelihood.taught;
            match (taught.iter_mut().find(|known| known.name == name), lesson.before) {
                (Some(known), Some(before)) => *known = before,
                _ => taught.retain(|known| known.name != name),
            }
        }
    }

    /// Whether every row is in the tables.
    pub fn all_stand(&self) -> bool {
        self.lessons.iter().all(Lesson::stands)
    }

    /// Whether the likelihood diagnosis was taught every fault, and finds it again.
    pub fn all_are_recalled(&self) -> bool {
        let found = |trial: &Trial| trial.hits.iter().any(Option::is_some);
        self.lessons.iter().all(|lesson| lesson.recall.as_ref().is_some_and(found))
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
