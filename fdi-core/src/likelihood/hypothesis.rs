//! The hypotheses, a row each: which class of fault shows which signature, and what its magnitude may be.

use super::class::{Channel, FaultClass, Pair};

/// A hypothesis about what is seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hypothesis {
    /// What computes it: a matched filter of the bank.
    pub(super) signature: Signature,
    /// What it is called.
    pub(super) class: FaultClass,
    /// Hypotheses of one kind are told apart only after the kind is known.
    pub(super) kind: u32,
    /// Bounds of its magnitude in the unit of the signature; of a drift in degC/s.
    pub(super) bounds: (f32, f32),
    /// What the magnitude of the signature is.
    pub(super) scale: Scale,
    /// By how much it must beat all others, as twice a log-likelihood ratio, before it counts at all.
    pub(super) handicap: f32,
}

/// What y1 and y2 do from the onset on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Signature {
    T2Offset,
    T1Offset,
    T0Offset,
    AirFlow,
    Power,
    T1Clogged,
    T1Stuck,
    T2Stuck,
    T0Drift,
    T1Drift,
    T2Drift,
    /// The same power whatever is asked for.
    ConstantPower,
    T2Detached,
    SwappedT1T2,
    SwappedT0T1,
    SwappedT0T2,
    /// Stuck near to where it was, but noisy.
    T1StuckNearby,
    T2StuckNearby,
}

/// Unit of a signature's magnitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scale {
    /// It has none that is reported.
    None,
    /// degC.
    Degrees,
    /// degC a tick.
    Drift,
    /// A share that has come on top, as a fraction.
    Gain,
    /// A share that is lost, as a fraction.
    Loss,
    /// `1 - 1/f`, with the air flow at f times normal.
    Flow,
}

/// A thermistor that loses more than this share of the rise is not clogged, but out of the tube. In the campaign clogged ones lose 30 %
/// at most, detached ones 50 % at least.
pub(super) const DETACHED: f32 = 0.4;
/// No slow drift is faster, degC a minute: the campaign's largest is 3.
const FASTEST_DRIFT: f32 = 10.0;
/// Beyond what any thermistor reads, degC.
const ANYTHING: (f32, f32) = (-200.0, 200.0);
const SLOW_DRIFT: (f32, f32) = (-FASTEST_DRIFT / 60.0, FASTEST_DRIFT / 60.0);
/// Where a thermistor is stuck differs by no more from where it was a tick before the onset, degC.
const NEARBY: (f32, f32) = (-0.5, 0.5);
/// `1 - 1/f` for f from 0.2 to 3.3: beyond, the air flow is lost or the fan another.
pub(super) const FLOW: (f32, f32) = (-4.0, 0.7);
/// The heater gives between nothing and twice what is asked for; a constant power in %.
const POWER: (f32, f32) = (-1.0, 1.0);
const CONSTANT_POWER: (f32, f32) = (0.0, 100.0);

/// A thermistor that is not where it should be, or stuck but noisy, leaves far less unexplained than anything else once it is so: odds of
/// 20,000 to 1. Until then it is neither best nor a rival of the best, so that the others are named as soon as without it.
const MISPLACED: f32 = 20.0;

pub(super) const COUNT: usize = Signature::T2StuckNearby as usize + 1;

/// All hypotheses, in the order of [`Signature`]. Of two that explain equally much the first counts.
pub(super) static HYPOTHESES: [Hypothesis; COUNT] = [
    likely(Signature::T2Offset, FaultClass::T2Offset, ANYTHING, Scale::Degrees),
    likely(Signature::T1Offset, FaultClass::T1Offset, ANYTHING, Scale::Degrees),
    likely(Signature::T0Offset, FaultClass::T0Fault, ANYTHING, Scale::Degrees),
    likely(Signature::AirFlow, FaultClass::AirFlow, FLOW, Scale::Flow),
    likely(Signature::Power, FaultClass::HeaterPower, POWER, Scale::Gain),
    likely(Signature::T1Clogged, FaultClass::T1Clogged, (0.0, 1.0), Scale::Loss),
    likely(Signature::T1Stuck, FaultClass::Stuck(Channel::T1), ANYTHING, Scale::None),
    likely(Signature::T2Stuck, FaultClass::Stuck(Channel::T2), ANYTHING, Scale::None),
    likely(Signature::T0Drift, FaultClass::Drift, SLOW_DRIFT, Scale::Drift),
    likely(Signature::T1Drift, FaultClass::Drift, SLOW_DRIFT, Scale::Drift),
    likely(Signature::T2Drift, FaultClass::Drift, SLOW_DRIFT, Scale::Drift),
    likely(Signature::ConstantPower, FaultClass::HeaterPower, CONSTANT_POWER, Scale::None),
    misplaced(Signature::T2Detached, FaultClass::T2Detached, (DETACHED, 1.0), Scale::Loss),
    misplaced(Signature::SwappedT1T2, FaultClass::Swapped(Pair::T1T2), ANYTHING, Scale::None),
    misplaced(Signature::SwappedT0T1, FaultClass::Swapped(Pair::T0T1), ANYTHING, Scale::None),
    misplaced(Signature::SwappedT0T2, FaultClass::Swapped(Pair::T0T2), ANYTHING, Scale::None),
    misplaced(Signature::T1StuckNearby, FaultClass::Stuck(Channel::T1), NEARBY, Scale::None),
    misplaced(Signature::T2StuckNearby, FaultClass::Stuck(Channel::T2), NEARBY, Scale::None),
];

const fn likely(signature: Signature, class: FaultClass, bounds: (f32, f32), scale: Scale) -> Hypothesis {
    Hypothesis { signature, class, kind: kind(class), bounds, scale, handicap: 0.0 }
}

const fn misplaced(signature: Signature, class: FaultClass, bounds: (f32, f32), scale: Scale) -> Hypothesis {
    Hypothesis { handicap: MISPLACED, ..likely(signature, class, bounds, scale) }
}

/// A kind is a class, but for air flow and heater power: they look alike, and are told apart only after the kind is known.
const fn kind(class: FaultClass) -> u32 {
    match class {
        FaultClass::AirFlow | FaultClass::HeaterPower => PROCESS,
        other => other.number(),
    }
}

/// The kind of the process: not a sensor has changed.
pub(super) const PROCESS: u32 = 0;

const _: () = {
    let mut i = 0;
    while i < COUNT {
        assert!(HYPOTHESES[i].signature as usize == i, "a row is out of order");
        i += 1;
    }
};

#[cfg(test)]
mod tests {
    use super::*;

    /// What is reported with a magnitude has a unit for it, and no other.
    #[test]
    fn scales_and_units_go_together() {
        for h in &HYPOTHESES {
            let units: &[&str] = match h.scale {
                Scale::None => continue,
                Scale::Degrees => &["degC"],
                Scale::Drift => &["degC/min"],
                Scale::Gain | Scale::Loss | Scale::Flow => &["% of gain", "% of power", "% of air flow"],
            };
            assert!(units.contains(&h.class.unit()), "{h:?}");
        }
    }

    #[test]
    fn bounds_are_bounds_and_power_and_flow_are_one_kind() {
        assert!(HYPOTHESES.iter().all(|h| h.bounds.0 < h.bounds.1 && h.bounds.1 > 0.0));
        let row = |signature: Signature| &HYPOTHESES[signature as usize];
        assert_eq!(row(Signature::AirFlow).kind, row(Signature::ConstantPower).kind);
        assert_eq!(row(Signature::T1Stuck).kind, row(Signature::T1StuckNearby).kind);
        assert_ne!(row(Signature::T1Stuck).kind, row(Signature::T2Stuck).kind);
        assert_ne!(row(Signature::T1Clogged).kind, row(Signature::Power).kind);
    }
}
