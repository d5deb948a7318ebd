//! Sensors that the plausibility checks have given up: named at once, no model needed.

use super::class::{Channel, FaultClass};
use super::tuning::Tuned;
use super::verdict::Finding;
use crate::sense::{Sample, Validity};

/// For how long each channel has given nothing usable.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sensors {
    bad: [u32; 3],
}

impl Sensors {
    /// The first sensor that is broken, T1 first: it is in the loop.
    pub(super) fn step(&mut self, tuning: Tuned, sample: &Sample, tick: u32) -> Option<Finding> {
        let channels = [(Channel::T1, sample.t1), (Channel::T2, sample.t2), (Channel::T0, sample.t0)];
        let (lost, broken) = (tuning.sensors.lost as u32, tuning.sensors.broken as u32);
        let mut found = None;
        for (bad, (channel, reading)) in self.bad.iter_mut().zip(channels) {
            *bad = if reading.validity == Validity::Good { 0 } else { bad.saturating_add(1) };
            let class = match reading.validity {
                Validity::Open if *bad >= broken => FaultClass::Open(channel),
                Validity::Short if *bad >= broken => FaultClass::Short(channel),
                Validity::Stuck => FaultClass::Stuck(channel),
                _ if *bad >= lost => FaultClass::Lost(channel),
                _ => continue,
            };
            let onset = tick.saturating_sub(*bad - 1);
            found = found.or(Some(Finding { class, confidence: 1.0, magnitude: None, onset }));
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sense::Reading;
    use crate::units::Celsius;

    /// On which tick T1, and then T2, that reads so from tick 0 on is named, and as what.
    fn named(validity: Validity) -> [Option<(u32, FaultClass)>; 2] {
        let reading = |validity| Reading { celsius: Celsius(30.0), validity };
        [true, false].map(|t1| {
            let mut sensors = Sensors::default();
            let good = reading(Validity::Good);
            let sample = if t1 {
                Sample { t0: good, t1: reading(validity), t2: good }
            } else {
                Sample { t0: good, t1: good, t2: reading(validity) }
            };
            (0..20).find_map(|tick| Some((tick, sensors.step(Tuned::default(), &sample, tick)?.class)))
        })
    }

    #[test]
    fn a_thermistor_is_named_by_what_it_gives() {
        use Channel::{T1, T2};
        assert_eq!(named(Validity::Good), [None; 2]);
        assert_eq!(named(Validity::Open), [T1, T2].map(|c| Some((1, FaultClass::Open(c)))));
        assert_eq!(named(Validity::Short), [T1, T2].map(|c| Some((1, FaultClass::Short(c)))));
        assert_eq!(named(Validity::Missing), [T1, T2].map(|c| Some((7, FaultClass::Lost(c)))));
        assert_eq!(named(Validity::Stuck), [T1, T2].map(|c| Some((0, FaultClass::Stuck(c)))));
    }
}
