//! The row that the repetitions of a fault have in common.

use anyhow::Context;
use fdi_core::diagnosis::signature::Signature;
use fdi_core::diagnosis::teach::{self, Steady, common};

use super::{Marks, Span, Watch};

/// So much of a repetition must have been monitored.
const MONITORED: f64 = 0.9;

/// What the residuals did in one repetition.
pub struct Repetition {
    /// When.
    pub span: Span,
    /// The symptom of each decisive residual in the later half.
    pub symptoms: Steady,
}

/// A row, and what it rests on.
pub struct Proposal {
    /// The row.
    pub row: Signature,
    /// What each repetition said.
    pub repetitions: Vec<Repetition>,
}

impl Proposal {
    /// What all repetitions have in common; what they have not may be anything.
    ///
    /// # Errors
    /// A repetition that was not monitored throughout.
    pub fn of(watch: &Watch, marks: &Marks, number: u8) -> anyhow::Result<Self> {
        let repetitions = marks
            .spans
            .iter()
            .map(|span| Repetition::of(watch, *span))
            .collect::<anyhow::Result<Vec<_>>>()?;
        let steady: Vec<Steady> = repetitions.iter().map(|repetition| repetition.symptoms).collect();
        let pattern = common(&steady);
        Ok(Self { row: Signature { number, pattern, name: marks.name }, repetitions })
    }

    /// Whether the row asks for anything that a rig without a fault does not show.
    pub fn tells(&self) -> bool {
        teach::tells(&self.row.pattern)
    }
}

impl Repetition {
    fn of(watch: &Watch, span: Span) -> anyhow::Result<Self> {
        let mut repetition = teach::Repetition::default();
        let there = watch.monitored().filter(|(time, _)| span.holds(*time));
        there.for_each(|(_, symptoms)| repetition.push(symptoms));
        let ticks = (span.to - span.from) / watch.sample_time;
        let enough = f64::from(repetition.ticks()) >= MONITORED * ticks.floor();
        let symptoms = repetition.steady().filter(|_| enough).with_context(|| {
            format!("from {} to {} s the instrument does not monitor in this recording", span.from, span.to)
        })?;
        Ok(Self { span, symptoms })
    }
}
