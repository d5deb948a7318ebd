//! Where the parameters mean something: lags in their order, a thermistor that is missing, bounds.

use super::super::beside;
use super::super::inputs::Inputs;
use super::super::process::{Motion, Parameter, Parameters};
use super::{INTERCEPT_SD, LONGEST_DELAY};
use crate::bounds::{bounded, larger};

/// Bounds of what must not run away: ln of the heater's time, dead times, what reaches T2, ln of the wall's time.
const HEATER: (f32, f32) = (-1.0, 7.0);
const REACHES: (f32, f32) = (0.05, 1.2);
/// And of the offsets, degC; of an intercept in its standard deviations.
const OFFSET: f32 = 20.0;
const OFFSET_SPAN: f32 = 10.0;
/// Bounds of the wall's time constant, in answer times.
const WALL_BOUNDS: (f32, f32) = (2.0, 60.0);
/// T1's own lag is no more than this share of it and the heater's, when learning begins.
const OWN_SHARE: f32 = 0.3;

/// For T1 its own lag and the heater's can be exchanged: the longer is taken for the heater's, which T2 has as well, and T2's so that its
/// whole delay stays.
pub(super) fn exchange_lags(p: &mut Parameters) {
    use Parameter::{Heater, Lag1, Lag2};
    let [heater, lag1, lag2] = [Heater, Lag1, Lag2].map(|which| libm::expf(p.get(which)));
    let both = heater + lag1;
    if lag1 > OWN_SHARE * both {
        let longer = larger(heater, lag1).max((1.0 - OWN_SHARE) * both);
        p.set(Heater, libm::logf(longer));
        p.set(Lag1, libm::logf(larger(0.1, both - longer)));
        p.set(Lag2, libm::logf(larger(0.2 * lag2, lag2 + heater - longer)));
    }
}

/// A T2 that is missing is T1's twin: what was learnt in its place is kept elsewhere.
pub(super) fn make_twin(p: &mut Parameters, motion: &mut Motion) {
    use Parameter::{Delay2, Lag1, Lag2, Offset1, Offset2, Reaches2, Wall2};
    for (which, value) in
        [(Reaches2, 1.0), (Delay2, 0.0), (Wall2, 0.0), (Lag2, p.get(Lag1)), (Offset2, p.get(Offset1))]
    {
        p.set(which, value);
    }
    motion.m[1] = motion.m[0];
    motion.w[1] = motion.w[0];
}

/// Holds the parameters where the model means something.
pub(super) fn bound(p: &mut Parameters, answer: f32, inputs: Inputs) {
    let mut within =
        |which: Parameter, (low, high): (f32, f32)| p.set(which, bounded(p.get(which), low, high));
    within(Parameter::Heater, HEATER);
    within(Parameter::Delay1, (0.0, LONGEST_DELAY));
    within(Parameter::Delay2, (0.0, LONGEST_DELAY));
    within(Parameter::Reaches2, if inputs.t2 { REACHES } else { beside::SHARES });
    let wall = |answers: f32| libm::logf(answers * answer);
    within(Parameter::WallTime, (wall(WALL_BOUNDS.0), wall(WALL_BOUNDS.1)));
    within(Parameter::Lag1, (-3.0, 6.0));
    within(Parameter::Lag2, (-3.0, 6.0));
    within(Parameter::Wall1, (-0.2, 0.6));
    within(Parameter::Wall2, (-0.2, 0.6));
    within(Parameter::Gain, (-6.0, 3.0));
    let offset = if inputs.t0 { OFFSET } else { OFFSET_SPAN * INTERCEPT_SD };
    within(Parameter::Offset1, (-offset, offset));
    within(Parameter::Offset2, (-offset, offset));
    within(Parameter::Curvature, (-0.2, 0.2));
}
