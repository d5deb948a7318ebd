//! The row that the repetitions of a fault have in common.

use anyhow::ensure;
use fdi_core::diagnosis::signature::{Cell, Pattern, Signature, Symptom, Symptoms, WIDTH};

use super::{Marks, Span, Watch};

/// A residual has a symptom if so many of the ticks have it; else it comes and goes.
const STEADY: f64 = 0.9;

/// What the residuals did in one repetition.
pub struct Repetition {
    /// When.
    pub span: Span,
    /// The symptom of each decisive residual in the later half; `None` where it came and went.
    pub symptoms: [Option<Symptom>; WIDTH],
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
    /// A repetition that was not monitored throughout its later half.
    pub fn of(watch: &Watch, marks: &Marks, number: u8) -> anyhow::Result<Self> {
        let repetitions = marks
            .spans
            .iter()
            .map(|span| Repetition::of(watch, *span))
            .collect::<anyhow::Result<Vec<_>>>()?;
        let cell = |i: usize| {
            let mut symptoms = repetitions.iter().map(|repetition| repetition.symptoms[i]);
            let first = symptoms.next().flatten()?;
            symptoms.all(|symptom| symptom == Some(first)).then_some(first)
        };
        let pattern = Pattern(std::array::from_fn(|i| cell(i).map_or(Cell::Any, Cell::Is)));
        Ok(Self { row: Signature { number, pattern, name: marks.name }, repetitions })
    }

    /// Whether the row asks for anything that a rig without a fault does not show.
    pub fn tells(&self) -> bool {
        !self.row.pattern.matches(&Symptoms::default())
    }
}

impl Repetition {
    fn of(watch: &Watch, span: Span) -> anyhow::Result<Self> {
        let half = span.later_half();
        let seen: Vec<&Symptoms> =
            watch.monitored().filter(|(time, _)| half.holds(*time)).map(|(_, symptoms)| symptoms).collect();
        let ticks = (half.to - half.from) / watch.sample_time;
        ensure!(
            seen.len() as f64 >= STEADY * ticks.floor(),
            "from {} to {} s the instrument does not monitor in this recording",
            span.from,
            span.to
        );
        let enough = (STEADY * seen.len() as f64).ceil() as usize;
        let steady = |i: usize| {
            let has = |wanted: Symptom| seen.iter().filter(|s| s[i] == wanted).count() >= enough;
            [Symptom::Low, Symptom::Normal, Symptom::High].into_iter().find(|symptom| has(*symptom))
        };
        Ok(Self { span, symptoms: std::array::from_fn(steady) })
    }
}
