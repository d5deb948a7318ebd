//! What the models say on a tick, and an alarm under way.

use super::verdict::{Finding, TaughtFinding};

/// What the models say on a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum ModelAlarm {
    /// All is as expected.
    #[default]
    Quiet,
    /// Something is wrong, and it cannot be told what.
    Unnamed,
    /// Something is wrong, and it is this.
    Named(Finding),
}

impl ModelAlarm {
    /// What is wrong, where that is known.
    pub(super) fn finding(self) -> Option<Finding> {
        match self {
            Self::Named(finding) => Some(finding),
            Self::Quiet | Self::Unnamed => None,
        }
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
