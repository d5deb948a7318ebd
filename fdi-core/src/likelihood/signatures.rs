//! What each fault would look like if it began now, for those who ask beforehand which can be told apart.
//!
//! The bank's own regressors, whitened by the noise that was learnt and driven by the power that is applied, since an onset that is only
//! assumed. Nothing here changes what the diagnosis says, and no board calls it.

use super::LikelihoodState;
use super::class::{FaultClass, Quantity};
use super::evidence::{Nuisance, Prior};
use super::hypothesis::{COUNT as HYPOTHESIS_COUNT, Hypothesis, NUISANCES_SINCE_ONSET, in_unit};
use super::onset::Onset;
use super::regressor::{COUNT, Direction, Regressor};
use super::tuning::Tuned;
use super::watch::WatchState;
use crate::bounds::{larger, smaller};

/// How many regressors there are.
pub const REGRESSORS: usize = COUNT;
/// How many nuisances there are.
pub const NUISANCES: usize = NUISANCES_SINCE_ONSET;

/// Regressors since an assumed onset.
#[derive(Clone, Copy, Debug)]
pub struct Signatures {
    onset: Onset,
    /// Rises of T1 and T2 at the onset, degC.
    at_onset: [f32; 2],
    nuisances: [Nuisance; NUISANCES],
    tuning: Tuned,
}

/// Some regressors together, with the mean and standard deviation of the factor on them.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    /// How much of each regressor.
    pub weights: [f32; REGRESSORS],
    /// Mean of the factor.
    pub mean: f32,
    /// Its standard deviation.
    pub sd: f32,
}

/// A fault that the bank knows.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// What it is called.
    pub class: FaultClass,
    /// Which of those that are called the same; empty where there is no other.
    pub which: &'static str,
    /// Its magnitude, as [`Self::in_unit`] takes it.
    pub first: Term,
    /// What else it may change.
    pub second: Option<Term>,
    /// What its magnitude may be: no more than some standard deviations from the mean of what may come.
    pub range: (f32, f32),
    /// Logarithm of its odds against the common faults before anything is seen.
    pub prior: f32,
    /// It has a magnitude that is reported.
    pub sized: bool,
}

impl Signatures {
    /// Assumes that a fault first shows on the tick that the diagnosis has just done; none where it is not armed.
    pub fn begin(state: &LikelihoodState) -> Option<Self> {
        let trained = armed(state)?;
        Some(Self {
            onset: Onset::default(),
            at_onset: trained.rises(),
            nuisances: trained.usual().since_onset(),
            tuning: trained.tuning,
        })
    }

    /// The regressors of T1 and T2 of the tick that the diagnosis has just done, in standard deviations of the innovations; none where it is
    /// not armed or has not been for long enough.
    pub fn step(&mut self, state: &LikelihoodState) -> Option<[[f32; 2]; REGRESSORS]> {
        armed(state)?.regressors(&mut self.onset)
    }

    /// What moves without being a fault.
    pub fn nuisances(&self) -> [Term; NUISANCES] {
        self.nuisances.map(|(direction, sd)| Term::of(Prior { direction, mean: 0.0, sd }))
    }

    /// The bank divides its evidence by so much.
    pub fn kappa(&self) -> f32 {
        self.tuning.alarm.kappa
    }

    /// What the bank may call it.
    pub fn candidates(&self) -> [Candidate; HYPOTHESIS_COUNT] {
        self.tuning.hypotheses().map(|row| Candidate {
            class: row.class,
            which: which(row.first.direction),
            first: Term::of(row.first),
            second: row.second_at(self.at_onset).map(Term::of),
            range: range(&row, self.tuning.hypotheses.farthest),
            prior: row.prior,
            sized: row.sized && row.class.quantity() != Quantity::Nothing,
        })
    }
}

fn armed(state: &LikelihoodState) -> Option<&WatchState> {
    state.trained.as_ref().filter(|_| state.current)
}

impl Term {
    fn of(free: Prior) -> Self {
        let mut weights = [0.0; REGRESSORS];
        for (regressor, weight) in free.direction.regressors().into_iter().zip(free.direction.weights()) {
            weights[regressor] += weight;
        }
        Self { weights, mean: free.mean, sd: free.sd }
    }
}

impl Candidate {
    /// It is the same but for the magnitude, which gives each its name.
    pub fn differs_in_size_alone(&self, other: &Self) -> bool {
        let second = |candidate: &Self| candidate.second.map(|term| term.weights);
        self.first.weights == other.first.weights && second(self) == second(other)
    }

    /// A magnitude in the unit of the class.
    pub fn in_unit(&self, magnitude: f32) -> f32 {
        in_unit(self.class, magnitude)
    }
}

fn range(row: &Hypothesis, farthest: f32) -> (f32, f32) {
    let (Prior { mean, sd, .. }, (low, high)) = (row.first, row.range);
    (larger(low, mean - farthest * sd), smaller(high, mean + farthest * sd))
}

fn which(direction: Direction) -> &'static str {
    match direction {
        Direction::Of(Regressor::ShortLoss) => "short lag",
        Direction::MidLoss => "mid lag",
        Direction::Of(Regressor::LongLoss) => "long lag",
        Direction::Of(Regressor::Ramp1) => "T1",
        Direction::Of(Regressor::Ramp2) => "T2",
        Direction::Ramp0 => "T0",
        Direction::Of(Regressor::Constant) => "constant",
        _ => "",
    }
}
