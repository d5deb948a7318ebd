//! "As trained, from another state": is an alarm only what is left of something that is over?
//!
//! An open lid takes heat out of an incubator, a heater that was stuck puts some in. When that is over the rig is as it was trained, but the model, which knows
//! the power alone, is in another state, and the difference takes the rig's slowest time to vanish. So while an alarm stands, the state is looked for over the last
//! samples, again and again (`likelihood/start.rs`). This is asked where T2 is measured; elsewhere `likelihood/interacting.rs` is. Its evidence is held against what the alarm lets expect of the same samples:
//!
//! ```text
//! log odds = (evidence of some state - sum of z^2 / 2 + sum of z_alarm^2 / 2) / kappa
//! ```
//!
//! with z what the model leaves, whitened, and z_alarm what the fault leaves as it was estimated a sample before.

use crate::diagnosis::{Diagnosis, DiagnosisState};
use crate::likelihood::start::{Answer, Start};

/// The question, asked of the samples since it was begun.
#[derive(Clone, Debug)]
pub(super) struct Anew {
    start: Start,
    /// What the alarm leaves of the squares of the innovations.
    left: f32,
}

impl Anew {
    /// A sample: what T1 and T2 read beyond the model, degC. An alarm that is over ends.
    pub(super) fn look(
        asked: &mut Option<Self>,
        diagnosis: &Diagnosis,
        state: &mut DiagnosisState,
        e: [Option<f32>; 2],
    ) {
        let Some(left) = diagnosis.left_by_alarm(state) else {
            *asked = None;
            return;
        };
        if asked.is_none() {
            *asked = diagnosis.start_anew(state).map(|start| Self { start, left: 0.0 });
        }
        let Some(anew) = asked else { return };
        // A tick without samples says nothing.
        let answer = left.map_or(Answer::Open, |left| anew.step(e, left));
        if answer == Answer::Yes {
            diagnosis.end_by(state, &anew.start);
        }
        if answer != Answer::Open {
            *asked = None;
        }
    }

    fn step(&mut self, e: [Option<f32>; 2], left: f32) -> Answer {
        let before = self.start.counted();
        self.start.step(e);
        if self.start.counted() > before {
            self.left += left;
        }
        self.start.answer(self.left)
    }
}
