//! The bank in words, for documents: what each hypothesis frees, and what moves without being a fault.

use super::class::FaultClass;
use super::evidence::{Nuisance, Prior};
use super::hypothesis::{self, COUNT, NUISANCES_SINCE_ONSET, NUISANCES_SINCE_TRAINING, UNBOUNDED};
use super::tuning::Tuned;

/// What is free, with mean and standard deviation of its prior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// What it is.
    pub name: &'static str,
    /// Its unit; empty for shares.
    pub unit: &'static str,
    /// Mean of its prior.
    pub mean: f32,
    /// Standard deviation of its prior.
    pub sd: f32,
}

/// A hypothesis.
#[derive(Clone, Copy, Debug)]
pub struct Described {
    /// What it is called.
    pub class: FaultClass,
    /// Its magnitude.
    pub first: Term,
    /// What else it frees.
    pub second: Option<Term>,
    /// The second's mean is what the thermistor reads when the fault begins.
    pub stuck_at: bool,
    /// Bounds of its magnitude, where it has any.
    pub range: Option<(f32, f32)>,
    /// Logarithm of its odds against the common faults beforehand.
    pub prior: f32,
    /// It is asked since training, too.
    pub since_training: bool,
}

impl Term {
    fn of(free: Prior) -> Self {
        let (name, unit) = free.direction.name();
        Self { name, unit, mean: free.mean, sd: free.sd }
    }

    fn nuisance((direction, sd): Nuisance) -> Self {
        Self::of(Prior { direction, mean: 0.0, sd })
    }
}

/// All hypotheses with these numbers.
pub fn hypotheses(tuning: Tuned) -> [Described; COUNT] {
    tuning.hypotheses().map(|row| Described {
        class: row.class,
        first: Term::of(row.first),
        second: row.second.map(Term::of),
        stuck_at: row.stuck_at.is_some(),
        range: (row.range != UNBOUNDED).then_some(row.range),
        prior: row.prior,
        since_training: row.lasting,
    })
}

/// The nuisances since an onset.
pub fn since_onset(tuning: Tuned) -> [Term; NUISANCES_SINCE_ONSET] {
    hypothesis::nuisances_since_onset(&tuning.nuisances).map(Term::nuisance)
}

/// The nuisances since training.
pub fn since_training(tuning: Tuned) -> [Term; NUISANCES_SINCE_TRAINING] {
    hypothesis::nuisances_since_training(&tuning.nuisances).map(Term::nuisance)
}

/// By what the model may be wrong right after training.
pub fn model_errors(tuning: Tuned) -> [Term; 7] {
    hypothesis::model_errors(&tuning.nuisances).map(Term::nuisance)
}
