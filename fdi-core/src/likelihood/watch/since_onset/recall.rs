//! Faults of the user's own: told beside the class of an alarm, and what an alarm has changed, by which they are taught.

use super::naming::{HALF_OF_95, fits};
use super::{SinceOnset, SinceOnsetState};
use crate::bounds::smaller;
use crate::likelihood::alarm::Alarm;
use crate::likelihood::evidence::{Estimate, Nuisances};
use crate::likelihood::hypothesis::{COUNT, HYPOTHESES, TAUGHT_PAIRS};
use crate::likelihood::taught::{Changed, Weighed, likeliest, of_hypothesis, spreads};
use crate::likelihood::usual::Usual;
use crate::likelihood::verdict::{Magnitude, TaughtFinding};
use crate::root::sqrt;

impl SinceOnset {
    /// Tells the taught fault that is likelier than all classes together, whose evidence has the logarithm `classes`, where it fits; `left` is what the
    /// nuisances leave of the residual sum of squares.
    pub(super) fn recall(
        &self,
        s: &SinceOnsetState,
        alarm: &mut Alarm,
        weighed: &Weighed,
        classes: f32,
        left: f32,
    ) {
        let (place, confidence) = likeliest(&self.taught, weighed, classes);
        let Some(response) = self.taught.get(place) else {
            alarm.taught = None;
            return;
        };
        let (t, kappa) = (&self.tuning.naming, self.tuning.alarm.kappa);
        let Estimate { gain, value, variance, .. } = weighed[place % weighed.len()];
        let was = alarm.taught.is_some_and(|was| was.name == response.name);
        let least = if was { t.lasts } else { self.naming };
        let fits = fits(s, left - 2.0 * kappa * gain, t.strange());
        let half_width = HALF_OF_95 * sqrt(variance + t.flow_error * t.flow_error * value * value);
        alarm.taught =
            (alarm.age >= self.tuning.alarm.young && confidence > least && fits).then(|| TaughtFinding {
                name: response.name,
                place: place as u8,
                confidence: smaller(t.certain, confidence),
                magnitude: Magnitude { value: 100.0 * value, half_width: 100.0 * half_width },
            });
    }
}

impl SinceOnsetState {
    /// What the alarm has changed, once that can be told: what the likeliest hypothesis says if that explains it better than that all changes at once,
    /// whose noise it does not have.
    pub(in crate::likelihood) fn changed(&self, usual: &Usual) -> Option<Changed> {
        let t = usual.tuning;
        let alarm = self.alarm.as_ref().filter(|alarm| alarm.age >= t.alarm.young)?;
        let (all, gain) = Nuisances::new(self.since.sums(), &usual.since_onset(), t.alarm.kappa)
            .beyond(&TAUGHT_PAIRS)
            .changes(&spreads(t));
        let likeliest = of_hypothesis(&HYPOTHESES[alarm.hypothesis % COUNT], alarm.values);
        let effects = likeliest.filter(|_| alarm.evidence > gain).unwrap_or(all);
        Some(Changed { onset: alarm.onset, effects })
    }
}
