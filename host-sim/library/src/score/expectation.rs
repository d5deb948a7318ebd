//! What the diagnoses should say of what happens to the rig.

use fdi_core::likelihood::{Channel, FaultClass, Pair};
use pt326_rig::fault::{Fault, Sensor, Verb};

/// What both diagnoses should say of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expectation {
    /// Value that fdv should take. The paper's tables know T2 and T1 or the process apart; nothing of the rest.
    pub fdv: Option<u8>,
    /// Value that fiv should take.
    pub fiv: Option<u8>,
    /// The class that the likelihood diagnosis should name; `None` for what is no fault, of which nothing should be said:
    /// a room that changes, single spikes, samples missing now and then.
    pub class: Option<FaultClass>,
    /// The true departure in [`FaultClass::unit`] of that class, where it has one.
    pub magnitude: Option<f64>,
}

impl Expectation {
    /// Of one fault.
    pub fn of(fault: &Fault) -> Self {
        let (fdv, fiv) = vectors(fault);
        let class = class(fault);
        Self { fdv, fiv, class, magnitude: class.and(magnitude(fault)) }
    }
}

/// The class that stands for either of two causes until they can be told apart.
pub const EITHER: &str = "air_flow_or_heater_power";

/// Whether to say the class of this name is right where one of these acts: it is it, or one of two that may be it.
pub fn is_right(right: &[FaultClass], name: &str) -> bool {
    let either = |class: &FaultClass| matches!(class, FaultClass::AirFlow | FaultClass::HeaterPower);
    right.iter().any(|class| class.name() == name) || name == EITHER && right.iter().any(either)
}

/// How large a fault is at a time, as the departure that a class means by it, in [`FaultClass::unit`]; `None` where that has
/// no meaning. While a drift lasts it is an offset that grows.
pub fn size_as(fault: &Fault, class: FaultClass, t: f64) -> Option<f64> {
    let is_offset = matches!(class, FaultClass::T0Fault | FaultClass::T1Offset | FaultClass::T2Offset);
    if fault.verb == Verb::Drift && is_offset && class.sensor() == fault.sensor.map(channel) {
        return Some(fault.size? * (t - fault.at) / 60.0);
    }
    let now = Fault { size: fault.size.map(|_| fault.size_at(t)), ..fault.clone() };
    let expected = Expectation::of(&now);
    expected.magnitude.filter(|_| expected.class == Some(class))
}

fn vectors(fault: &Fault) -> (Option<u8>, Option<u8>) {
    use Verb::{Clog, Detach, Drift, Freeze, HeaterPower, HeaterStuck, Loose, Offset, Stuck, SupplyVoltage};
    match (fault.truth(), fault.verb, fault.sensor) {
        (truth @ 1..=3, ..) => (Some(truth.min(2)), Some(truth)),
        (_, Offset | Loose | Drift | Clog | Stuck | Detach | Freeze, Some(Sensor::T2)) => (Some(1), None),
        (_, Offset | Loose | Drift | Stuck | Detach | Freeze, Some(Sensor::T1)) => (Some(2), None),
        (_, HeaterPower | HeaterStuck | SupplyVoltage, _) => (Some(2), None),
        _ => (None, None),
    }
}

fn class(fault: &Fault) -> Option<FaultClass> {
    use Channel::{T0, T1, T2};
    match (fault.verb, fault.sensor.map(channel)) {
        (Verb::AirFlow, _) => Some(FaultClass::AirFlow),
        (Verb::HeaterPower | Verb::HeaterStuck | Verb::SupplyVoltage, _) => Some(FaultClass::HeaterPower),
        (Verb::Loose, Some(T1)) => Some(FaultClass::T1Loose),
        (Verb::Loose, Some(T2)) => Some(FaultClass::T2Loose),
        (Verb::Offset, Some(T1)) => Some(FaultClass::T1Offset),
        (Verb::Offset, Some(T2)) => Some(FaultClass::T2Offset),
        (Verb::Offset | Verb::Clog, Some(T0)) => Some(FaultClass::T0Fault),
        (Verb::Clog, Some(T1)) => Some(FaultClass::T1Clogged),
        (Verb::Clog, Some(T2)) => Some(FaultClass::Unknown),
        (Verb::Drift, Some(_)) => Some(FaultClass::Drift),
        (Verb::Detach, Some(T1)) => Some(FaultClass::T1Detached),
        (Verb::Detach, _) => Some(FaultClass::T2Detached),
        (Verb::Swap, _) => pair(fault).map(FaultClass::Swapped),
        (Verb::Stuck | Verb::Freeze, channel) => channel.map(FaultClass::Stuck),
        (Verb::Open, channel) => channel.map(FaultClass::Open),
        (Verb::Short, channel) => channel.map(FaultClass::Short),
        (Verb::Missing, channel) if fault.size == Some(1.0) => channel.map(FaultClass::Lost),
        (Verb::Offset | Verb::Loose | Verb::Clog | Verb::Drift | Verb::Missing, _) => None,
        (Verb::Spike | Verb::Ambient | Verb::AmbientDrift | Verb::Shunt | Verb::Return, _) => None,
    }
}

fn magnitude(fault: &Fault) -> Option<f64> {
    let size = fault.size?;
    match fault.verb {
        Verb::Offset | Verb::Drift | Verb::Loose => Some(size),
        Verb::Clog if fault.sensor == Some(Sensor::T1) => Some(percent(size)),
        Verb::AirFlow | Verb::HeaterPower => Some(percent(size)),
        Verb::SupplyVoltage => Some(percent(size * size)), // of power
        _ => None,
    }
}

/// The same thermistor in the words of the instrument.
fn channel(sensor: Sensor) -> Channel {
    match sensor {
        Sensor::T0 => Channel::T0,
        Sensor::T1 => Channel::T1,
        Sensor::T2 => Channel::T2,
    }
}

/// The two that are exchanged.
fn pair(fault: &Fault) -> Option<Pair> {
    use Sensor::{T0, T1, T2};
    match (fault.sensor?, fault.with?) {
        (T1, T2) | (T2, T1) => Some(Pair::T1T2),
        (T0, T1) | (T1, T0) => Some(Pair::T0T1),
        (T0, T2) | (T2, T0) => Some(Pair::T0T2),
        (T0, T0) | (T1, T1) | (T2, T2) => None,
    }
}

/// A factor as a departure from 1, %. Rounded to what people write: 26 and not 26.000000000000004.
fn percent(factor: f64) -> f64 {
    (1e8 * (factor - 1.0)).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(verb: Verb, sensor: Option<Sensor>, size: Option<f64>) -> Fault {
        Fault::new(verb, sensor, size, 1.0, 1.0)
    }

    #[test]
    fn each_fault_has_its_class_and_magnitude_in_the_unit_of_the_class() {
        use Sensor::{T0, T1, T2};
        for (verb, sensor, size, class, magnitude) in [
            (Verb::Offset, Some(T1), Some(-1.5), FaultClass::T1Offset, Some(-1.5)),
            (Verb::Offset, Some(T2), Some(1.5), FaultClass::T2Offset, Some(1.5)),
            (Verb::Offset, Some(T0), Some(2.0), FaultClass::T0Fault, Some(2.0)),
            (Verb::Clog, Some(T1), Some(0.85), FaultClass::T1Clogged, Some(-15.0)),
            (Verb::AirFlow, None, Some(1.26), FaultClass::AirFlow, Some(26.0)),
            (Verb::HeaterPower, None, Some(0.8), FaultClass::HeaterPower, Some(-20.0)),
            (Verb::HeaterStuck, None, Some(60.0), FaultClass::HeaterPower, None),
            (Verb::Drift, Some(T2), Some(3.0), FaultClass::Drift, Some(3.0)),
            (Verb::Stuck, Some(T2), None, FaultClass::Stuck(Channel::T2), None),
            (Verb::Missing, Some(T1), Some(1.0), FaultClass::Lost(Channel::T1), None),
            (Verb::Detach, Some(T1), Some(0.5), FaultClass::T1Detached, None),
            (Verb::Detach, Some(T2), Some(1.0), FaultClass::T2Detached, None),
            (Verb::Freeze, Some(T1), Some(2.0), FaultClass::Stuck(Channel::T1), None),
        ] {
            let fault = fault(verb, sensor, size);
            let expected = Expectation::of(&fault);
            assert_eq!((expected.class, expected.magnitude), (Some(class), magnitude));
        }
    }

    #[test]
    fn the_size_of_a_slow_fault_is_that_of_the_moment_and_of_the_class_that_names_it() {
        let flow = Fault { over: Some(10.0), ..fault(Verb::AirFlow, None, Some(0.6)) };
        assert_eq!(size_as(&flow, FaultClass::AirFlow, 6.0), Some(-20.0));
        assert_eq!(size_as(&flow, FaultClass::AirFlow, 60.0), Some(-40.0));
        assert_eq!(size_as(&flow, FaultClass::HeaterPower, 60.0), None);
        let drift = fault(Verb::Drift, Some(Sensor::T1), Some(0.5));
        assert_eq!(size_as(&drift, FaultClass::Drift, 61.0), Some(0.5));
        assert_eq!(size_as(&drift, FaultClass::T1Offset, 121.0), Some(1.0));
        assert_eq!(size_as(&drift, FaultClass::T2Offset, 121.0), None);
        assert_eq!(
            size_as(&fault(Verb::Stuck, Some(Sensor::T1), None), FaultClass::Stuck(Channel::T1), 2.0),
            None
        );
    }

    #[test]
    fn a_name_for_two_causes_is_right_for_either() {
        let [flow, drift] = [[FaultClass::AirFlow], [FaultClass::Drift]];
        assert!(is_right(&flow, "air_flow") && is_right(&flow, EITHER) && !is_right(&flow, "heater_power"));
        assert!(
            !is_right(&drift, EITHER)
                && is_right(&[FaultClass::HeaterPower], EITHER)
                && !is_right(&[], EITHER)
        );
    }

    #[test]
    fn an_exchange_is_the_same_from_either_side() {
        use Sensor::{T0, T1, T2};
        for (a, b, pair) in [(T1, T2, Pair::T1T2), (T0, T1, Pair::T0T1), (T0, T2, Pair::T0T2)] {
            for (sensor, with) in [(a, b), (b, a)] {
                let swap = Fault { with: Some(with), ..fault(Verb::Swap, Some(sensor), None) };
                assert_eq!(Expectation::of(&swap).class, Some(FaultClass::Swapped(pair)));
            }
        }
    }

    #[test]
    fn what_is_no_fault_expects_silence() {
        for (verb, sensor, size) in [
            (Verb::Ambient, None, 2.0),
            (Verb::AmbientDrift, None, 2.0),
            (Verb::Spike, Some(Sensor::T1), 10.0),
            (Verb::Missing, Some(Sensor::T1), 0.05),
        ] {
            let fault = fault(verb, sensor, Some(size));
            let expected = Expectation::of(&fault);
            assert_eq!((expected.class, expected.magnitude), (None, None), "{verb:?}");
        }
    }
}
