//! The row that the repetitions of a fault have in common.

use anyhow::Context;
use fdi_core::diagnosis::signature::Signature;
use fdi_core::diagnosis::teach::{self, Steady, common};
use fdi_core::likelihood::taught::{Effects, Mean, Response};

use super::{Diagnoses, Marks, Span};

/// So much of a repetition must have been monitored.
const MONITORED: f64 = 0.9;
/// The fault may have been there for so long when somebody notes the time, s.
const LATE: f64 = 5.0;

/// What the residuals did in one repetition.
pub struct Repetition {
    /// When.
    pub span: Span,
    /// The symptom of each decisive residual at its end.
    pub symptoms: Steady,
    /// What an alarm of the likelihood diagnosis has changed, in the mean; `None` without one.
    pub effects: Option<Effects>,
}

/// A row, and what it rests on.
pub struct Proposal {
    /// The row.
    pub row: Signature,
    /// What each repetition said.
    pub repetitions: Vec<Repetition>,
    /// What the likelihood diagnosis is taught; `None` where it saw no alarm in some repetition.
    pub response: Option<Response>,
}

impl Proposal {
    /// What all repetitions have in common; what they have not may be anything.
    ///
    /// # Errors
    /// A repetition that was not monitored throughout.
    pub fn of(diagnoses: &Diagnoses, marks: &Marks, number: u8) -> anyhow::Result<Self> {
        let repetitions = marks
            .spans
            .iter()
            .map(|span| Repetition::of(diagnoses, *span))
            .collect::<anyhow::Result<Vec<_>>>()?;
        let steady: Vec<Steady> = repetitions.iter().map(|repetition| repetition.symptoms).collect();
        let pattern = common(&steady);
        let mut seen = Mean::default();
        repetitions.iter().filter_map(|repetition| repetition.effects.as_ref()).for_each(|one| seen.add(one));
        let all = seen.value().filter(|_| seen.count as usize == repetitions.len());
        let response = all.map(|effects| Response::new(marks.name, &effects));
        let response = response.filter(|response| !response.is_nothing());
        Ok(Self { row: Signature { number, pattern, name: marks.name }, repetitions, response })
    }

    /// Whether the row asks for anything that a rig without a fault does not show.
    pub fn tells(&self) -> bool {
        teach::tells(&self.row.pattern)
    }
}

impl Repetition {
    fn of(diagnoses: &Diagnoses, span: Span) -> anyhow::Result<Self> {
        let ticks = |seconds: f64| (seconds / diagnoses.sample_time) as u32;
        let mut repetition = teach::Repetition::begin(ticks(span.from), ticks(LATE));
        for (_, said) in diagnoses.ticks().filter(|(time, _)| span.holds(*time)) {
            said.symptoms.iter().for_each(|symptoms| repetition.push(symptoms));
            said.changed.iter().for_each(|changed| repetition.add(changed));
        }
        let ticks = (span.to - span.from) / diagnoses.sample_time;
        let enough = f64::from(repetition.ticks()) >= MONITORED * ticks.floor();
        let symptoms = repetition.steady().filter(|_| enough).with_context(|| {
            format!("from {} to {} s the instrument does not monitor in this recording", span.from, span.to)
        })?;
        Ok(Self { span, symptoms, effects: repetition.effects() })
    }
}
