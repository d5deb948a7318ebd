//! A finding of the likelihood diagnosis as a sentence: what is wrong and by how much, measured against expected, since when.

use core::fmt;

use fdi_core::Sample;
use fdi_core::likelihood::{Channel, FaultClass, Finding, Magnitude};

use crate::decimal::{At, Fixed};

/// A finding, to be shown. What should have been measured is what the models expect, or, of an offset, follows from what was
/// measured and the magnitude of the fault.
pub struct Sentence<'a> {
    /// The finding.
    pub finding: &'a Finding,
    /// What the thermistors read on its tick.
    pub sample: &'a Sample,
    /// What T0, T1, T2 should read on its tick by the models, degC.
    pub expected: [Option<f32>; 3],
    /// Ts in s.
    pub sample_time: f32,
}

impl fmt::Display for Sentence<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let class = self.finding.class;
        self.fill(f, class.sentence(self.finding.magnitude.is_some()))?;
        write!(f, "; since {} s", At(self.finding.onset, self.sample_time))?;
        match class {
            FaultClass::Unknown => Ok(()),
            _ if self.finding.confidence >= 0.995 => f.write_str(", confidence above 0.99"), // never 1.00
            _ => write!(f, ", confidence {}", Fixed(self.finding.confidence, 2)),
        }
    }
}

impl Sentence<'_> {
    /// Writes a sentence of [`FaultClass::sentence`] with what stands in braces filled in.
    fn fill(&self, f: &mut fmt::Formatter<'_>, sentence: &str) -> fmt::Result {
        for part in sentence.split('{') {
            match part.split_once('}') {
                Some((key, text)) => {
                    self.value(f, key)?;
                    f.write_str(text)?;
                }
                None => f.write_str(part)?,
            }
        }
        Ok(())
    }

    fn value(&self, f: &mut fmt::Formatter<'_>, key: &str) -> fmt::Result {
        let class = self.finding.class;
        let magnitude = self.finding.magnitude.unwrap_or_default();
        let channel = class.sensor().unwrap_or(Channel::T1);
        let other = if channel == Channel::T1 { Channel::T2 } else { Channel::T1 };
        let degrees = |celsius: f32| Fixed(celsius, 1);
        if let Some((positive, negative)) = key.split_once('|') {
            return f.write_str(if magnitude.value >= 0.0 { positive } else { negative });
        }
        match key {
            "t" => f.write_str(channel.name()),
            "other" => f.write_str(other.name()),
            "size" => {
                let is_share = class.unit().starts_with('%');
                let most = if is_share && magnitude.value < 0.0 { 100.0 } else { f32::MAX };
                write!(f, "{}", Size { m: magnitude, decimals: if is_share { 1 } else { 2 }, most })
            }
            "share" => write!(f, "{}", Fixed((100.0 + magnitude.value).max(0.0), 1)),
            "seen" => write!(f, "{}", Fixed((100.0 + magnitude.value).max(0.0), 0)),
            "measured" => write!(f, "{}", degrees(self.measured(channel))),
            "t0" => write!(f, "{}", degrees(self.measured(Channel::T0))),
            "t1" => write!(f, "{}", degrees(self.measured(Channel::T1))),
            "t2" => write!(f, "{}", degrees(self.measured(Channel::T2))),
            "corrected" => write!(f, "{}", degrees(self.measured(channel) - magnitude.value)),
            "expected" => match self.expected[channel as usize] {
                Some(expected) => write!(f, "{} expected", degrees(expected)),
                None => {
                    write!(f, "about {} expected, as {} reads", degrees(self.measured(other)), other.name())
                }
            },
            unknown => write!(f, "{{{unknown}}}"),
        }
    }

    fn measured(&self, channel: Channel) -> f32 {
        let sample = self.sample;
        let reading = match channel {
            Channel::T0 => sample.t0,
            Channel::T1 => sample.t1,
            Channel::T2 => sample.t2,
        };
        reading.celsius.0
    }
}

/// How much without its sign, and from where to where it may be.
struct Size {
    m: Magnitude,
    decimals: u8,
    /// Nothing gives more than 100 % less.
    most: f32,
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (value, half) = (self.m.value.abs(), self.m.half_width);
        let [value, low, high] =
            [value, value - half, value + half].map(|x| Fixed(x.min(self.most), self.decimals));
        write!(f, "{value} ({low} to {high})")
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::{Celsius, Reading, Validity};

    use super::*;

    fn told(class: FaultClass, magnitude: Option<(f32, f32)>) -> String {
        let reading = |celsius| Reading { celsius: Celsius(celsius), validity: Validity::Good };
        let sample = Sample { t0: reading(22.5), t1: reading(33.1), t2: reading(35.1) };
        let magnitude = magnitude.map(|(value, half_width)| Magnitude { value, half_width });
        let finding = Finding { class, confidence: 0.988, magnitude, onset: 3496 };
        let expected = [Some(22.5), Some(49.6), None];
        Sentence { finding: &finding, sample: &sample, expected, sample_time: 0.11 }.to_string()
    }

    #[test]
    fn an_offset_is_told_with_what_should_have_been_read() {
        assert_eq!(
            told(FaultClass::T2Offset, Some((1.5, 0.07))),
            "T2 reads 1.50 (1.43 to 1.57) degC too high: 35.1 degC measured, 33.6 expected; \
             since 384.6 s, confidence 0.99"
        );
        assert!(told(FaultClass::T0Fault, Some((-2.0, 0.1))).starts_with(
            "T0 reads 2.00 (1.90 to 2.10) degC too low, or T1 and T2 too high alike: 22.5 degC measured at T0, 24.5 expected;"
        ));
    }

    #[test]
    fn a_clogged_sensor_is_told_with_the_rise_it_should_see() {
        assert!(told(FaultClass::T1Clogged, Some((-15.0, 0.8))).starts_with(
            "T1 sees 15.0 (14.2 to 15.8) % less of the rise than it should: 33.1 degC measured, 49.6 expected;"
        ));
    }

    /// T1 reads what the room does: no share of it says what it should read.
    #[test]
    fn a_detached_sensor_is_held_against_the_models_or_the_other() {
        assert!(told(FaultClass::T1Detached, Some((-98.7, 1.0))).starts_with(
            "T1 sees 1 % of the rise: is it out of the tube? 33.1 degC measured, 49.6 expected;"
        ));
        assert!(told(FaultClass::T2Detached, None).starts_with(
            "T2 does not see the rise that T1 sees: is it out of the tube? 35.1 degC measured, about 33.1 expected, as T1 reads;"
        ));
    }

    #[test]
    fn changes_of_the_process_are_told_as_changes() {
        assert!(told(FaultClass::AirFlow, Some((26.0, 1.0))).starts_with(
            "the air flow is 26.0 (25.0 to 27.0) % stronger than learnt: 126.0 % of normal estimated, 100 expected;"
        ));
        assert!(told(FaultClass::HeaterPower, Some((-20.0, 1.0))).starts_with(
            "the heater gives 20.0 (19.0 to 21.0) % less power than asked for: 80.0 % of it estimated, 100 expected;"
        ));
    }

    /// The estimate is not bounded, what is said of it is.
    #[test]
    fn nothing_gives_more_than_100_percent_less() {
        assert!(told(FaultClass::HeaterPower, Some((-101.0, 3.0))).starts_with(
            "the heater gives 100.0 (98.0 to 100.0) % less power than asked for: 0.0 % of it estimated, 100 expected;"
        ));
        assert!(told(FaultClass::HeaterPower, Some((150.0, 3.0))).contains("150.0 (147.0 to 153.0) % more"));
        assert!(told(FaultClass::T1Offset, Some((-120.0, 1.0))).contains("120.00 (119.00 to 121.00) degC"));
    }

    #[test]
    fn every_class_has_a_sentence_of_its_own_without_a_gap() {
        let mut all = Vec::new();
        for class in FaultClass::ALL {
            all.push(told(class, None));
            if !class.unit().is_empty() {
                all.push(told(class, Some((12.0, 0.1))));
                all.push(told(class, Some((-12.0, 0.1))));
            }
        }
        for told in &all {
            let reference = ["expected", "learnt value", "command"].iter().any(|word| told.contains(word));
            assert!(reference && told.contains("; since 384.6 s"), "{told}");
            assert!(!told.contains(['{', '}', '|']), "{told}");
        }
        let count = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), count, "{all:?}");
    }
}
