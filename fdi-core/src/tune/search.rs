//! The quickest settings for a lag: a search that can be done in pieces, for a processor that has other things to do.

use super::lag::{Lag, Tuned};
use crate::units::Seconds;

/// What is asked for: a gain margin with room for what a lag leaves out of a rig, and hardly any overshoot.
const MARGIN: f32 = 3.0;
const OVERSHOOT: f32 = 0.08;
/// What is tried: factors on the gain and the integral time of [`Lag::by_model`], and derivative times as a share of the dead time.
const GAINS: [f32; 8] = [0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25];
const INTEGRALS: [f32; 10] = [0.2, 0.25, 0.32, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
const DERIVATIVES: [f32; 3] = [0.0, 0.2, 0.4];

/// Around the settings of [`Lag::by_model`], those by which a step of the set-point is settled soonest on this lag, by the PID as it
/// is, with a gain margin of 3 and an overshoot of 8 % at most. The PID takes a step by its integral part alone, which wants more of it than
/// the rule gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    lag: Lag,
    sample_time: Seconds,
    best: Tuned,
    ticks: u32,
    next: usize,
}

impl Lag {
    /// The best of a [`Search`].
    pub fn quickest(&self, sample_time: Seconds) -> Tuned {
        let mut search = Search::new(self, sample_time);
        while !search.step() {}
        search.best()
    }
}

impl Search {
    /// Begins with the settings of [`Lag::by_model`].
    pub fn new(lag: &Lag, sample_time: Seconds) -> Self {
        let best = lag.by_model();
        let ticks = lag.settling(&best, sample_time).map_or(u32::MAX, |(_, ticks)| ticks);
        Self { lag: *lag, sample_time, best, ticks, next: 0 }
    }

    /// What it is for.
    pub fn lag(&self) -> &Lag {
        &self.lag
    }

    /// The best so far.
    pub fn best(&self) -> Tuned {
        self.best
    }

    /// Tries one more; `true` where there is none left.
    pub fn step(&mut self) -> bool {
        let Some(tuned) = self.candidate() else { return true };
        self.next += 1;
        if let Some((overshoot, ticks)) = self.lag.settling(&tuned, self.sample_time)
            && ticks < self.ticks
            && overshoot <= OVERSHOOT
            && self.lag.margins(&tuned, self.sample_time).is_some_and(|margins| margins.gain >= MARGIN)
        {
            (self.best, self.ticks) = (tuned, ticks);
        }
        false
    }

    fn candidate(&self) -> Option<Tuned> {
        let (rest, derivative) = (self.next / DERIVATIVES.len(), self.next % DERIVATIVES.len());
        let gain = GAINS.get(rest / INTEGRALS.len())?;
        let start = self.lag.by_model();
        Some(Tuned {
            kp: gain * start.kp,
            ti: Seconds(INTEGRALS[rest % INTEGRALS.len()] * start.ti.0),
            td: Seconds(DERIVATIVES[derivative] * self.lag.dead),
        })
    }
}
