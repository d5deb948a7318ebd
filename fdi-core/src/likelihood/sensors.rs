//! Sensors that the plausibility checks have given up: named at once, no model needed.

use super::class::{Channel, FaultClass};
use super::verdict::Finding;
use crate::sense::{Sample, Validity};

/// So many ticks in a row without a usable sample, and the sensor counts as lost; fewer are noise on the line.
const LOST: u32 = 8;
/// An open or shorted wire is believed on its second sample.
const BROKEN: u32 = 2;

/// For how long each channel has given nothing usable.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sensors {
    bad: [u32; 3],
}

impl Sensors {
    /// The first sensor that is broken, T1 first: it is in the loop.
    pub(super) fn step(&mut self, sample: &Sample, tick: u32) -> Option<Finding> {
        let channels = [(Channel::T1, sample.t1), (Channel::T2, sample.t2), (Channel::T0, sample.t0)];
        let mut found = None;
        for (bad, (channel, reading)) in self.bad.iter_mut().zip(channels) {
            *bad = if reading.validity == Validity::Good { 0 } else { bad.saturating_add(1) };
            let class = match reading.validity {
                Validity::Open if *bad >= BROKEN => FaultClass::Open(channel),
                Validity::Short if *bad >= BROKEN => FaultClass::Short(channel),
                Validity::Stuck => FaultClass::Stuck(channel),
                _ if *bad >= LOST => FaultClass::Lost(channel),
                _ => continue,
            };
            let onset = tick.saturating_sub(*bad - 1);
            found = found.or(Some(Finding { class, confidence: 1.0, magnitude: None, onset }));
        }
        found
    }
}
