//! The model of the rig: power -> rises of T1 and T2, from physics with thirteen unknown parameters.
//!
//! ```text
//! x'  = (f^-0.8 u (1 + q (u - u0) / 20) - x) f^0.8 / tau             air at the heater, per degC/% of gain
//! air = x f^0.8 / f,  delayed by d1 (1/4 + 3/4 1/f)                  f: air flow, 1 as learnt
//! y1  = c1 + K ((1 - s1) m1 + s1 w1),   m1 = lag(air, t1),  w1 = lag(m1, tw)
//! y2  = c2 + K r ((1 - s) m2 + s w2),   m2 = lag(air delayed by d2 / f more, t2),  w2 = lag(m2, tw)
//! r   = 1 - (1 - r2) / f,  s = s1 + s2
//! ```
//!
//! The wall is the slow share s with the time constant tw. Times are in ticks, so that nothing here depends on the sample time.
//! Sources: docs/diagnosis.md, section 1; the flow's exponents are those of forced convection (docs/theory.md, section 1).

use super::tuning::Tuned;
use crate::bounds::{bounded, larger};

/// How many parameters the model has.
pub(super) const COUNT: usize = 13;

/// A parameter of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// ln of the static gain K, degC per %.
    Gain,
    /// ln of the heater's time constant tau, ticks.
    Heater,
    /// Dead time d1 from the heater to T1, ticks.
    Delay1,
    /// ln of T1's lag t1, ticks.
    Lag1,
    /// Share s1 of T1's rise that comes with the wall.
    Wall1,
    /// Share r2 of T1's rise that reaches T2.
    Reaches2,
    /// Transport d2 from T1 to T2, ticks.
    Delay2,
    /// ln of T2's lag t2, ticks.
    Lag2,
    /// Share s2 of T2's rise that comes with the wall on top of T1's.
    Wall2,
    /// ln of the wall's time constant tw, ticks.
    WallTime,
    /// What T1 reads above T0 without power, degC.
    Offset1,
    /// What T2 reads above T0 without power, degC.
    Offset2,
    /// How the gain grows with the power: share for each 20 %.
    Curvature,
}

/// All parameters, by [`Parameter`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parameters(pub [f32; COUNT]);

impl Parameters {
    /// How many there are.
    pub const COUNT: usize = COUNT;

    #[inline]
    pub(super) fn get(&self, which: Parameter) -> f32 {
        self.0[which as usize]
    }

    #[inline]
    pub(super) fn set(&mut self, which: Parameter, value: f32) {
        self.0[which as usize] = value;
    }

    /// Sum of what delays the answer of T2, ticks.
    pub(super) fn residence(&self) -> f32 {
        use Parameter::{Delay1, Delay2, Heater, Lag2};
        libm::expf(self.get(Heater)) + libm::expf(self.get(Lag2)) + self.get(Delay1) + self.get(Delay2)
    }
}

/// Ticks that the transport remembers.
pub(super) const MEMORY: usize = 64;
/// The longest delay that can be looked up, ticks.
pub(super) const LONGEST: f32 = (MEMORY - 2) as f32;

/// The share of the way that a lag of `ticks` goes in a tick, for an input that is held.
pub(super) fn share(ticks: f32) -> f32 {
    1.0 - libm::expf(-1.0 / larger(ticks, 0.01))
}

/// What the air carries: the last values, and delays in between by straight lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transport {
    values: [f32; MEMORY],
    newest: usize,
}

impl Default for Transport {
    fn default() -> Self {
        Self { values: [0.0; MEMORY], newest: 0 }
    }
}

impl Transport {
    #[inline]
    pub(super) fn push(&mut self, value: f32) {
        self.newest = (self.newest + 1) % MEMORY;
        self.values[self.newest % MEMORY] = value;
    }

    /// As it was so many ticks ago, as far as that is remembered.
    pub(super) fn back(&mut self, ticks: usize) {
        self.newest = (self.newest + MEMORY - ticks % MEMORY) % MEMORY;
    }

    /// The same with `share` of another on top.
    fn add(&mut self, other: &Self, share: f32) {
        for ago in 0..MEMORY {
            let theirs = other.values[(other.newest + MEMORY - ago) % MEMORY];
            self.values[(self.newest + MEMORY - ago) % MEMORY] += share * theirs;
        }
    }

    /// The value of a delay ago, and how much more a tick earlier gives.
    #[inline]
    pub(super) fn at(&self, delay: Delay) -> (f32, f32) {
        let place = self.newest + MEMORY - delay.whole;
        let later = self.values[place % MEMORY];
        let slope = self.values[(place + MEMORY - 1) % MEMORY] - later;
        (later + delay.part * slope, slope)
    }
}

/// A dead time within what the transport remembers: whole ticks, at most [`LONGEST`], and a part of one more. It is split up when the
/// model changes, not on each tick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Delay {
    whole: usize,
    part: f32,
}

impl Delay {
    /// Of so many ticks, as far as that is remembered.
    pub(super) fn new(ticks: f32) -> Self {
        let ticks = bounded(ticks, 0.0, LONGEST);
        let whole = ticks as usize;
        Self { whole, part: ticks - whole as f32 }
    }
}

/// What moves: heater, air, lags and walls.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Motion {
    pub(super) x: f32,
    pub(super) m: [f32; 2],
    pub(super) w: [f32; 2],
    pub(super) air: Transport,
}

impl Motion {
    /// The same with `share` of another motion on top: the model is linear in what moves.
    pub(super) fn add(&mut self, other: &Self, share: f32) {
        self.x += share * other.x;
        for i in 0..2 {
            self.m[i] += share * other.m[i];
            self.w[i] += share * other.w[i];
        }
        self.air.add(&other.air, share);
    }

    /// Finite as long as all of it is; the air brings the rest of it to these.
    pub(super) fn sum(&self) -> f32 {
        self.x + self.m[0] + self.m[1] + self.w[0] + self.w[1]
    }

    /// Long after the power was last changed.
    pub(super) fn steady(power: f32) -> Self {
        let air = Transport { values: [power; MEMORY], newest: 0 };
        Self { x: power, m: [power; 2], w: [power; 2], air }
    }
}

/// What the model gives on a tick, degC.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rises {
    /// Rises without the offsets.
    pub(super) y: [f32; 2],
    /// How they would change if all came with the wall.
    pub(super) wall: [f32; 2],
}

/// The model at one air flow, its coefficients worked out.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Process {
    pub(super) heater: f32,
    /// Power to x, and x to the air.
    pub(super) into: f32,
    pub(super) out_of: f32,
    pub(super) delay: [Delay; 2],
    pub(super) lag: [f32; 2],
    pub(super) wall: f32,
    pub(super) gain: [f32; 2],
    pub(super) slow: [f32; 2],
    pub(super) curvature: f32,
    pub(super) tuning: Tuned,
}

impl Process {
    /// The model with `flow` times the air flow as learnt.
    pub(super) fn new(tuning: Tuned, p: &Parameters, flow: f32) -> Self {
        use Parameter::{Curvature, Gain, Lag1, Lag2, Wall1, Wall2, WallTime};
        let gain = libm::expf(p.get(Gain));
        let mut process = Self {
            lag: [share(libm::expf(p.get(Lag1))), share(libm::expf(p.get(Lag2)))],
            wall: share(libm::expf(p.get(WallTime))),
            gain: [gain; 2],
            slow: [p.get(Wall1), p.get(Wall1) + p.get(Wall2)],
            curvature: p.get(Curvature),
            tuning,
            ..Self::default()
        };
        process.blow(p, flow);
        process
    }

    /// Another air flow, all else as it is.
    pub(super) fn blow(&mut self, p: &Parameters, flow: f32) {
        use Parameter::{Delay1, Delay2, Heater, Reaches2};
        let model = &self.tuning.model;
        let film = if flow == 1.0 { 1.0 } else { libm::expf(model.film_exponent * libm::logf(flow)) };
        let inverse = 1.0 / flow;
        let first = p.get(Delay1) * (model.fixed_delay + (1.0 - model.fixed_delay) * inverse);
        self.heater = share(libm::expf(p.get(Heater)) / film);
        self.into = 1.0 / film;
        self.out_of = film * inverse;
        self.delay = [first, first + p.get(Delay2) * inverse].map(Delay::new);
        self.gain[1] = self.gain[0] * (1.0 - (1.0 - p.get(Reaches2)) * inverse);
    }

    /// The heat of a power, %.
    #[inline]
    pub(super) fn heat(&self, power: f32) -> f32 {
        power * (1.0 + self.curvature * (power - self.tuning.model.centre) / self.tuning.model.step)
    }

    /// One tick with `heat` from [`Self::heat`] applied since the last.
    #[inline(never)]
    pub(super) fn step(&self, s: &mut Motion, heat: f32) -> Rises {
        s.x += self.heater * (heat * self.into - s.x);
        s.air.push(s.x * self.out_of);
        for i in 0..2 {
            let (air, _) = s.air.at(self.delay[i]);
            s.m[i] += self.lag[i] * (air - s.m[i]);
            s.w[i] += self.wall * (s.m[i] - s.w[i]);
        }
        self.rises(s.m, s.w)
    }

    /// The rises where the lags and the walls are there.
    #[inline]
    pub(super) fn rises(&self, m: [f32; 2], w: [f32; 2]) -> Rises {
        let mut rises = Rises::default();
        for i in 0..2 {
            rises.wall[i] = self.gain[i] * (w[i] - m[i]);
            rises.y[i] = self.gain[i] * m[i] + self.slow[i] * rises.wall[i];
        }
        rises
    }
}

#[cfg(test)]
mod tests;
