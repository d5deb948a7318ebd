//! What can happen to the rig, as verbs: `offset` a sensor, `clog` it, change the `air-flow`. Any size, onset, duration.

mod bounds;
mod conditions;

use std::fmt;

use serde::{Deserialize, Serialize};

pub use conditions::{Conditions, ConverterOutput};

/// A thermistor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sensor {
    /// Room.
    T0,
    /// Outlet, in the loop.
    T1,
    /// Outlet, downstream.
    T2,
}

impl Sensor {
    /// The one after it, of T2 the first: each pair is one and its next.
    fn next(self) -> Self {
        match self {
            Self::T0 => Self::T1,
            Self::T1 => Self::T2,
            Self::T2 => Self::T0,
        }
    }
}

/// What is done to the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verb {
    /// A sensor reads `size` degC too high (negative: too low).
    Offset,
    /// A sensor's error grows by `size` degC a minute.
    Drift,
    /// A sensor sees `size` times the rise of the air, with the time constant `lag` s.
    Clog,
    /// A sensor's wire is broken.
    Open,
    /// A sensor's wires touch.
    Short,
    /// A sensor repeats its last code.
    Stuck,
    /// One single sample of a sensor is `size` degC off.
    Spike,
    /// Samples of a sensor go missing with the probability `size`.
    Missing,
    /// The air flow is `size` times the nominal one.
    AirFlow,
    /// The heater gives `size` times the power asked for.
    HeaterPower,
    /// The heater gives `size` % whatever is asked for.
    HeaterStuck,
    /// The room is `size` degC warmer.
    Ambient,
    /// The room grows warmer by `size` degC a minute.
    AmbientDrift,
    /// A sensor slides out of the tube in `over` s: it sees 1 - `size` of the rise, with the time constant `lag` s.
    Detach,
    /// Two sensors are exchanged at their inputs: `sensor` and `with`.
    Swap,
    /// A sensor repeats its last code, with noise of the standard deviation `size` codes.
    Freeze,
    /// The heater's supply has `size` times its nominal voltage.
    SupplyVoltage,
    /// A sensor's contact is loose: it reads `size` degC too high, or right, and changes between the two at random.
    Loose,
    /// A resistance of `size` ohm lies across a sensor, such as water in its plug: it reads too hot.
    Shunt,
    /// The return wire that the three thermistors share has `size` ohm: all read too cold, the more the hotter they are.
    Return,
}

impl fmt::Display for Verb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// All verbs. New ones come last: the numbers of the column `truth` go by this order.
const ALL_VERBS: [Verb; 20] = [
    Verb::Offset,
    Verb::Drift,
    Verb::Clog,
    Verb::Open,
    Verb::Short,
    Verb::Stuck,
    Verb::Spike,
    Verb::Missing,
    Verb::AirFlow,
    Verb::HeaterPower,
    Verb::HeaterStuck,
    Verb::Ambient,
    Verb::AmbientDrift,
    Verb::Detach,
    Verb::Swap,
    Verb::Freeze,
    Verb::SupplyVoltage,
    Verb::Loose,
    Verb::Shunt,
    Verb::Return,
];

/// One thing that happens, for a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fault {
    /// Name in tables; empty: made from verb and sensor.
    #[serde(default)]
    pub name: String,
    /// What is done.
    #[serde(rename = "do")]
    pub verb: Verb,
    /// To which sensor, where the verb asks for one.
    #[serde(default)]
    pub sensor: Option<Sensor>,
    /// How much, in the unit of the verb.
    #[serde(default)]
    pub size: Option<f64>,
    /// Time constant in s that a clogged or detached sensor gets; left out: the one that it has in the tube.
    #[serde(default)]
    pub lag: Option<f64>,
    /// With which sensor it is exchanged.
    #[serde(default)]
    pub with: Option<Sensor>,
    /// How long it takes until the fault has its size, s; left out: it has it at once.
    #[serde(default)]
    pub over: Option<f64>,
    /// Onset, s.
    pub at: f64,
    /// Duration, s.
    #[serde(rename = "for")]
    pub duration: f64,
}

impl Fault {
    /// One with no name and none of the keys that only some verbs take.
    pub fn new(verb: Verb, sensor: Option<Sensor>, size: Option<f64>, at: f64, duration: f64) -> Self {
        Self { name: String::new(), verb, sensor, size, lag: None, with: None, over: None, at, duration }
    }

    /// The same on a plant that is `factor` times slower: all of its times are longer by it, and what grows by the minute grows
    /// slower.
    pub fn slowed(&self, factor: f64) -> Self {
        let longer = |time: f64| time * factor;
        let grows = matches!(self.verb, Verb::Drift | Verb::AmbientDrift);
        Self {
            size: self.size.map(|size| if grows { size / factor } else { size }),
            lag: self.lag.map(longer),
            over: self.over.map(longer),
            at: longer(self.at),
            duration: longer(self.duration),
            ..self.clone()
        }
    }

    /// Whether it acts at a time.
    pub fn is_active(&self, t: f64) -> bool {
        t >= self.at && t < self.end()
    }

    /// End, s.
    pub fn end(&self) -> f64 {
        self.at + self.duration
    }

    /// Times at which the conditions change.
    pub fn edges(&self) -> [f64; 2] {
        [self.at, self.end()]
    }

    /// The name given, or one made from verb and sensor.
    pub fn label(&self) -> String {
        if !self.name.is_empty() {
            return self.name.clone();
        }
        let verb = self.verb;
        match (self.sensor, self.with) {
            (Some(sensor), Some(with)) => format!("{sensor:?} {verb} {with:?}"),
            (Some(sensor), None) => format!("{sensor:?} {verb}"),
            (None, _) => verb.to_string(),
        }
    }

    /// Scales the departure from normal by `factor`; 1 leaves the fault as it is.
    pub fn scaled(&self, factor: f64) -> Self {
        let size = self.size.map(|size| match self.verb {
            Verb::Clog | Verb::AirFlow | Verb::HeaterPower | Verb::SupplyVoltage => {
                1.0 + (size - 1.0) * factor
            }
            Verb::Detach => (size * factor).clamp(0.0, 1.0),
            _ => size * factor,
        });
        let lag = self.lag.map(|lag| CLEAN_LAG + (lag - CLEAN_LAG) * factor.abs());
        Self { size, lag, ..self.clone() }
    }

    /// `size` as it is at a time, while the fault comes `over` so long; of a verb without, 0.
    pub fn size_at(&self, t: f64) -> f64 {
        let size = self.size.unwrap_or_default();
        match self.over {
            Some(over) if t - self.at < over => self.scaled((t - self.at) / over).size.unwrap_or_default(),
            _ => size,
        }
    }

    /// Number in the column `truth`: 1 to 3 are the paper's faults (of either sign), others from 4; an exchange of two
    /// sensors goes by the third.
    pub fn truth(&self) -> u8 {
        match (self.verb, self.sensor) {
            (Verb::Offset, Some(Sensor::T2)) => 1,
            (Verb::Clog, Some(Sensor::T1)) => 2,
            (Verb::AirFlow, _) => 3,
            (Verb::Swap, Some(sensor)) => {
                let both = sensor as u8 + self.with.map_or(0, |s| s as u8);
                4 + 3 * (Verb::Swap as u8) + 3u8.saturating_sub(both)
            }
            (verb, sensor) => {
                let sensor = sensor.map_or(0, |s| s as u8);
                4 + 3 * (verb as u8) + sensor
            }
        }
    }

    /// A fault of which only the number is known, as in a trace; `None` for 0 and numbers that mean nothing.
    pub fn from_truth(number: u8, at: f64, duration: f64) -> Option<Self> {
        let names = ["AFS2", "MFS1", "MFP"];
        let faults = ALL_VERBS.into_iter().flat_map(|verb| {
            let sensors = [None, Some(Sensor::T0), Some(Sensor::T1), Some(Sensor::T2)];
            sensors.map(|sensor| {
                let with = sensor.filter(|_| verb == Verb::Swap).map(Sensor::next);
                Self { with, ..Self::new(verb, sensor, None, at, duration) }
            })
        });
        let mut possible = faults
            .filter(|fault| fault.truth() == number && fault.verb.needs_sensor() == fault.sensor.is_some());
        let name = usize::from(number).checked_sub(1).and_then(|i| names.get(i));
        possible.next().map(|fault| Self { name: name.map_or(String::new(), ToString::to_string), ..fault })
    }
}

/// Lag of a clean T1, from which a clogged one's is scaled, s.
const CLEAN_LAG: f64 = 0.05;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_that_comes_little_by_little_grows_in_a_straight_line() {
        let slow = |verb, sensor, size| Fault {
            over: Some(10.0),
            ..Fault::new(verb, sensor, Some(size), 100.0, 60.0)
        };
        for (fault, at_start, half) in [
            (slow(Verb::AirFlow, None, 0.6), 1.0, 0.8),
            (slow(Verb::HeaterPower, None, 1.4), 1.0, 1.2),
            (slow(Verb::Offset, Some(Sensor::T0), -2.0), 0.0, -1.0),
            (slow(Verb::Detach, Some(Sensor::T1), 0.5), 0.0, 0.25),
        ] {
            fault.validate("fault").unwrap();
            let sizes = [100.0, 105.0, 110.0, 150.0].map(|t| fault.size_at(t));
            assert_eq!(
                sizes,
                [at_start, half, fault.size.unwrap(), fault.size.unwrap()],
                "{}",
                fault.label()
            );
        }
        let sudden = Fault::new(Verb::AirFlow, None, Some(1.26), 100.0, 60.0);
        assert!(sudden.size_at(100.0) == 1.26);
        let stuck = Fault { size: None, ..slow(Verb::Stuck, Some(Sensor::T1), 0.0) };
        assert!(stuck.validate("fault").unwrap_err().to_string().contains("over = 10"));
    }

    /// What stood when the instrument learnt is undone by the inverse.
    #[test]
    fn faults_of_one_kind_act_together() {
        let both = |verb, sensor, sizes: [f64; 2]| {
            let faults = sizes.map(|size| Fault::new(verb, sensor, Some(size), 0.0, 9.0));
            Conditions::at(&faults, 1.0, 0.1)
        };
        assert!(both(Verb::AirFlow, None, [0.8, 1.25]).flow == 1.0);
        assert!(both(Verb::HeaterPower, None, [0.8, 1.25]).power == 1.0);
        assert!(both(Verb::Clog, Some(Sensor::T1), [0.8, 1.25]).gain == [1.0; 3]);
        assert!(both(Verb::Offset, Some(Sensor::T2), [1.5, -1.5]).offset == [0.0; 3]);
    }

    /// A recording keeps the number alone: what it says must not change with the verbs that are added.
    #[test]
    fn a_number_stands_for_one_fault_and_old_ones_stay() {
        use Sensor::{T0, T1, T2};
        let swap =
            |sensor, with| Fault { with: Some(with), ..Fault::new(Verb::Swap, Some(sensor), None, 1.0, 1.0) };
        let plain = |verb, sensor| Fault::new(verb, sensor, None, 1.0, 1.0);
        for (fault, number) in [
            (plain(Verb::Offset, Some(T1)), 5),
            (plain(Verb::Stuck, Some(T1)), 20),
            (plain(Verb::AmbientDrift, None), 40),
            (plain(Verb::Detach, Some(T1)), 44),
            (plain(Verb::Freeze, Some(T2)), 51),
            (plain(Verb::SupplyVoltage, None), 52),
            (plain(Verb::Loose, Some(T2)), 57),
            (swap(T1, T2), 46),
            (swap(T2, T1), 46),
            (swap(T0, T2), 47),
            (swap(T0, T1), 48),
        ] {
            assert_eq!(fault.truth(), number, "{}", fault.label());
            let read = Fault::from_truth(number, 1.0, 1.0).unwrap();
            assert_eq!((read.verb, read.truth()), (fault.verb, number));
            assert!(read.with.is_some() == (read.verb == Verb::Swap), "{}", read.label());
        }
    }
}
