//! A second heater beside T1's own, whose power is known: what it adds to T1's rise.
//!
//! ```text
//! x' = (v - x) / tau,   m = lag(x, tb),   added = K b m          v: its power, %; tau, K: those of T1's own heater
//! ```
//!
//! b and tb are learnt with all else. It is for rigs without T2, whose parameters for T2's share and lag stand for them.

use super::process::{Parameter, Parameters, share};

/// The heater, and what of it has arrived.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SecondHeater {
    heater: f32,
    lag: f32,
    gain: f32,
    x: f32,
    m: f32,
    power: f32,
}

impl SecondHeater {
    /// Long after its power was last changed.
    pub(super) fn steady(p: &Parameters, power: f32) -> Self {
        let mut beside = Self { x: power, m: power, power, ..Self::default() };
        beside.follow(p);
        beside
    }

    /// The same heater, long after its power was last changed.
    pub(super) fn resumed(self, power: f32) -> Self {
        Self { x: power, m: power, power, ..self }
    }

    /// The same heater without power, from this heat and this lag.
    pub(super) fn free(self, x: f32, m: f32) -> Self {
        Self { x, m, power: 0.0, ..self }
    }

    /// With `share` of what has arrived of another on top.
    pub(super) fn add(&mut self, other: &Self, share: f32) {
        self.x += share * other.x;
        self.m += share * other.m;
    }

    /// Takes over what is learnt.
    pub(super) fn follow(&mut self, p: &Parameters) {
        self.heater = share(libm::expf(p.get(Parameter::Heater)));
        self.lag = share(libm::expf(p.get(Parameter::Lag2)));
        self.gain = libm::expf(p.get(Parameter::Gain)) * p.get(Parameter::Reaches2);
    }

    /// One tick, with `power` in % from now on; gives what it adds to T1's rise, degC.
    pub(super) fn step(&mut self, power: f32) -> f32 {
        self.x += self.heater * (self.power - self.x);
        self.m += self.lag * (self.x - self.m);
        self.power = power;
        self.added()
    }

    /// Its static gain, degC per %, and its own time constant, ticks.
    pub(super) fn learnt(&self) -> (f32, f32) {
        (self.gain, -1.0 / libm::log1pf(-self.lag))
    }

    /// What it adds to T1's rise now, degC.
    pub(super) fn added(&self) -> f32 {
        self.gain * self.m
    }
}

/// How what it adds changes with the parameters, while they are learnt.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SecondHeaterTangent {
    by_lag: f32,
}

impl SecondHeaterTangent {
    /// One tick of `beside`; gives what it adds and its derivatives by the gain, its share and its lag.
    pub(super) fn step(&mut self, beside: &mut SecondHeater, p: &Parameters, power: f32) -> (f32, [f32; 3]) {
        let before = beside.m;
        let added = beside.step(power);
        let inverse = libm::expf(-p.get(Parameter::Lag2));
        let slope = -inverse * libm::expf(-inverse);
        self.by_lag += slope * (beside.x - before) - beside.lag * self.by_lag;
        let by_share = libm::expf(p.get(Parameter::Gain)) * beside.m;
        (added, [added, by_share, beside.gain * self.by_lag])
    }
}
