//! The supply: a voltage that stands or goes from one value to another in a straight line.

use crate::time::{NEVER, Ps, US};

/// How often a ramp is looked at.
const STEP: Ps = 10 * US;

/// The supply.
#[derive(Clone, Copy, Debug)]
pub struct Supply {
    from: f64,
    to: f64,
    begin: Ps,
    end: Ps,
}

impl Supply {
    /// A voltage that stands.
    pub fn steady(volts: f64) -> Self {
        Self { from: volts, to: volts, begin: 0, end: 0 }
    }

    /// Goes to a voltage within a time.
    pub fn ramp(&mut self, volts: f64, time: Ps, now: Ps) {
        *self = Self { from: self.volts(now), to: volts, begin: now, end: now + time };
    }

    /// The voltage.
    pub fn volts(&self, now: Ps) -> f64 {
        if now >= self.end {
            return self.to;
        }
        let share = (now.saturating_sub(self.begin)) as f64 / (self.end - self.begin) as f64;
        self.from + (self.to - self.from) * share
    }

    /// When it has to be looked at next.
    pub fn next_event(&self, now: Ps) -> Ps {
        if now >= self.end { NEVER } else { (now + STEP).min(self.end) }
    }
}
