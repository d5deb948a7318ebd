//! What of a finding can be: a class that needs an input which the recording lacks can't, nor a temperature that nothing in it comes near.

use std::ops::RangeInclusive;

use fdi_core::likelihood::{Channel, Magnitude};
use fdi_core::{Finding, Sample};

use super::{Heater, span};

/// A heater may give so many % more than it is asked for, or a fan move so much more air; nothing gives less than nothing. An interval may reach beyond.
const MORE: RangeInclusive<f32> = -100.0..=400.0;

/// Nor does a thermistor read further off than so many times all that it read.
const LARGEST_OFFSET: f64 = 1.5;

/// The temperatures that each thermistor of a heater can have: those that it had, and as much again on either side.
#[derive(Clone, Debug)]
pub struct Believed {
    inputs: fdi_core::Inputs,
    ranges: [RangeInclusive<f64>; 3],
}

impl Believed {
    /// By all that was recorded of it.
    pub fn of(heater: &Heater) -> Self {
        let range = |which: usize| {
            let (low, high) = span(heater.samples.iter().filter_map(|sample| sample.t[which]));
            let more = high - low;
            low - more..=high + more
        };
        Self { inputs: heater.inputs, ranges: [0, 1, 2].map(range) }
    }

    /// Whether a finding can be, with what was measured and expected, in the recording's units.
    pub fn believes(&self, finding: &Finding, sample: &Sample, expected: &[Option<f32>; 3]) -> bool {
        let class = finding.class;
        let size = finding.magnitude.map(|magnitude| magnitude.value);
        let is_possible = match class.unit() {
            "% of power" | "% of air flow" => {
                finding.magnitude.is_none_or(|Magnitude { value, half_width }| {
                    value + half_width >= *MORE.start() && value - half_width <= *MORE.end()
                })
            }
            _ => true,
        };
        self.inputs.tell(class)
            && is_possible
            && class.sensor().is_none_or(|which| {
                let reading = match which {
                    Channel::T0 => sample.t0,
                    Channel::T1 => sample.t1,
                    Channel::T2 => sample.t2,
                };
                let range = &self.ranges[which as usize];
                let is_near = |t: f32| range.contains(&f64::from(t));
                match class.unit() {
                    "degC" => size.is_none_or(|size| {
                        let most = LARGEST_OFFSET / 3.0 * (range.end() - range.start());
                        is_near(reading.celsius.0 - size) && f64::from(size.abs()) <= most
                    }),
                    // What sees less of the rise reads lower, and no more higher than it should be lower; what sees more the other way round.
                    "% of gain" => {
                        let lowest = range.start() + (range.end() - range.start()) / 3.0;
                        let room = sample.t0.good().unwrap_or(lowest as f32);
                        let is_on_its_side = |t: f32| {
                            let off = size.unwrap_or_default() / 100.0 * (t - room);
                            off * (reading.celsius.0 - t) >= -off * off
                        };
                        expected[which as usize].is_none_or(|t| is_near(t) && is_on_its_side(t))
                    }
                    _ => expected[which as usize].is_none_or(is_near),
                }
            })
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::likelihood::FaultClass;
    use fdi_core::{Celsius, Reading, Validity};

    use super::*;
    use crate::recording::Recording;

    #[test]
    fn what_the_recording_cannot_have_is_not_believed() {
        let rows: String = (0..100).map(|k| format!("{k},{},{}\n", 20 + k % 31, k % 7)).collect();
        let how = crate::recording::Reading { fan: Some(false), ..Default::default() };
        let recording = Recording::parse("f".into(), &format!("time,temp,power\n{rows}"), &how).unwrap();
        let believed = Believed::of(&recording.heaters[0]);
        let good = Reading { celsius: Celsius(30.0), validity: Validity::Good };
        let cold = Reading { celsius: Celsius(20.0), validity: Validity::Good };
        let sample = Sample { t0: cold, t1: good, t2: good };
        let says = |class, size: f32, expected: f32| {
            let magnitude = Some(Magnitude { value: size, half_width: 1.0 });
            let finding = Finding { class, confidence: 0.9, magnitude, onset: 0 };
            believed.believes(&finding, &sample, &[None, Some(expected), None])
        };
        assert!(says(FaultClass::T1Offset, 5.0, 25.0) && says(FaultClass::T1Detached, -90.0, 70.0));
        assert!(says(FaultClass::HeaterPower, -40.0, 30.0));
        assert!(says(FaultClass::HeaterPower, -100.6, 30.0), "-100 % is within its interval");
        // 20 % less of a rise of 9 is 1.8 below what is expected; one that reads more than 1.8 above it sees no less.
        assert!(says(FaultClass::T1Detached, -20.0, 29.0) && !says(FaultClass::T1Detached, -20.0, 27.0));
        for (class, size, expected) in [
            (FaultClass::T1Offset, 133.0, 30.0),
            (FaultClass::T1Offset, 46.0, 30.0),
            (FaultClass::T1Detached, -90.0, 400.0),
            (FaultClass::HeaterPower, 900.0, 30.0),
            (FaultClass::HeaterPower, -101.6, 30.0),
            (FaultClass::T2Offset, 1.0, 30.0),
            (FaultClass::AirFlow, 20.0, 30.0),
        ] {
            assert!(!says(class, size, expected), "{class:?} {size} {expected}");
        }
    }
}
