//! The bank since training: the last minute held against the trained state, and an alarm as long as it is other than that.

use super::since_onset::{magnitude, named};
use super::steady::Steady;
use super::times::Times;
use crate::bounds::larger;
use crate::likelihood::class::{FaultClass, Quantity};
use crate::likelihood::evidence::Estimate;
use crate::likelihood::hypothesis::{COUNT, HYPOTHESES, IMPOSSIBLE};
use crate::likelihood::inputs::Inputs;
use crate::likelihood::posterior::Posterior;
use crate::likelihood::regressor::{LASTING, Regressors};
use crate::likelihood::tuning::Tuned;
use crate::likelihood::usual::Usual;
use crate::likelihood::verdict::Finding;

/// The bank.
#[derive(Clone, Debug)]
pub(super) struct SinceTraining {
    /// The smallest change of the heater's power that is a fault, a share.
    pub(super) least_power: f32,
    pub(super) sample_time: f32,
    pub(super) inputs: Inputs,
    pub(super) tuning: Tuned,
}

/// The memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct SinceTrainingState {
    steady: Steady,
    changed: Option<Change>,
}

/// What has changed since training: when that was seen, and what it is, once that can be told.
#[derive(Clone, Copy, Debug)]
struct Change {
    onset: u32,
    hypothesis: usize,
    finding: Option<Finding>,
    /// The largest change that was seen of what it is, in the unit of its regressor.
    largest: f32,
}

/// What the bank sees of a tick.
pub(super) struct Seen<'a> {
    pub(super) tick: u32,
    pub(super) times: &'a Times,
    /// Residuals, degC, and what T1 should read above T0.
    pub(super) e: [f32; 2],
    pub(super) expected: f32,
    pub(super) regressors: &'a Regressors<LASTING>,
    /// Both whitened.
    pub(super) whitened: &'a Regressors<LASTING>,
    pub(super) z: [f32; 2],
    pub(super) usual: &'a Usual,
}

impl SinceTraining {
    /// A quiet tick is gathered, and the minute judged now and then. Gives what has come and gone, and how much of it has gone.
    pub(super) fn step(&self, s: &mut SinceTrainingState, seen: &Seen) -> Option<(Quantity, f32)> {
        let curvature = s.steady.gather(
            &seen.times.steady,
            seen.regressors,
            seen.whitened,
            seen.e,
            seen.z,
            [seen.usual.curvature, seen.usual.error_of(seen.expected)],
        );
        self.judge(s, seen, curvature)
    }

    /// Whether a hypothesis is a change: its own evidence says so, not that of another which is too small to be a fault.
    fn is_there(&self, estimate: &[Estimate; COUNT], h: usize, least: f32, lasts: bool) -> bool {
        let (t, change) = (&self.tuning.since_training, &estimate[h % COUNT]);
        let (factor, share) = if lasts { (t.lasting_raise, t.lasting_size) } else { (1.0, 1.0) };
        change.gain > factor * t.raise && change.value.abs() > share * least
    }

    /// The hypothesis of what has changed, where that was `was` before. What is there lasts, but it opens no door to another thing; it lasts by its own
    /// evidence where another has become likelier.
    fn is_now(
        &self,
        was: Option<usize>,
        estimate: &[Estimate; COUNT],
        likeliest: usize,
        usual: &Usual,
    ) -> Option<usize> {
        let is_there = |h: usize, lasts: bool| {
            let class = HYPOTHESES[h % COUNT].class;
            self.is_there(estimate, h, usual.least_since_training(class, self.least_power), lasts)
        };
        let lasts = was.is_some_and(|was| is_alike(was, likeliest));
        if is_there(likeliest, lasts) { Some(likeliest) } else { was.filter(|&was| is_there(was, true)) }
    }

    /// Leaves out the hypotheses that nothing speaks for and that would be too small for a fault: they are other words for "nothing has changed".
    fn without_idle(&self, estimate: &mut [Estimate; COUNT], usual: &Usual) {
        for (estimate, row) in estimate.iter_mut().zip(&HYPOTHESES) {
            let has_no_evidence = estimate.gain < 0.0 && estimate.gain != IMPOSSIBLE;
            if has_no_evidence
                && estimate.value.abs() < usual.least_since_training(row.class, self.least_power)
            {
                estimate.gain = IMPOSSIBLE;
            }
        }
    }

    /// What the change is called, where it was called `was`, if one class is likelier than all others together; and the probability that it is a fault
    /// of that class.
    fn named(&self, posterior: &Posterior, was: Option<FaultClass>) -> Option<(FaultClass, f32)> {
        let t = &self.tuning.naming;
        let (class, among_faults) = named(t, posterior, t.apart(self.inputs, was));
        (among_faults > t.lasts).then(|| (class, among_faults * posterior.of_fault()))
    }

    fn judge(
        &self,
        s: &mut SinceTrainingState,
        seen: &Seen,
        [curvature, offset]: [f32; 2],
    ) -> Option<(Quantity, f32)> {
        let first = self.tuning.times.mean * seen.times.time_scale / self.sample_time;
        if !s.steady.is_ready(first) {
            return None;
        }
        let mut estimate = [Estimate::default(); COUNT];
        let usual = Usual { curvature, ..*seen.usual };
        let nuisances = usual.since_training(offset);
        s.steady.judge(&nuisances, &mut estimate, self.inputs);
        self.without_idle(&mut estimate, &usual);
        let posterior = Posterior::new(&estimate);
        let h = posterior.likeliest % COUNT;
        // Its size from the means above all, where these say that it can be.
        let sized = |h: usize| {
            let h = h % COUNT;
            let sized = s.steady.size(&nuisances, h, self.inputs);
            if self.tuning.hypotheses()[h].judged(sized).gain == IMPOSSIBLE { estimate[h] } else { sized }
        };
        // What is told must be a change by the size that is told, too.
        let counts = |&h: &usize| {
            let least = usual.least_since_training(HYPOTHESES[h % COUNT].class, self.least_power);
            sized(h).value.abs() > self.tuning.since_training.lasting_size * least
        };
        let now = self.is_now(s.changed.map(|was| was.hypothesis), &estimate, h, &usual).filter(counts);
        let passed = s.changed.filter(|_| now.is_none()).map(|was| {
            let h = was.hypothesis % COUNT;
            (HYPOTHESES[h].class.quantity(), was.largest - estimate[h].value.abs())
        });
        let was = s.changed.and_then(|was| was.finding).map(|was| was.class);
        let name = self.named(&posterior, was).filter(|_| now == Some(h));
        let onset = s.changed.map_or(seen.tick, |was| was.onset);
        s.changed = now.map(|now| Change {
            largest: largest(s.changed, now, estimate[now % COUNT].value.abs()),
            onset,
            hypothesis: now,
            finding: name.map(|(class, confidence)| Finding {
                class,
                confidence,
                magnitude: magnitude(&self.tuning.naming, h, class, &sized(h)),
                onset,
            }),
        });
        passed
    }
}

/// The largest value that was seen of a change which is of hypothesis `h` now; values of another unit are not compared.
fn largest(was: Option<Change>, h: usize, value: f32) -> f32 {
    let quantity = |h: usize| HYPOTHESES[h % COUNT].class.quantity();
    was.filter(|was| quantity(was.hypothesis) == quantity(h)).map_or(value, |was| larger(was.largest, value))
}

/// Whether two hypotheses may be of one change: air flow and power look alike.
fn is_alike(one: usize, other: usize) -> bool {
    let [one, other] = [one, other].map(|h| HYPOTHESES[h % COUNT].class.quantity());
    let process = |quantity| matches!(quantity, Quantity::Power | Quantity::Flow);
    one == other || process(one) && process(other)
}

impl SinceTrainingState {
    pub(super) fn new(tuning: Tuned) -> Self {
        Self { steady: Steady::new(tuning), changed: None }
    }

    /// Another recording begins.
    pub(super) fn resume(&mut self) {
        self.steady.resume();
        self.changed = None;
    }

    /// The rig was changed on purpose: what it is from now on counts as trained.
    pub(super) fn rebase(&mut self) {
        self.steady.rebase();
        self.changed = None;
    }

    /// A step that is no fault: what was gathered is of the state before it. Residuals are `e` now, degC.
    pub(super) fn gather_anew(&mut self, e: [f32; 2]) {
        self.steady.forget(e);
    }

    /// All is as trained again, but for residuals `e`, degC.
    pub(super) fn forget(&mut self, e: [f32; 2]) {
        self.steady.forget(e);
        self.changed = None;
    }

    /// What was said of a change is taken back.
    pub(super) fn quieten(&mut self) {
        self.changed = None;
    }

    /// Whether anything has changed, and what that is called.
    pub(super) fn said(&self) -> Option<Option<Finding>> {
        self.changed.map(|change| change.finding)
    }

    /// The likeliest hypothesis of what has changed.
    pub(super) fn hypothesis(&self) -> Option<usize> {
        self.changed.as_ref().map(|change| change.hypothesis)
    }

    /// Finite as long as all of it is that stays.
    pub(super) fn sum(&self) -> f32 {
        self.steady.sum()
    }
}

#[cfg(test)]
impl SinceTrainingState {
    /// A place of the memory that a bit may flip in.
    pub(super) fn places(&mut self) -> [&mut f32; 1] {
        self.steady.places()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn bank(tuning: Tuned) -> SinceTraining {
        SinceTraining { least_power: 0.085, sample_time: 0.11, inputs: Inputs::ALL, tuning }
    }

    fn first_of(class: FaultClass) -> usize {
        HYPOTHESES.iter().position(|row| row.class == class).unwrap()
    }

    /// The heater gives 9 % less, and for a moment a T0 that reads wrong is likelier, by its odds and not by evidence of its own: the change of the power
    /// is still there. Where it is no change any more, neither is.
    #[test]
    fn a_change_lasts_where_another_has_become_likelier() {
        let bank = bank(Tuned::default());
        let (power, t0) = (first_of(FaultClass::HeaterPower), first_of(FaultClass::T0Fault));
        let mut estimate = [Estimate { gain: IMPOSSIBLE, ..Estimate::default() }; COUNT];
        estimate[power] = Estimate { gain: 1.37, value: -0.091, ..Estimate::default() };
        estimate[t0] = Estimate { gain: 0.67, value: 0.89, ..Estimate::default() };
        assert_eq!(bank.is_now(Some(power), &estimate, t0, &Usual::calm()), Some(power));
        assert_eq!(bank.is_now(None, &estimate, t0, &Usual::calm()), None);
        estimate[t0].gain = 1.2;
        assert_eq!(bank.is_now(Some(power), &estimate, t0, &Usual::calm()), Some(t0));
        estimate = [Estimate::default(); COUNT];
        assert_eq!(bank.is_now(Some(power), &estimate, t0, &Usual::calm()), None);
    }

    /// A heater that has lost 11 % in half a day. T0 might read 0.4 degC too high and T1 0.1 degC too low, which would be no faults, and nothing speaks for
    /// them; without them the change has its name, as surely as there is one. A T0 that something speaks for is a rival, however small its error is.
    #[test]
    fn what_nothing_speaks_for_is_no_rival() {
        let bank = bank(Tuned::default());
        let of = |t0_gain: f32| {
            let mut estimate = [Estimate { gain: IMPOSSIBLE, ..Estimate::default() }; COUNT];
            for (class, gain, value) in [
                (FaultClass::HeaterPower, 1.7, -0.11),
                (FaultClass::T0Fault, t0_gain, 0.4),
                (FaultClass::T1Offset, -1.9, -0.1),
                (FaultClass::T2Offset, -2.0, -0.1),
            ] {
                estimate[first_of(class)] = Estimate { gain, value, ..Estimate::default() };
            }
            bank.without_idle(&mut estimate, &Usual::calm());
            bank.named(&Posterior::new(&estimate), None).unwrap()
        };
        let (class, confidence) = of(-0.6);
        // The class has two hypotheses, one of them impossible: e^1.7 / 2 to one that nothing is wrong.
        let odds = libm::expf(1.7) / 2.0;
        assert_eq!(class, FaultClass::HeaterPower);
        assert!((confidence - 0.98 * odds / (1.0 + odds)).abs() < 1e-4, "{confidence}");
        assert!(of(0.6).1 < confidence - 0.05);
    }

    /// Heater power with 0.9 among the faults is told apart from the air flow once it was: a name does not come and go. What no class has more than half of
    /// has no name.
    #[test]
    fn what_was_told_apart_stays_so_and_the_likelier_half_has_the_name() {
        let bank = bank(Tuned::default());
        let posterior = |gains: &[(FaultClass, f32)]| {
            let mut estimate = [Estimate { gain: IMPOSSIBLE, ..Estimate::default() }; COUNT];
            for &(class, gain) in gains {
                estimate[first_of(class)] = Estimate { gain, value: 1.0, ..Estimate::default() };
            }
            Posterior::new(&estimate)
        };
        let [power, flow, t0, t1] =
            [FaultClass::HeaterPower, FaultClass::AirFlow, FaultClass::T0Fault, FaultClass::T1Offset];
        let both = posterior(&[(power, 7.0), (flow, 4.8)]);
        let name = |posterior: &Posterior, was| bank.named(posterior, was).map(|(class, _)| class);
        assert_eq!(name(&both, None), Some(FaultClass::AirFlowOrHeaterPower));
        assert_eq!(name(&both, Some(power)), Some(power));
        assert_eq!(name(&posterior(&[(t0, 5.0), (t1, 5.0), (power, 5.0)]), None), None);
    }

    /// What was 0.94 degC of T0 is 9 % of the power now: nothing of 94 % has passed when that has.
    #[test]
    fn the_largest_value_is_of_one_unit() {
        let (power, t0) = (first_of(FaultClass::HeaterPower), first_of(FaultClass::T0Fault));
        let was = |hypothesis, largest| Some(Change { onset: 0, hypothesis, finding: None, largest });
        assert_eq!(largest(was(t0, 0.94), power, 0.09), 0.09);
        assert_eq!(largest(was(power, 0.12), power, 0.09), 0.12);
    }

    /// T1 may be clogged by 3 %, which is no fault, and T0 may read wrong, which nothing speaks for: nothing has changed.
    #[test]
    fn a_change_that_is_too_small_is_no_evidence_of_another() {
        let bank = bank(Tuned::default());
        let (clogged, t0) = (first_of(FaultClass::T1Clogged), first_of(FaultClass::T0Fault));
        let mut estimate = [Estimate { gain: IMPOSSIBLE, ..Estimate::default() }; COUNT];
        estimate[clogged] = Estimate { gain: 1.3, value: -0.03, ..Estimate::default() };
        estimate[t0] = Estimate { gain: 0.3, value: 1.8, ..Estimate::default() };
        let likeliest = Posterior::new(&estimate).likeliest;
        assert_eq!(likeliest, t0, "a class has one odds for all of its hypotheses");
        assert!(!bank.is_there(&estimate, likeliest, 0.8, false));
        estimate[t0].gain = 1.2;
        assert!(bank.is_there(&estimate, likeliest, 0.8, false));
    }
}
