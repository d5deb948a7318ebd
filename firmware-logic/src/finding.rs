//! A finding of the likelihood diagnosis as a sentence: what is wrong and by how much, measured against expected, since when.

use core::fmt;

use fdi_core::Sample;
use fdi_core::likelihood::{Channel, FaultClass, Finding, Magnitude, Pair};

use crate::decimal::Fixed;

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
        match self.finding.magnitude {
            Some(magnitude) => self.sized(f, magnitude)?,
            None => self.unsized_fault(f)?,
        }
        write!(f, "; since {} s", Fixed(self.finding.onset as f32 * self.sample_time, 1))?;
        match self.finding.class {
            FaultClass::Unknown => Ok(()),
            _ if self.finding.confidence >= 0.995 => f.write_str(", confidence above 0.99"), // never 1.00
            _ => write!(f, ", confidence {}", Fixed(self.finding.confidence, 2)),
        }
    }
}

impl Sentence<'_> {
    /// A fault that has a magnitude.
    fn sized(&self, f: &mut fmt::Formatter<'_>, m: Magnitude) -> fmt::Result {
        let up = m.value >= 0.0;
        let size = |decimals| Size { m, decimals };
        let share = 1.0 + m.value / 100.0;
        match self.finding.class {
            FaultClass::T1Offset => self.offset(f, Channel::T1, m),
            FaultClass::T2Offset => self.offset(f, Channel::T2, m),
            FaultClass::T0Fault => self.offset(f, Channel::T0, m),
            FaultClass::T1Clogged => {
                write!(f, "T1 sees {} % of the rise too {}", size(1), if up { "much" } else { "little" })?;
                let ambient = self.sample.t0.celsius.0;
                let whole = ambient + (self.sample.t1.celsius.0 - ambient) / share;
                self.against(f, Channel::T1, self.expected[1].unwrap_or(whole))
            }
            FaultClass::AirFlow => {
                let way = if up { "stronger" } else { "weaker" };
                write!(f, "the air flow is {} % {way} than learnt: ", size(1))?;
                write!(f, "{} % of normal estimated, 100 expected", Fixed(100.0 * share, 1))
            }
            FaultClass::HeaterPower => {
                let way = if up { "more" } else { "less" };
                write!(f, "the heater gives {} % {way} power than asked for: ", size(1))?;
                write!(f, "{} % of it estimated, 100 expected", Fixed(100.0 * share, 1))
            }
            FaultClass::Drift => {
                let way = if up { "upwards" } else { "downwards" };
                write!(f, "a thermistor drifts {way} by {} degC a minute, 0 expected", size(2))
            }
            FaultClass::T1Detached => self.detached(f, Channel::T1, Some(m)),
            FaultClass::T2Detached => self.detached(f, Channel::T2, Some(m)),
            _ => self.unsized_fault(f),
        }
    }

    fn detached(&self, f: &mut fmt::Formatter<'_>, channel: Channel, m: Option<Magnitude>) -> fmt::Result {
        let (name, other) = if channel == Channel::T1 { ("T1", "T2") } else { ("T2", "T1") };
        match m {
            Some(m) => {
                let sees = Fixed((100.0 + m.value).max(0.0), 0);
                write!(f, "{name} sees {sees} % of the rise: is it out of the tube?")?;
            }
            None => write!(f, "{name} does not see the rise that {other} sees: is it out of the tube?")?,
        }
        write!(f, " {} degC measured, ", Fixed(self.measured(channel), 1))?;
        match self.expected[channel as usize] {
            Some(expected) => write!(f, "{} expected", Fixed(expected, 1)),
            None => {
                let beside = if channel == Channel::T1 { Channel::T2 } else { Channel::T1 };
                write!(f, "about {} expected, as {other} reads", Fixed(self.measured(beside), 1))
            }
        }
    }

    fn offset(&self, f: &mut fmt::Formatter<'_>, channel: Channel, m: Magnitude) -> fmt::Result {
        let size = Size { m, decimals: 2 };
        let way = if m.value >= 0.0 { "high" } else { "low" };
        write!(f, "{} reads {size} degC too {way}", name(channel))?;
        self.against(f, channel, self.measured(channel) - m.value)
    }

    fn against(&self, f: &mut fmt::Formatter<'_>, channel: Channel, expected: f32) -> fmt::Result {
        write!(f, ": {} degC measured, {} expected", Fixed(self.measured(channel), 1), Fixed(expected, 1))
    }

    /// A fault that is or is not.
    fn unsized_fault(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.finding.class {
            FaultClass::Stuck(c) => {
                let stands = Fixed(self.measured(c), 1);
                write!(f, "{} stands still: {stands} degC measured, movement expected", name(c))
            }
            FaultClass::Open(c) => {
                write!(f, "wire of {} broken: no temperature measured, one expected", name(c))
            }
            FaultClass::Short(c) => {
                write!(f, "wires of {} touch: no temperature measured, one expected", name(c))
            }
            FaultClass::Lost(c) => {
                write!(f, "{} gives nothing that can be true: no temperature measured, one expected", name(c))
            }
            FaultClass::T1Detached => self.detached(f, Channel::T1, None),
            FaultClass::T2Detached => self.detached(f, Channel::T2, None),
            FaultClass::Swapped(pair) => f.write_str(match pair {
                Pair::T1T2 => {
                    "T2 answers to the heater before T1, T1 expected first: are their wires swapped?"
                }
                Pair::T0T1 => {
                    "T0 answers to the heater and T1 does not, the reverse expected: are their wires swapped?"
                }
                Pair::T0T2 => {
                    "T0 answers to the heater and T2 does not, the reverse expected: are their wires swapped?"
                }
            }),
            FaultClass::T0Fault => {
                let [t0, t1, t2] =
                    [Channel::T0, Channel::T1, Channel::T2].map(|c| Fixed(self.measured(c), 1));
                write!(
                    f,
                    "T0 reads {t0} degC and is no warmer place than T1 and T2: {t1} and {t2} measured, "
                )?;
                f.write_str("a colder room expected")
            }
            FaultClass::Unknown => f.write_str(
                "temperatures are not as expected, and no single known fault explains what was measured",
            ),
            named => f.write_str(named.name()),
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

pub(crate) fn name(channel: Channel) -> &'static str {
    match channel {
        Channel::T0 => "T0",
        Channel::T1 => "T1",
        Channel::T2 => "T2",
    }
}

/// How much without its sign, and from where to where it may be.
struct Size {
    m: Magnitude,
    decimals: u8,
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (value, half) = (self.m.value.abs(), self.m.half_width);
        let [value, low, high] = [value, value - half, value + half].map(|x| Fixed(x, self.decimals));
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
        assert!(
            told(FaultClass::T0Fault, Some((-2.0, 0.1)))
                .starts_with("T0 reads 2.00 (1.90 to 2.10) degC too low: 22.5 degC measured, 24.5 expected;")
        );
    }

    #[test]
    fn a_clogged_sensor_is_told_with_the_rise_it_should_see() {
        assert!(told(FaultClass::T1Clogged, Some((-15.0, 0.8))).starts_with(
            "T1 sees 15.0 (14.2 to 15.8) % of the rise too little: 33.1 degC measured, 49.6 expected;"
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

    #[test]
    fn every_class_has_a_sentence_of_its_own() {
        use Channel::{T0, T1, T2};
        let mut all = vec![
            told(FaultClass::T1Offset, Some((1.0, 0.1))),
            told(FaultClass::T2Offset, Some((1.0, 0.1))),
            told(FaultClass::T0Fault, Some((1.0, 0.1))),
            told(FaultClass::T1Clogged, Some((-10.0, 0.1))),
            told(FaultClass::AirFlow, Some((-10.0, 0.1))),
            told(FaultClass::HeaterPower, Some((10.0, 0.1))),
            told(FaultClass::Drift, Some((-3.0, 0.1))),
            told(FaultClass::T0Fault, None),
            told(FaultClass::T1Detached, None),
            told(FaultClass::T1Detached, Some((-50.0, 0.1))),
            told(FaultClass::T2Detached, None),
            told(FaultClass::Unknown, None),
        ];
        all.extend([Pair::T1T2, Pair::T0T1, Pair::T0T2].map(|pair| told(FaultClass::Swapped(pair), None)));
        for channel in [T0, T1, T2] {
            let classes = [FaultClass::Stuck, FaultClass::Open, FaultClass::Short, FaultClass::Lost];
            all.extend(classes.map(|class| told(class(channel), None)));
        }
        assert!(
            all.iter().all(|told| told.contains("expected") && told.contains("; since 384.6 s")),
            "{all:?}"
        );
        let count = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), count);
    }
}
