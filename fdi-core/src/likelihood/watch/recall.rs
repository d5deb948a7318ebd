//! Faults of the user's own: told beside the class of an alarm, and what an alarm has changed, by which they are taught.

use super::naming::{CERTAIN, HALF_OF_95, PROCESS_TIME, SIZE_ERROR, STRANGE, UNNAME, fits};
use super::{Gathered, KAPPA, Watch, WatchState};
use crate::bounds::smaller;
use crate::likelihood::alarm::Alarm;
use crate::likelihood::evidence::{Freed, Nuisances};
use crate::likelihood::hypothesis::{COUNT, HYPOTHESES};
use crate::likelihood::taught::{Effects, Recalled, TaughtFinding, likeliest, of_hypothesis, spreads};
use crate::likelihood::verdict::Magnitude;
use crate::root::sqrt;

impl Watch {
    /// Tells the taught fault that is likelier than all classes together, where it fits; `left` is what the nuisances leave of the residual
    /// sum of squares.
    pub(super) fn recall(
        &self,
        g: &Gathered,
        alarm: &mut Alarm,
        recalled: &Recalled,
        (classes, left): (f32, f32),
    ) {
        let (place, confidence) = likeliest(recalled, classes);
        let Freed { gain, value, variance, .. } = recalled[place % recalled.len()];
        let was = alarm.taught.is_some_and(|was| usize::from(was.place) == place);
        let least = if was { self.naming - UNNAME } else { self.naming };
        let fits = fits(g, left - 2.0 * KAPPA * gain, STRANGE);
        let half_width = HALF_OF_95 * sqrt(variance + SIZE_ERROR[0] * SIZE_ERROR[0] * value * value);
        alarm.taught = (alarm.age >= PROCESS_TIME && confidence > least && fits).then(|| TaughtFinding {
            place: place as u8,
            confidence: smaller(CERTAIN, confidence),
            magnitude: Magnitude { value: 100.0 * value, half_width: 100.0 * half_width },
        });
    }
}

impl WatchState {
    /// The taught fault that the alarm is.
    pub(in crate::likelihood) fn taught(&self) -> Option<TaughtFinding> {
        self.alarm.as_ref()?.taught
    }

    /// What the alarm has changed, once that can be told: what the likeliest hypothesis says if that explains it better than that all changes at once,
    /// whose noise it does not have.
    pub(in crate::likelihood) fn effects(&self, g: &Gathered) -> Option<Effects> {
        let alarm = self.alarm.as_ref().filter(|alarm| alarm.age >= PROCESS_TIME)?;
        let (all, gain) = Nuisances::new(&g.since, &self.nuisances(), KAPPA).changes(&spreads());
        let likeliest =
            of_hypothesis(&HYPOTHESES[alarm.hypothesis % COUNT], alarm.values).filter(|_| alarm.gain > gain);
        likeliest.or(Some(all))
    }
}
