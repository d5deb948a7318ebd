//! Several diagnoses, one report.

use super::class::FaultClass;
use super::verdict::Finding;

/// Which finding is reported. A broken wire needs no second opinion; the models see more than a contradiction does, which in turn
/// says more than that a thermistor is lost, or that nothing fits. Over a T0 that is known to be wrong they say nothing of heater and air: a
/// wrong "heater power" would keep a loss of air from tripping.
pub(super) fn preferred(
    by_sensors: Option<Finding>,
    by_models: Option<Finding>,
    without_models: Option<Finding>,
) -> Option<Finding> {
    let broken = by_sensors.filter(|f| !matches!(f.class, FaultClass::Lost(_)));
    let misled = without_models.is_some_and(|f| f.class == FaultClass::T0Fault);
    let clear = by_models.filter(|f| match f.class {
        FaultClass::Unknown | FaultClass::Drift => false,
        FaultClass::AirFlow | FaultClass::HeaterPower | FaultClass::AirFlowOrHeaterPower => !misled,
        _ => true,
    });
    broken.or(clear).or(without_models).or(by_sensors).or(by_models)
}

#[cfg(test)]
mod tests {
    use super::super::class::Channel;
    use super::*;

    /// A broken wire before the models, the models before a contradiction, that before a lost thermistor and before no name.
    #[test]
    fn of_several_findings_the_most_telling_is_reported() {
        let named = |class| Some(Finding { class, confidence: 1.0, magnitude: None, onset: 0 });
        let class = |by_sensors, by_models, without_models| {
            preferred(by_sensors, by_models, without_models).map(|finding| finding.class)
        };
        let open = named(FaultClass::Open(Channel::T1));
        let lost = named(FaultClass::Lost(Channel::T2));
        let [offset, unknown, detached] =
            [FaultClass::T2Offset, FaultClass::Unknown, FaultClass::T1Detached].map(named);
        assert_eq!(class(open, offset, detached), Some(FaultClass::Open(Channel::T1)));
        assert_eq!(class(lost, offset, detached), Some(FaultClass::T2Offset));
        assert_eq!(class(lost, unknown, detached), Some(FaultClass::T1Detached));
        assert_eq!(class(lost, unknown, None), Some(FaultClass::Lost(Channel::T2)));
        assert_eq!(class(None, unknown, None), Some(FaultClass::Unknown));
        assert_eq!(class(None, None, None), None);
        let [power, t0] = [FaultClass::HeaterPower, FaultClass::T0Fault].map(named);
        assert_eq!(class(None, power, t0), Some(FaultClass::T0Fault), "rises over a wrong T0");
        assert_eq!(class(None, power, detached), Some(FaultClass::HeaterPower));
        assert_eq!(class(None, offset, t0), Some(FaultClass::T2Offset));
    }
}
