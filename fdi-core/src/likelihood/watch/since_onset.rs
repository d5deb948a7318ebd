//! The bank since an onset: what has happened since something began to stir, an alarm where a fault explains that, and the alarm's name and end.
//!
//! While nothing stirs, all begins anew on every tick.

mod naming;
mod recall;
mod recovered;

use super::charts::Charted;
use super::innovations::Innovations;
use super::simulation::Simulated;
use super::times::Times;
use crate::bounds::{bounded, larger, smaller};
use crate::likelihood::alarm::{Alarm, Held};
use crate::likelihood::class::{FaultClass, Quantity};
use crate::likelihood::evidence::{Estimate, Nuisances};
use crate::likelihood::hypothesis::{COUNT, HYPOTHESES, Hypothesis, IMPOSSIBLE, PAIRS, TAUGHT_PAIRS};
use crate::likelihood::inputs::Inputs;
use crate::likelihood::normal::Normal;
use crate::likelihood::onset::{Nominal, Onset};
use crate::likelihood::posterior::Posterior;
use crate::likelihood::process::Motion;
use crate::likelihood::recovery::Recovery;
use crate::likelihood::regressor::{COUNT as REGRESSORS, Direction, PROCESS, Regressor, Regressors, SENSORS};
use crate::likelihood::taught::{MAX_TAUGHT, Responses, Weighed, weigh};
use crate::likelihood::tuning::Tuned;
use crate::likelihood::usual::Usual;
use crate::likelihood::verdict::{Finding, TaughtFinding};
use crate::likelihood::whitening::WhiteningFilter;
use crate::vector::sum;
pub(super) use naming::{magnitude, named};

/// The bank.
#[derive(Clone, Debug)]
pub(super) struct SinceOnset {
    /// Probability from which on a fault is named.
    pub(super) naming: f32,
    /// The smallest change of the heater's power that is a fault, a share.
    pub(super) least_power: f32,
    pub(super) sample_time: f32,
    pub(super) inputs: Inputs,
    pub(super) taught: Responses,
    pub(super) tuning: Tuned,
}

/// What has been gathered since the assumed onset. It is needed only while the instrument watches.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::likelihood) struct SinceOnsetState {
    onset: Onset,
    /// Sums since the onset.
    since: Normal,
    recovery: Recovery,
    alarm: Option<Alarm>,
    /// Rises that were measured before the onset, degC.
    at_onset: [f32; 2],
    /// Means of the innovations, from which jumps are counted.
    z_mean: [f32; 2],
    /// For how long the charts have said something that is no alarm, s of the reference rig.
    candidate: f32,
    /// The whitened answer to the power since the onset, on the last tick.
    power_response: [f32; 2],
    /// What the alarm, as it was estimated before, leaves of this tick's squares; none of a tick without samples.
    left_by_alarm: Option<f32>,
}

/// What the bank sees of a tick.
pub(super) struct Seen<'a> {
    pub(super) tick: u32,
    pub(super) times: &'a Times,
    pub(super) simulated: &'a Simulated,
    pub(super) nominal: &'a Nominal<'a>,
    pub(super) filter: &'a WhiteningFilter,
    pub(super) innovations: &'a Innovations,
    pub(super) charted: &'a Charted,
    pub(super) usual: &'a Usual,
    /// Rises that were measured on the tick before, degC.
    pub(super) measured: [f32; 2],
}

/// What the hypotheses make of all since the onset.
struct Judged {
    estimate: [Estimate; COUNT],
    taught: Weighed,
    /// What the nuisances leave of the residual sum of squares.
    left: f32,
}

impl Judged {
    /// Before anything is asked.
    fn nothing() -> Self {
        let impossible = Estimate { gain: IMPOSSIBLE, ..Estimate::default() };
        Self { estimate: [impossible; COUNT], taught: [impossible; MAX_TAUGHT], left: 0.0 }
    }
}

/// What others have to know of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) enum Outcome {
    /// Nothing.
    Nothing,
    /// The nuisances explain all that the charts say, and have for long: power, air flow, offsets of T1 and T2.
    Usual([f32; 4]),
    /// The alarm is over.
    Over,
    /// A thermistor reads right again: residuals change by so much, degC.
    SensorRecovered([f32; 2]),
    /// The power, which was other by this share, is right again.
    PowerRecovered(f32),
}

impl SinceOnset {
    /// One tick.
    pub(super) fn step(&self, s: &mut SinceOnsetState, seen: &Seen) -> Outcome {
        self.gather(s, seen);
        if s.alarm.is_none() { self.decide(s, seen) } else { self.follow_alarm(s, seen) }
    }

    /// A tick without samples: the models since the onset go on.
    pub(super) fn pass(
        &self,
        s: &mut SinceOnsetState,
        times: &Times,
        filter: &WhiteningFilter,
        now: &Nominal,
    ) {
        s.left_by_alarm = None;
        if s.onset.age > 0 {
            s.onset.pass(&times.onset, filter, now);
        }
    }

    /// Gathers since the onset, or begins anew while nothing stirs.
    fn gather(&self, s: &mut SinceOnsetState, seen: &Seen) {
        let (t, charted, z) = (&self.tuning.alarm, seen.charted, seen.innovations.z);
        if s.alarm.is_none() && charted.fast_sum < t.near && charted.slow < t.near_slow {
            s.begin_anew();
            s.z_mean = [0.0; 2];
            return;
        }
        if s.onset.age == 0 {
            s.at_onset = seen.measured;
        }
        // The means before this tick, so that a jump counts in full.
        let lasting = larger(s.z_mean[0].abs(), s.z_mean[1].abs());
        let mut jump: f32 = 0.0;
        for m in 0..2 {
            s.z_mean[m] += t.mean_share * (z[m] - s.z_mean[m]);
            jump = larger(jump, (z[m] - s.z_mean[m]).abs());
        }
        let slope = if seen.times.slow_surroundings { 0.0 } else { t.transient_slope };
        let error = if self.inputs.fan { 0.0 } else { t.lasting_error };
        let transient = larger(error * lasting, 1.0 + slope * larger(0.0, jump - t.unusual));
        let weight = 1.0 / (transient * transient);
        // A jump while a sag or the like already stirs: what sensors do begins here, what the process does goes on.
        if s.alarm.is_none() && s.onset.age > 0 && self.jumps(s, z) {
            s.since.forget(&SENSORS);
            s.onset.restart_sensors(seen.simulated.before[0]);
            s.at_onset = seen.measured;
        }
        let [plain, row] = s.onset.step(&seen.times.onset, seen.filter, seen.nominal);
        s.power_response = row[Regressor::Power as usize];
        let mut keep = 1.0;
        if let Some(alarm) = &mut s.alarm {
            s.left_by_alarm = Some(alarm.follow(
                &self.tuning,
                seen.filter,
                z,
                [&plain, &row].map(|row| expected_by(alarm, row)),
            ));
            keep = if alarm.age > t.young { seen.times.forgets } else { 1.0 };
        }
        if s.onset.is_settling() {
            s.since = Normal::default();
        }
        s.since.add(keep, &row, z, weight);
    }

    /// Whether this tick's innovations are out of all proportion to those since the onset.
    fn jumps(&self, s: &SinceOnsetState, z: [f32; 2]) -> bool {
        let (t, ratio) = (&self.tuning.alarm, self.tuning.naming.strange);
        let most = self.tuning.since_training.clip * self.tuning.since_training.clip;
        let evidence = smaller(z[0] * z[0], most) + smaller(z[1] * z[1], most);
        if s.onset.age < t.outlasted as u32 {
            evidence > t.jump && evidence > ratio * s.since.energy
        } else {
            evidence > 2.0 * t.jump && evidence * s.onset.age as f32 > ratio * s.since.energy
        }
    }

    /// Raises the alarm where a fault explains more than the nuisances do.
    fn decide(&self, s: &mut SinceOnsetState, seen: &Seen) -> Outcome {
        if larger(seen.charted.fast, seen.charted.slow) <= 1.0 || s.onset.age == 0 {
            return Outcome::Nothing;
        }
        s.candidate += self.sample_time / seen.times.time_scale;
        let mut judged = Judged::nothing();
        self.judge(s, seen, &mut judged);
        let posterior = Posterior::new(&judged.estimate);
        let t = &self.tuning.alarm;
        let best = posterior.best % COUNT;
        let least = seen.usual.least_since_onset(HYPOTHESES[best].class, self.least_power);
        if posterior.best_gain > t.raise && judged.estimate[best].value.abs() >= least {
            let age = s.onset.age.saturating_sub(1);
            let mut alarm = Alarm::new(&self.tuning.naming, seen.tick.saturating_sub(age));
            self.name(s, &mut alarm, &mut judged);
            s.alarm = Some(alarm);
            // What stirred before and does not explain what is seen was something else, which went on until the process changed, too.
            let old = age as f32 * self.sample_time > t.before * seen.times.time_scale;
            if old && judged.left - 2.0 * t.kappa * posterior.best_gain > t.inexplicable * s.since.count {
                s.since.forget(&PROCESS);
                s.onset.process_again = Some(seen.times.onset.lead);
            }
        } else if s.candidate > self.tuning.times.forgetting {
            return self.take_for_usual(s, seen, best);
        }
        Outcome::Nothing
    }

    /// Whether the alarm has turned out to be a change of the power that is usual here. What was taken over raises no alarm again, so that what is
    /// learnt of the mains needs no hysteresis.
    fn is_usual(&self, alarm: &Alarm, usual: &Usual) -> bool {
        let class = HYPOTHESES[alarm.hypothesis % COUNT].class;
        let least =
            usual.least_since_onset(class, self.tuning.since_training.lasting_size * self.least_power);
        class.quantity() == Quantity::Power && alarm.values[0].abs() < least
    }

    /// What has moved is no fault: what the nuisances are, if one may move as far as the likeliest hypothesis lets it.
    fn take_for_usual(&self, s: &mut SinceOnsetState, seen: &Seen, likeliest: usize) -> Outcome {
        let nuisances = seen.usual.since_onset_with(HYPOTHESES[likeliest % COUNT].class.quantity());
        let [_, _, power, less, more, offset1, offset2, ..] =
            Nuisances::new(s.since.sums(), &nuisances, self.tuning.alarm.kappa).values();
        s.begin_anew();
        Outcome::Usual([power, less + more, offset1, offset2])
    }

    /// Names the fault while it lasts; clears the alarm when it has gone. A young alarm is ranked on every tick, an older one
    /// on every second.
    fn follow_alarm(&self, s: &mut SinceOnsetState, seen: &Seen) -> Outcome {
        let Some(mut alarm) = s.alarm else { return Outcome::Nothing };
        let t = &self.tuning.alarm;
        alarm.age += self.sample_time / seen.times.time_scale;
        alarm.turn = !alarm.turn;
        let young = alarm.age < t.young;
        if (young || alarm.turn) && !s.onset.is_settling() {
            let mut judged = Judged::nothing();
            self.judge(s, seen, &mut judged);
            self.name(s, &mut alarm, &mut judged);
            if HYPOTHESES[alarm.hypothesis % COUNT].first.direction == Direction::Of(Regressor::LessFlow) {
                s.onset.close(&self.tuning.hypotheses, alarm.values[0]);
            }
        }
        let over = alarm.is_over(t);
        s.alarm = Some(alarm);
        if let Some(recovered) = self.recovered(s, &alarm, seen) {
            return recovered;
        }
        if over {
            s.begin_anew();
            return Outcome::Over;
        }
        if !young && self.is_usual(&alarm, seen.usual) {
            return self.take_for_usual(s, seen, alarm.hypothesis);
        }
        Outcome::Nothing
    }

    /// Gains of all hypotheses since the onset, and of what was taught.
    #[inline(never)]
    fn judge(&self, s: &SinceOnsetState, seen: &Seen, judged: &mut Judged) {
        let nuisances = seen.usual.since_onset();
        let nuisances = Nuisances::new(s.since.sums(), &nuisances, self.tuning.alarm.kappa);
        judged.left = s.since.energy - nuisances.explained;
        let beyond = nuisances.beyond(if self.taught.is_empty() { &PAIRS } else { &TAUGHT_PAIRS });
        weigh(&self.tuning.taught, &self.taught, &beyond, &mut judged.taught);
        for (estimate, row) in judged.estimate.iter_mut().zip(self.tuning.hypotheses()) {
            if self.asks(seen.times, row) {
                *estimate = row.judged(beyond.estimate(row.first, row.second_at(s.at_onset)));
                // Timing tells air flow from power; without a fan there is nothing to tell apart.
                let may_be_late = !self.inputs.fan || estimate.value.abs() > self.tuning.hypotheses.large;
                if may_be_late && let Some(second) = row.later(estimate.value, seen.times.late) {
                    *estimate = row.judged(beyond.estimate(row.first, Some(second)));
                }
            }
        }
    }

    /// Whether a fault can be told here. What a controller holds looks stuck, or as if the heater gave always the same, where only slow answers
    /// would tell.
    fn asks(&self, times: &Times, row: &Hypothesis) -> bool {
        let stands = matches!(row.class, FaultClass::Stuck(_))
            || row.first.direction == Direction::Of(Regressor::Constant);
        self.inputs.tell(row.class) && !(times.slow_surroundings && stands)
    }
}

/// What the likeliest hypothesis of an alarm lets expect of the innovations.
fn expected_by(alarm: &Alarm, row: &Regressors) -> [f32; 2] {
    let hypothesis = &HYPOTHESES[alarm.hypothesis % COUNT];
    let frees = [Some(hypothesis.first.direction), hypothesis.second.map(|free| free.direction)];
    let mut expected = [0.0; 2];
    for (direction, value) in frees.into_iter().zip(alarm.values) {
        for (regressor, weight) in direction.into_iter().flat_map(Direction::moves) {
            for (expected, x) in expected.iter_mut().zip(row[regressor % REGRESSORS]) {
                *expected += weight * value * x;
            }
        }
    }
    expected
}

impl SinceOnsetState {
    /// Nothing has happened yet: the next tick that stirs is the first.
    pub(super) fn begin_anew(&mut self) {
        self.onset.age = 0;
        self.alarm = None;
        self.candidate = 0.0;
        if self.since.count > 0.0 {
            self.since = Normal::default();
        }
    }

    /// Whether there is an alarm, and what it is called.
    pub(super) fn said(&self) -> Option<Option<Finding>> {
        self.alarm.map(|alarm| alarm.finding)
    }

    /// What the alarm is held for; none without one.
    pub(in crate::likelihood) fn held(&self) -> Option<Held> {
        let Alarm { onset, finding: named, hypothesis, values: [value, _], .. } = self.alarm?;
        Some(Held { class: HYPOTHESES[hypothesis % COUNT].class, value, onset, named })
    }

    /// What the alarm leaves of this tick's squares, if the tick has samples; none without an alarm, or where what a user has taught explains it.
    pub(in crate::likelihood) fn left_by_alarm(&self) -> Option<Option<f32>> {
        self.alarm.filter(|alarm| alarm.taught.is_none()).map(|_| self.left_by_alarm)
    }

    /// The likeliest hypothesis of the alarm, and the value of what it frees first.
    pub(super) fn hypothesis(&self) -> Option<(usize, f32)> {
        self.alarm.as_ref().map(|alarm| (alarm.hypothesis, alarm.values[0]))
    }

    /// The fault of the user's own that the alarm is.
    pub(in crate::likelihood) fn taught(&self) -> Option<TaughtFinding> {
        self.alarm.as_ref()?.taught
    }

    /// Motions of a power that is other by the whole since the onset, and since it is thought to have been right again.
    pub(super) fn power_motions(&self) -> (&Motion, &Motion) {
        (&self.onset.power, &self.recovery.power)
    }

    /// Shares, 0 to 1, of the residuals since the onset that each hypothesis would take away all by itself, with its class; None without an alarm.
    pub(in crate::likelihood) fn explained(&self, tuning: Tuned) -> Option<[(FaultClass, f32); COUNT]> {
        self.alarm.as_ref()?;
        let kappa = tuning.alarm.kappa;
        let alone = Nuisances::new(self.since.sums(), &[], kappa).beyond(&PAIRS);
        let energy = larger(1.0, self.since.energy - self.since.count);
        Some(core::array::from_fn(|h| {
            let row = &tuning.hypotheses()[h];
            let estimate = row.judged(alone.estimate(row.first, row.second_at(self.at_onset)));
            (row.class, bounded(2.0 * kappa * (estimate.gain - row.prior) / energy, 0.0, 1.0))
        }))
    }

    /// Finite as long as all of it is.
    pub(in crate::likelihood) fn sum(&self) -> f32 {
        self.since.sum() + sum(&self.z_mean) + sum(&self.at_onset)
    }
}
