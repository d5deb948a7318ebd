//! What repetitions have in common.

use super::Steady;
use crate::diagnosis::signature::{Cell, Pattern, Symptoms};

/// What is certain of all repetitions; what is not may be anything.
#[inline]
pub fn common(repetitions: &[Steady]) -> Pattern {
    Pattern(core::array::from_fn(|i| {
        let mut symptoms = repetitions.iter().map(|steady| steady[i]);
        let first = symptoms.next().flatten();
        first.filter(|_| symptoms.all(|symptom| symptom == first)).map_or(Cell::Any, Cell::Is)
    }))
}

/// Whether a pattern asks for anything that a rig without a fault does not show.
#[inline]
pub fn tells(pattern: &Pattern) -> bool {
    !pattern.matches(&Symptoms::default())
}
