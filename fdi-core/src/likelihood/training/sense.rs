//! Where the parameters mean something: lags in their order, a thermistor that is missing, bounds.

use super::super::inputs::Inputs;
use super::super::process::{Motion, Parameter, Parameters};
use super::super::tuning::{RangeTuning, Tuned};
use super::longest_delay;
use crate::bounds::{bounded, larger};

/// For T1 its own lag and the heater's can be exchanged: the longer is taken for the heater's, which T2 has as well, and T2's so that its
/// whole delay stays.
pub(super) fn exchange_lags(t: &RangeTuning, p: &mut Parameters) {
    use Parameter::{Heater, Lag1, Lag2};
    let [heater, lag1, lag2] = [Heater, Lag1, Lag2].map(|which| libm::expf(p.get(which)));
    let both = heater + lag1;
    if lag1 > t.own_lag * both {
        let longer = larger(heater, lag1).max((1.0 - t.own_lag) * both);
        p.set(Heater, libm::logf(longer));
        p.set(Lag1, libm::logf(larger(t.least_own_lag, both - longer)));
        p.set(Lag2, libm::logf(larger(t.least_lag2 * lag2, lag2 + heater - longer)));
    }
}

/// A T2 that is missing is T1's twin: what was learnt in its place is kept elsewhere.
pub(in super::super) fn make_twin(p: &mut Parameters, motion: &mut Motion) {
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
pub(super) fn bound(tuning: &Tuned, p: &mut Parameters, answer: f32, inputs: Inputs) {
    let t = &tuning.range;
    let mut within =
        |which: Parameter, (low, high): (f32, f32)| p.set(which, bounded(p.get(which), low, high));
    within(Parameter::Heater, (t.least_heater, t.largest_heater));
    within(Parameter::Delay1, (0.0, longest_delay(tuning)));
    within(Parameter::Delay2, (0.0, longest_delay(tuning)));
    within(Parameter::Reaches2, (if inputs.t2 { t.least_reaches } else { 0.0 }, t.largest_reaches));
    let wall = |answers: f32| libm::logf(answers * answer);
    within(Parameter::WallTime, (wall(t.least_wall_time), wall(t.largest_wall_time)));
    within(Parameter::Lag1, (t.least_lag, t.largest_lag));
    within(Parameter::Lag2, (t.least_lag, t.largest_lag));
    within(Parameter::Wall1, (t.least_wall, t.largest_wall));
    within(Parameter::Wall2, (t.least_wall, t.largest_wall));
    within(Parameter::Gain, (t.least_gain, t.largest_gain));
    let offset = if inputs.t0 { t.offset } else { t.intercept * tuning.prior.intercept_sd };
    within(Parameter::Offset1, (-offset, offset));
    within(Parameter::Offset2, (-offset, offset));
    within(Parameter::Curvature, (-t.curvature, t.curvature));
}
