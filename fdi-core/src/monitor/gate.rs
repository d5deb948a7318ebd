//! The door of the monitor: a level that no rig can have counts as not known, and is counted.

use super::{Observed, QUANTITIES, Units};
use crate::sense::supply;
use crate::supervisor::FASTEST_FAN;
use core::ops::RangeInclusive;

/// No temperature is further from zero, degC as [`Units::celsius`] makes them: the steps of an `f32` beyond are a hundredth of a degree and
/// more, which is the noise that a diagnosis has to see. It is so wide because the zero of a unit that is no degC may be anywhere.
const TEMPERATURE: RangeInclusive<f32> = -1e5..=1e5;
/// A power that is measured is off by no more than the highest and the lowest supply that a heater has make of it, % of the full one.
const POWER: RangeInclusive<f32> = -44.0..=144.0;
/// A heater beside it may be ten times as strong.
const BESIDE: RangeInclusive<f32> = -440.0..=1440.0;
/// What the fan of the trainer can be announced to have, %.
const FAN: RangeInclusive<f32> = 0.0..=FASTEST_FAN;

/// What can be, in the order of [`super::OBSERVED`].
const PLAUSIBLE: [RangeInclusive<f32>; QUANTITIES] =
    [TEMPERATURE, TEMPERATURE, TEMPERATURE, POWER, BESIDE, FAN, supply::PLAUSIBLE];

/// What is remembered of the inputs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Gate {
    /// Samples so far that no rig can have given, in the order of [`super::OBSERVED`].
    pub(super) refused: [u32; QUANTITIES],
    /// The last levels of the fan and of the supply that were ones: nearer to the truth than the usual ones.
    last: [Option<f32>; 2],
}

impl Gate {
    /// A sample with what can be believed of it.
    pub(super) fn step(&mut self, observed: &Observed, units: Units) -> Observed {
        let Units { celsius, full_power } = units;
        let percent = 100.0 / full_power;
        let scale = [celsius, celsius, celsius, percent, percent, 1.0, 1.0];
        let mut believed = observed.quantities();
        for (((x, scale), plausible), refused) in
            believed.iter_mut().zip(scale).zip(&PLAUSIBLE).zip(&mut self.refused)
        {
            let known = x.filter(|x| !x.is_nan());
            *x = known.filter(|x| plausible.contains(&(x * scale)));
            *refused = refused.saturating_add(u32::from(known.is_some() && x.is_none()));
        }
        let [t0, t1, t2, power, beside, fan, supply] = believed;
        let [last_fan, last_supply] = self.last;
        let [fan, supply] = [fan.or(last_fan), supply.or(last_supply)];
        self.last = [fan, supply];
        Observed { t: [t0, t1, t2], power, beside, fan, supply, learn: observed.learn }
    }

    /// Another recording: what fan and supply were in the one before says nothing.
    pub(super) fn resume(&mut self) {
        self.last = [None; 2];
    }
}
