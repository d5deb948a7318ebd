//! What the models say on a tick, and an alarm under way.

use super::class::FaultClass;
use super::verdict::{Finding, TaughtFinding};

/// What an alarm since an onset is held for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    /// Class of the likeliest hypothesis, and the value of what that frees first.
    pub(super) class: FaultClass,
    pub(super) value: f32,
    pub(super) onset: u32,
    /// Its name, once it has one.
    pub(super) named: Option<Finding>,
}

/// What the models say on a tick: None where a bank has no alarm, an alarm without a finding where it has no name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Said {
    pub(super) since_onset: Option<Option<Finding>>,
    pub(super) since_training: Option<Option<Finding>>,
    /// Where a bank has a name: which thermistor sees too little of a rise that the other sees, and whether T1 moves as expected.
    pub(super) by_rises: Option<Finding>,
    pub(super) t1_moves: bool,
}

impl Said {
    /// Whether either bank has an alarm.
    pub(super) fn alarm(&self) -> bool {
        self.since_onset.is_some() || self.since_training.is_some()
    }

    /// What the banks call it: what began at an onset first, then what has changed since training.
    pub(super) fn by_models(&self) -> Option<Finding> {
        self.since_onset.flatten().or(self.since_training.flatten())
    }
}

/// An alarm under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alarm {
    pub(super) onset: u32,
    /// Since it was raised, s of the reference rig.
    pub(super) age: f32,
    pub(super) finding: Option<Finding>,
    /// The fault of the user's own that it is.
    pub(super) taught: Option<TaughtFinding>,
    /// No hypothesis fits, and on which share of the last judgements none did.
    pub(super) strange: bool,
    pub(super) misfit: f32,
    /// Gain of the best hypothesis; the likeliest, the values of what it frees, and what it gains without its prior.
    pub(super) gain: f32,
    pub(super) hypothesis: usize,
    pub(super) values: [f32; 2],
    pub(super) evidence: f32,
    /// Whose turn it is: the ranking's, or the end's.
    pub(super) turn: bool,
}

impl Alarm {
    /// A fault thought to have begun on tick `onset`.
    pub(super) fn new(onset: u32) -> Self {
        Self {
            onset,
            age: 0.0,
            finding: None,
            taught: None,
            strange: false,
            misfit: 0.0,
            gain: 0.0,
            hypothesis: 0,
            values: [0.0; 2],
            evidence: 0.0,
            turn: false,
        }
    }
}
