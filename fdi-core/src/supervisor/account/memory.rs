//! What the account keeps: the power, the warmth, the cold rig, and what was learnt.

use super::*;
use crate::bounds::bounded;

impl Account {
    pub(super) fn follow_power(&self, state: &mut AccountState, now: &Situation) {
        let power = now.drive.0 / now.known.fan_share();
        let [quick, ..] = state.power;
        // As the warmth is averaged, so is what it is held against; then the rig itself takes its time.
        let follows = [(self.quick, power), (self.slow, quick), (self.settled, power)];
        for (mean, (filter, power)) in state.power.iter_mut().zip(follows) {
            filter.follow(mean, power);
            // What a flipped bit has made of the mean is not averaged any further.
            if !(0.0..=2000.0).contains(mean) {
                *mean = power;
            }
        }
    }

    pub(super) fn follow_warmth(&self, state: &mut AccountState, sample: &Sample) {
        let cold = state.cold.unwrap_or_default();
        let begins = state.samples <= 1;
        let mut follow = |i: usize, reading: Option<f32>| {
            if let (Some(t), Some(_)) = (reading, state.cold) {
                let mean = &mut state.warmth[i];
                self.quick.follow(mean, t - cold);
                if begins || !(-200.0..=400.0).contains(mean) {
                    *mean = t - cold;
                }
            }
        };
        let t1 = sample.t1.good();
        follow(0, t1);
        // A T2 that is broken leaves it to T1; one that has no sample says nothing new.
        let broken = matches!(sample.t2.validity, Validity::Open | Validity::Short | Validity::OutOfRange);
        follow(1, if broken { t1 } else { sample.t2.good() });
    }

    /// The temperature of the cold rig.
    pub(super) fn follow_cold(&self, state: &mut AccountState, sample: &Sample, heating: bool) {
        let [t0, t1, t2] = [sample.t0, sample.t1, sample.t2].map(|reading| reading.good());
        state.readings = [t0, t1, t2];
        let middle = match (t0, t1, t2) {
            (Some(t0), Some(t1), Some(t2)) => median(&[t0, t1, t2]),
            (Some(a), Some(b), None) | (Some(a), None, Some(b)) | (None, Some(a), Some(b)) => smaller(a, b),
            _ => return,
        };
        let begins = state.samples < SAMPLES;
        if heating && !begins {
            self.follow_heated(state, t0, t1);
            return;
        }
        state.recent[state.samples % SAMPLES] = smaller(middle, HOTTEST_ROOM);
        state.samples = if state.samples < 2 * SAMPLES - 1 { state.samples + 1 } else { SAMPLES };
        let seen = median(&state.recent[..state.samples.min(SAMPLES)]);
        let cold = state.cold.filter(|_| !begins).unwrap_or(seen);
        // Down at once; up as a room may, and may have while it heated, and no further than to T0.
        let up = smaller(cold + state.room_rise, t0.unwrap_or(cold));
        let now = smaller(larger(cold, up), seen);
        state.room_rise = larger(self.room_step, state.room_rise - larger(0.0, now - cold));
        state.cold = Some(now);
    }

    /// While it heats the room is followed slowly, and only where T1 is as warm above T0 as the power makes it.
    fn follow_heated(&self, state: &mut AccountState, t0: Option<f32>, t1: Option<f32>) {
        state.room_rise += self.room_step;
        let (Some(cold), Some(learnt), Some(t0), Some(t1)) = (state.cold, state.learnt, t0, t1) else {
            return;
        };
        let (rise, expected) = (t1 - t0, learnt.gain * state.power[1]);
        if expected > 0.0 && rise <= CONSISTENT * expected && expected <= CONSISTENT * rise {
            state.cold = Some(bounded(t0, cold - self.heated_step, cold + self.heated_step));
        }
    }
}

/// The middle one of a few, of an even number the upper one.
fn median(all: &[f32]) -> f32 {
    let middle = all.len() / 2;
    let is_middle = |x: &&f32| {
        let below = all.iter().filter(|y| *y < *x).count();
        below <= middle && middle < all.iter().filter(|y| *y <= *x).count()
    };
    all.iter().find(is_middle).copied().unwrap_or_default()
}

impl AccountState {
    /// A flipped bit in each number by which power and warmth are held against each other.
    #[cfg(test)]
    pub(in crate::supervisor) fn damage(&mut self, nonsense: f32) {
        (self.power, self.warmth) = ([nonsense; 3], [nonsense; 2]);
        (self.owed, self.surplus, self.seen) = (nonsense, nonsense, (nonsense, nonsense));
    }

    /// What is owed, as a share of the limit.
    #[cfg(test)]
    pub(in crate::supervisor) fn owed_share(&self) -> f32 {
        self.owed / LIMIT
    }

    pub(super) fn is_unpowered(&self) -> bool {
        let [quick, slow, _] = self.power;
        larger(quick, slow) < NO_POWER
    }

    /// Whether the readings agree as those of a rig at rest do, or are still apart by heat that was asked for.
    pub(in crate::supervisor) fn is_consistent(&self) -> bool {
        let middle = match self.readings {
            [Some(t0), Some(t1), Some(t2)] => median(&[t0, t1, t2]),
            [Some(t), ..] | [None, Some(t), _] | [None, None, Some(t)] => t,
            [None, None, None] => return true,
        };
        // What was hot before it was ever asked to heat is no warmth that is left.
        let left = if self.power[2] > 0.0 { self.left } else { 0.0 };
        self.readings.iter().flatten().all(|t| (t - middle).abs() <= AT_REST + left)
    }

    /// Mean power up to now, %.
    pub(in crate::supervisor) fn mean_power(&self) -> f32 {
        self.power[1]
    }

    /// The power that the set-point needs by what was learnt, %.
    pub(in crate::supervisor) fn power_for(&self, setpoint: Celsius) -> Option<f32> {
        let gain = self.learnt?.gain;
        (gain > 0.0).then_some((setpoint.0 - self.cold?) / gain)
    }

    /// From a baseline of before the restart.
    pub(in crate::supervisor) fn restore(&mut self, baseline: &Baseline) {
        let mean = |residual: Residual| baseline.raw.mean[residual as usize];
        self.learnt = Some(Learnt {
            gain: mean(Residual::Rsg1),
            t2_gain: mean(Residual::Rsg2),
            t1_over_t2: mean(Residual::Ry12),
        });
    }

    pub(in crate::supervisor) fn forget(&mut self) {
        (self.learnt, self.seen) = (None, (0.0, 0.0));
    }

    /// Learning begins.
    pub(in crate::supervisor) fn begin(&mut self) {
        self.sums = Statistics::default();
    }

    /// Learns from a sample of normal operation.
    pub(in crate::supervisor) fn push(&mut self, now: &Situation) {
        self.sums.push(&[now.pid.0, now.sample.t1.celsius.0, now.sample.t2.celsius.0]);
    }

    /// Learning has ended well, if there was any.
    pub(in crate::supervisor) fn end(&mut self) {
        if self.sums.count() == 0 {
            return;
        }
        let [power, t1, t2] = self.sums.mean();
        let gain = |t: f32| self.cold.filter(|_| power > SHOWS).map_or(0.0, |cold| (t - cold) / power);
        self.learnt = Some(Learnt { gain: gain(t1), t2_gain: gain(t2), t1_over_t2: t1 - t2 });
        self.sums = Statistics::default();
    }
}
