//! Where the parameters mean something: a thermistor that is missing, bounds.

use super::super::process::{COUNT, Motion, Parameter, Parameters};
use super::{Trainer, longest_delay};
use crate::bounds::bounded;

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
pub(super) fn bound(trainer: &Trainer, p: &mut Parameters) {
    for (value, (low, high)) in p.0.iter_mut().zip(trainer.ranges()) {
        *value = bounded(*value, low, high);
    }
}

impl Trainer {
    /// Within which each parameter stays, in the order of [`Parameter`].
    pub(in super::super) fn ranges(&self) -> [(f32, f32); COUNT] {
        let t = &self.tuning.range;
        let mut ranges = self.prior.map(|(mean, sd)| (mean - t.sds * sd, mean + t.sds * sd));
        ranges[Parameter::Reaches2 as usize].0 = if self.inputs.t2 { t.least_reaches } else { 0.0 };
        for delay in [Parameter::Delay1, Parameter::Delay2] {
            ranges[delay as usize] = (0.0, longest_delay(&self.tuning));
        }
        ranges[Parameter::WallTime as usize] = self.wall_time;
        ranges
    }
}
