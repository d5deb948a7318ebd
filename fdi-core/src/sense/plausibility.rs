//! Can this reading be true? Range, wire, jump and stuck checks of one channel, made before control and diagnosis see it.
//!
//! A single spike is dropped without delaying the loop: a sample that jumps is withheld, and the next one is taken
//! whatever it says. A spike is gone by then; a true step costs one tick. What keeps jumping fails the rate check.

use super::thermistor::Thermistor;
use super::{Reading, Validity};
use crate::error::{ConfigError, above};
use crate::settings::{check, settings};
use crate::units::{AdcCode, Celsius, Seconds};

settings! {
    /// Plausibility: what a thermistor can truly read. What fails is held out of control and diagnosis; T1 failing also trips.
    pub struct PlausibilityConfig: Plausibility "plausibility." {
        /// A code at or above this is an open thermistor or wire.
        open_code: AdcCode = 4055.0, 3000.0..=4094.0, limit above;
        /// A code at or below this is a shorted thermistor or wire.
        short_code: AdcCode = 40.0, 1.0..=1000.0, limit below;
        /// Lowest temperature that the rig can have.
        min: Celsius = -20.0, -50.0..=50.0, limit below;
        /// Highest temperature that the rig can have.
        max: Celsius = 110.0, -50.0..=350.0, limit above;
        /// A change in one tick that is larger than this, and that the trend does not predict, is a jump. It is withheld for one tick.
        jump: Celsius = 4.0, 0.1..=200.0, limit above;
        /// T1 or T2 is stuck if it does not change for this time while the heater is excited.
        stuck_time: Seconds = 3.0, 0.5..=600.0, limit above within 8 answers;
        /// The same for T0, which may well be quiet in a calm room.
        ambient_stuck_time: Seconds = 600.0, 0.5..=86400.0, was "plausibility.room_stuck_time", limit above;
        /// Codes this close count as no change.
        stuck_band: AdcCode = 0.25, 0.0..=10.0, limit below;
    }
}

impl PlausibilityConfig {
    /// Checks every limit.
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        check(Self::SETTINGS[0], self)?;
        above("plausibility.max", self.max.0, "plausibility.min", self.min.0)
    }
}

/// So many jumps within the last 10 samples, a bit each, fail the rate check.
const RATE_JUMPS: u32 = 3;
const RATE_WINDOW: u16 = 0x3FF;

/// One validated channel: conversion and limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plausibility {
    thermistor: Thermistor,
    limits: PlausibilityConfig,
    stuck_ticks: u32,
}

/// The memory of a [`Plausibility`].
#[derive(Clone, Copy, Debug, Default)]
pub struct PlausibilityState {
    /// Last temperature taken as true, and its change in a tick.
    last: Option<Celsius>,
    slope: f32,
    /// One bit a sample, newest lowest: 1 where it jumped and the next sample did not confirm it.
    jumps: u16,
    withheld: bool,
    /// Its change against the last one that was taken, degC.
    withheld_change: f32,
    /// Code from which a stuck sensor has not moved, and for how many ticks.
    still_code: f32,
    still_ticks: u32,
}

impl Plausibility {
    pub(crate) fn new(thermistor: Thermistor, limits: &PlausibilityConfig, stuck_ticks: u32) -> Self {
        Self { thermistor, limits: *limits, stuck_ticks }
    }

    /// Whether a code means another temperature to `new`.
    pub(super) fn is_recalibrated_by(&self, new: &Self) -> bool {
        self.thermistor != new.thermistor
    }

    /// Converts and judges one code. Total: any bit pattern gives a finite temperature and a validity.
    pub fn step(&self, state: &mut PlausibilityState, code: AdcCode, excited: bool) -> Reading {
        let limits = &self.limits;
        if code > limits.short_code && code < limits.open_code {
            let celsius = self.thermistor.celsius(code);
            if celsius >= limits.min && celsius <= limits.max {
                return Reading { celsius, validity: self.motion(state, code, celsius, excited) };
            }
        }
        self.broken(state, code)
    }

    /// What is wrong with a sample that is wrong by itself; whatever was known of the motion before is forgotten.
    #[cold]
    fn broken(&self, state: &mut PlausibilityState, code: AdcCode) -> Reading {
        *state = PlausibilityState { last: state.last, ..PlausibilityState::default() };
        if !(code.0 >= 0.0 && code.0 <= AdcCode::FULL_SCALE) {
            return Reading { celsius: state.last.unwrap_or_default(), validity: Validity::Missing };
        }
        let validity = if code >= self.limits.open_code {
            Validity::Open
        } else if code <= self.limits.short_code {
            Validity::Short
        } else {
            Validity::OutOfRange
        };
        // Bounded to what a display can use.
        let within = AdcCode(code.0.clamp(1.0, AdcCode::FULL_SCALE - 1.0));
        let celsius = Celsius(self.thermistor.celsius(within).0.clamp(-100.0, 400.0));
        Reading { celsius, validity }
    }

    /// Checks against the samples before.
    fn motion(
        &self,
        state: &mut PlausibilityState,
        code: AdcCode,
        celsius: Celsius,
        excited: bool,
    ) -> Validity {
        let stuck = self.is_stuck(state, code, excited);
        let change = state.last.map_or(0.0, |last| celsius.0 - last.0);
        let limit = self.limits.jump.0;
        let jumped = change.abs() > limit && (change - state.slope).abs() > limit;
        state.jumps = RATE_WINDOW & state.jumps << 1 | u16::from(jumped);
        let validity = if state.jumps == 0 { Validity::Good } else { state.doubt(jumped, change) };
        if validity != Validity::Spike {
            state.slope = if jumped { 0.0 } else { change };
            state.last = Some(celsius);
        }
        if stuck && validity == Validity::Good { Validity::Stuck } else { validity }
    }

    fn is_stuck(&self, state: &mut PlausibilityState, code: AdcCode, excited: bool) -> bool {
        let moved = (code.0 - state.still_code).abs() > self.limits.stuck_band.0;
        if moved || !excited {
            state.still_code = code.0;
            state.still_ticks = 0;
        } else {
            state.still_ticks = state.still_ticks.saturating_add(1);
        }
        state.still_ticks >= self.stuck_ticks
    }
}

impl PlausibilityState {
    /// What a sample is worth on which, or shortly before which, the reading jumped.
    #[cold]
    fn doubt(&mut self, jumped: bool, change: f32) -> Validity {
        if jumped && self.withheld && change * self.withheld_change > 0.0 {
            // A jump that the next sample confirms is fast air, such as at a cold start of a strong heater.
            self.jumps &= !0b11;
        }
        self.withheld = jumped && !self.withheld;
        self.withheld_change = change;
        if self.withheld {
            Validity::Spike
        } else if self.jumps.count_ones() >= RATE_JUMPS {
            Validity::Rate
        } else {
            Validity::Good
        }
    }
}
