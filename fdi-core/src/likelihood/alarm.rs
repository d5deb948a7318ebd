//! What the models say on a tick, and an alarm under way.

use super::class::FaultClass;
use super::tuning::{AlarmTuning, NamingTuning, Tuning};
use super::verdict::{Finding, TaughtFinding};
use super::whitening::{Past, WhiteningFilter};
use crate::bounds::{larger, smaller};

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
    /// Where a bank has a name: which thermistor sees too little of a rise that the other sees, and whether T1 and T2 move as expected.
    pub(super) by_rises: Option<Finding>,
    pub(super) moves: [bool; 2],
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
    /// The whitening filter's memory of what the fault would have given since it may have ended.
    since_end: Past,
    /// Mean of what the likeliest hypothesis leaves of each innovation's square: 1 where it fits, which an alarm has to show first.
    error: f32,
    /// No hypothesis fits, and on which share of the last judgements none did.
    pub(super) strange: bool,
    pub(super) misfit: f32,
    /// Gain of the best hypothesis; the likeliest, the values of what it frees, and what it gains without its prior.
    pub(super) gain: f32,
    pub(super) hypothesis: usize,
    pub(super) values: [f32; 2],
    pub(super) evidence: f32,
    /// Whether it is judged on every second tick only, and not on this one.
    pub(super) turn: bool,
    /// Page's sum of the log odds that its fault has ended.
    pub(super) ended: f32,
}

impl Alarm {
    /// A fault thought to have begun on tick `onset`.
    pub(super) fn new(t: &NamingTuning, onset: u32) -> Self {
        Self {
            onset,
            age: 0.0,
            finding: None,
            taught: None,
            since_end: Past::default(),
            error: t.strange,
            strange: false,
            misfit: 0.0,
            gain: 0.0,
            hypothesis: 0,
            values: [0.0; 2],
            evidence: 0.0,
            turn: false,
            ended: 0.0,
        }
    }

    /// A tick: innovations `z`, and what the fault as it was lets expect of the residuals, as they are and whitened. Gives what that leaves of the squares
    /// of `z`. That the fault stays is held against that it has ended: long ago, or on the tick on which the sum began.
    pub(super) fn follow(
        &mut self,
        t: &Tuning,
        filter: &WhiteningFilter,
        z: [f32; 2],
        [plain, expected]: [[f32; 2]; 2],
    ) -> f32 {
        let squares = |z: [f32; 2]| z[0] * z[0] + z[1] * z[1];
        if self.ended == 0.0 {
            self.since_end = Past::default();
        }
        let gone = filter.step(&mut self.since_end, plain);
        let stays = [z[0] - expected[0], z[1] - expected[1]];
        let left = squares(stays);
        let of_end = smaller(squares(z), squares([stays[0] + gone[0], stays[1] + gone[1]]));
        // What the fault has left until now is no sign of its end.
        let error = larger(1.0, self.error);
        let odds = libm::logf(error) + (left / error - of_end) / (2.0 * t.alarm.kappa);
        self.ended = larger(0.0, self.ended + smaller(odds, t.alarm.over));
        let of_tick = smaller(left / 2.0, t.naming.strange * error);
        if self.ended == 0.0 || of_tick < self.error {
            self.error += t.alarm.mean_share * (of_tick - self.error);
        }
        left
    }

    /// E. S. Page's test: has the fault ended on some tick since it was raised? At once where nothing speaks for it any more: what an old alarm rests
    /// on is forgotten, also while its fault stays.
    pub(super) fn is_over(&self, t: &AlarmTuning) -> bool {
        let forgotten = self.age >= t.young && self.gain < 0.0;
        self.ended >= 2.0 * t.over || forgotten && self.ended > 0.0
    }
}

#[cfg(test)]
mod tests;
