//! Power that T1 does not account for: the heater has given more than is harmless for long, and T1 is not as much warmer than before as any
//! healthy rig would be. Then T1 is out of the tube, or nothing heats. No setting but the answer time has a part in it, and that for ten
//! minutes at most: what the other rules rest on can be set so that they see nothing.
//!
//! T1 is taken as the converter gives it. A code is a ratio of resistances, and every NTC loses 3 to 5 % of its resistance for each degC:
//! how often it has lost a share of it, `ln R`, says how much warmer it is, whatever constants it was given. `ln R` is followed no faster than
//! it can change in a rig, so that a loose contact or a spike neither accounts for heat nor hides it.
//!
//! ```text
//! unaccounted += drive - HARMLESS - ACCOUNTED (coldest - ln R)        not below 0; a trip above 8 answer times of full power
//! ```

use super::operation::AMBIENT_RATE;
use crate::bounds::{larger, smaller};
use crate::sense::log_resistance;
use crate::units::{AdcCode, Percent, Seconds};

/// So much power on average is harmless, wherever it goes, %: less than the usual set-points need. On the rig that is stronger than the reference
/// rig by 3.3 it makes the air 20 degC warmer.
pub(crate) const HARMLESS: f32 = 20.0;
/// Power that a change of `ln R` by 1 accounts for, %. 1 degC is 0.045 at a room's temperature: a rig must rise by 9 degC at full power to
/// account for it, the reference rig at 1.5 times its air flow rises by 20.
const ACCOUNTED: f32 = 200.0;
/// Full power may go without account for so many answer times: twice as long as `supervisor.response_time` gives it by default.
const ANSWERS: f32 = 8.0;
/// An answer time beyond this counts as this, s: then full power goes without account for 10 minutes. A rig that answers within
/// `identification.answer_time` of 2500 s has risen by a tenth by then.
const LONGEST_ANSWER: f32 = 75.0;
/// `ln R` is followed by so much in an answer time; the reference rig changes it by 0.8 at full power.
const FOLLOWED: f32 = 0.3;
/// Of `ln R` for each degC, at a room's temperature.
const EACH_DEGREE: f32 = 0.045;

/// The rule, ready to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Effect {
    /// % times ticks.
    budget: f32,
    /// Of `ln R` in a tick: what is followed, and what a room may become warmer.
    step: f32,
    ambient_step: f32,
}

/// Its memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EffectState {
    /// `ln R` of T1 as followed; none before the first code.
    level: Option<f32>,
    /// The largest of it, which is when T1 was coldest, but for what the room has become warmer since.
    coldest: f32,
    /// Power without account, % times ticks.
    unaccounted: f32,
    /// It has heated; until then the present temperature is that of the rig at rest, and so is the first that is known.
    has_heated: bool,
}

impl Effect {
    pub(super) fn new(answer_time: Seconds, ts: Seconds) -> Self {
        let answer = smaller(answer_time.0, LONGEST_ANSWER);
        Self {
            budget: (100.0 - HARMLESS) * ANSWERS * answer / ts.0,
            step: FOLLOWED * ts.0 / answer,
            ambient_step: AMBIENT_RATE * EACH_DEGREE * ts.0,
        }
    }

    /// Whether too much power is without account. `drive` is what drove the heater up to now, all of it; it is judged while `heating`.
    pub(super) fn step(&self, state: &mut EffectState, t1: AdcCode, drive: Percent, heating: bool) -> bool {
        let unknown = state.level.is_none();
        if let Some(now) = log_resistance(t1) {
            let level = state.level.get_or_insert(now);
            // In this order a level that is no number, since a bit has flipped, begins anew.
            *level = smaller(larger(now, *level - self.step), *level + self.step);
        }
        let level = state.level.unwrap_or_default();
        state.has_heated |= heating;
        let coldest = if heating { state.coldest } else { state.coldest - self.ambient_step };
        state.coldest = if state.has_heated && !unknown { larger(level, coldest) } else { level };
        if !heating {
            state.unaccounted = 0.0;
            return false;
        }
        let accounted = HARMLESS + ACCOUNTED * (state.coldest - level);
        state.unaccounted = larger(0.0, state.unaccounted + drive.0 - accounted);
        !(state.unaccounted <= self.budget)
    }
}
