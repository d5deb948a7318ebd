//! What the thermistors say while nothing is heated: alive, quiet, at one temperature?

use fdi_core::Validity;
use fdi_core::likelihood::Channel;
use heapless::Vec;

use super::finding::CheckFinding;
use super::{CHANNELS, MAX_FINDINGS};

/// Change of a mean from one cycle to the next, in degC, above which the rig is not at rest: several times what turbulence
/// does to it, and small against what the pulse gives.
const CALM: f32 = 0.5;
/// A thermistor further than this from the middle one, in degC, is no matter of calibration.
const FAR: f32 = 3.0;
/// While they are that far apart, T1 or T2 falling by as much in a cycle, in degC, is a rig that cools.
const COOLING: f32 = 0.1;
/// Difference in degC that is worth an offset: several times the noise of a mean.
const OFFSET: f32 = 0.3;
/// Movement in degC without heat that is no turbulence.
const NOISY: f32 = 3.0;

/// One thermistor at rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resting {
    /// Mean of the last cycle in degC.
    pub mean: f32,
    /// Its change from the cycle before.
    pub change: f32,
    /// Ticks on which there was nothing to believe, and why on the last of them.
    pub doubts: u32,
    pub doubt: Validity,
    /// Extremes of the last cycle in degC.
    pub low: f32,
    pub high: f32,
}

impl Resting {
    pub(super) const UNKNOWN: Self = Self {
        mean: 0.0,
        change: f32::INFINITY,
        doubts: 0,
        doubt: Validity::Good,
        low: f32::INFINITY,
        high: f32::NEG_INFINITY,
    };

    pub(super) fn see(&mut self, celsius: f32, validity: Validity) {
        if validity == Validity::Good {
            self.low = self.low.min(celsius);
            self.high = self.high.max(celsius);
        } else {
            self.doubts += 1;
            self.doubt = validity;
        }
    }

    /// Ends a cycle with this mean.
    pub(super) fn end_cycle(&mut self, mean: f32) {
        self.change = mean - self.mean;
        self.mean = mean;
    }

    /// Begins another cycle.
    pub(super) fn begin_cycle(&mut self) {
        *self = Self { mean: self.mean, ..Self::UNKNOWN };
    }
}

/// How far each is from the middle one.
fn spread(now: &[Resting; 3]) -> [f32; 3] {
    let [a, b, c] = now.map(|resting| resting.mean);
    let middle = a.max(b).min(a.min(b).max(c));
    now.map(|resting| resting.mean - middle)
}

/// Whether time may bring the rig to rest.
pub(super) fn is_worth_waiting(now: &[Resting; 3]) -> bool {
    let far = spread(now).iter().any(|by| by.abs() > FAR);
    let cooling = now.iter().skip(1).any(|resting| resting.change < -COOLING);
    now.iter().any(|resting| resting.change.abs() > CALM) || (far && cooling)
}

/// Wires that are broken, shorted or loose: no time helps, and without them nothing can be judged.
pub(super) fn broken(now: &[Resting; 3], allowed: u32, found: &mut Vec<CheckFinding, MAX_FINDINGS>) -> bool {
    let mut any = false;
    for (channel, resting) in CHANNELS.into_iter().zip(now).filter(|(_, resting)| resting.doubts > allowed) {
        any = true;
        let _ = found.push(CheckFinding::Broken(channel, resting.doubt));
    }
    any
}

/// All else that rest tells.
pub(super) fn judge(now: &[Resting; 3], found: &mut Vec<CheckFinding, MAX_FINDINGS>) {
    let each = |channel: Channel, resting: &Resting, by: f32| {
        let moves = resting.high - resting.low;
        if moves > NOISY {
            Some(CheckFinding::Noisy(channel, moves))
        } else if resting.change.abs() > CALM {
            Some(CheckFinding::NotAtRest(channel, resting.change))
        } else if by.abs() > FAR {
            Some(CheckFinding::FarOff(channel, by))
        } else if by.abs() > OFFSET {
            Some(CheckFinding::Offset(channel, by))
        } else {
            None
        }
    };
    for ((channel, resting), by) in CHANNELS.into_iter().zip(now).zip(spread(now)) {
        if let Some(finding) = each(channel, resting, by) {
            let _ = found.push(finding);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(means: [f32; 3], changes: [f32; 3]) -> [Resting; 3] {
        core::array::from_fn(|i| Resting {
            mean: means[i],
            change: changes[i],
            low: means[i] - 0.2,
            high: means[i] + 0.2,
            ..Resting::UNKNOWN
        })
    }

    fn judged(now: [Resting; 3]) -> Vec<CheckFinding, MAX_FINDINGS> {
        let mut found = Vec::new();
        judge(&now, &mut found);
        found
    }

    #[test]
    fn a_warm_rig_is_waited_for_and_a_wrong_thermistor_is_not() {
        assert!(is_worth_waiting(&at([22.0, 30.0, 29.0], [0.0, -0.3, -0.3])));
        assert!(is_worth_waiting(&at([22.0, 22.0, 22.0], [0.0, 0.6, 0.0])));
        assert!(!is_worth_waiting(&at([2.0, 22.0, 22.1], [0.0, 0.05, -0.05])));
        assert!(!is_worth_waiting(&at([22.0, 22.5, 22.1], [0.0, -0.2, -0.2])), "near enough");
    }

    #[test]
    fn the_odd_one_is_named_and_small_differences_are_offsets() {
        let off = judged(at([2.0, 22.0, 22.1], [0.0; 3]));
        assert!(
            matches!(off[..], [CheckFinding::FarOff(Channel::T0, by)] if (by + 20.0).abs() < 0.01),
            "{off:?}"
        );
        let offset = judged(at([22.0, 22.1, 23.1], [0.0; 3]));
        assert!(matches!(offset[..], [CheckFinding::Offset(Channel::T2, by)] if (by - 1.0).abs() < 0.01));
        assert!(offset[0].is_note());
        assert_eq!(judged(at([22.0, 22.1, 22.2], [0.0; 3])), []);
    }

    #[test]
    fn what_never_comes_to_rest_or_rattles_is_told() {
        assert!(matches!(
            judged(at([22.0; 3], [0.0, 0.9, 0.0]))[..],
            [CheckFinding::NotAtRest(Channel::T1, _)]
        ));
        let mut loose = at([22.0; 3], [0.0; 3]);
        loose[2].high += 5.0;
        assert!(matches!(judged(loose)[..], [CheckFinding::Noisy(Channel::T2, _)]));
    }
}
