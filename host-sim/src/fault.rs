//! What can happen to the rig, as verbs: `offset` a sensor, `clog` it, change the `air-flow`. Any size, onset, duration.

use serde::{Deserialize, Serialize};

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
    Room,
    /// The room grows warmer by `size` degC a minute.
    RoomDrift,
}

/// All verbs.
const ALL_VERBS: [Verb; 13] = [
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
    Verb::Room,
    Verb::RoomDrift,
];

impl Verb {
    /// Whether it is done to a sensor, and not to the rig as a whole.
    fn needs_sensor(self) -> bool {
        !matches!(self, Self::AirFlow | Self::HeaterPower | Self::HeaterStuck | Self::Room | Self::RoomDrift)
    }
}

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
    /// Time constant in s that a clogged sensor gets.
    #[serde(default)]
    pub lag: Option<f64>,
    /// Onset, s.
    pub at: f64,
    /// Duration, s.
    #[serde(rename = "for")]
    pub duration: f64,
}

/// What the paper's tables can say of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expected {
    /// Value that fdv should take.
    pub fdv: Option<u8>,
    /// Value that fiv should take.
    pub fiv: Option<u8>,
}

impl Fault {
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
        let verb = serde_json::to_value(self.verb)
            .ok()
            .and_then(|v| v.as_str().map(str::to_owned))
            .unwrap_or_default();
        match self.sensor {
            Some(sensor) => format!("{sensor:?} {verb}"),
            None => verb,
        }
    }

    /// Number in the column `truth`: 1 to 3 are the paper's faults (of either sign), others from 4.
    pub fn truth(&self) -> u8 {
        match (self.verb, self.sensor) {
            (Verb::Offset, Some(Sensor::T2)) => 1,
            (Verb::Clog, Some(Sensor::T1)) => 2,
            (Verb::AirFlow, _) => 3,
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
            sensors.map(|sensor| Self {
                name: String::new(),
                verb,
                sensor,
                size: None,
                lag: None,
                at,
                duration,
            })
        });
        let mut possible = faults
            .filter(|fault| fault.truth() == number && fault.verb.needs_sensor() == fault.sensor.is_some());
        let name = usize::from(number).checked_sub(1).and_then(|i| names.get(i));
        possible.next().map(|fault| Self { name: name.map_or(String::new(), ToString::to_string), ..fault })
    }

    /// What the paper's tables should answer. They know T2 and T1 or the process apart; nothing for the rest.
    pub fn expected(&self) -> Expected {
        let (fdv, fiv) = match (self.truth(), self.verb, self.sensor) {
            (truth @ 1..=3, ..) => (Some(truth.min(2)), Some(truth)),
            (_, Verb::Offset | Verb::Drift | Verb::Clog | Verb::Stuck, Some(Sensor::T2)) => (Some(1), None),
            (_, Verb::Offset | Verb::Drift | Verb::Stuck, Some(Sensor::T1)) => (Some(2), None),
            (_, Verb::HeaterPower | Verb::HeaterStuck, _) => (Some(2), None),
            _ => (None, None),
        };
        Expected { fdv, fiv }
    }

    /// Scales the departure from normal by `factor`; 1 leaves the fault as it is.
    pub fn scaled(&self, factor: f64) -> Self {
        let size = self.size.map(|size| match self.verb {
            Verb::Clog | Verb::AirFlow | Verb::HeaterPower => 1.0 + (size - 1.0) * factor,
            _ => size * factor,
        });
        let lag = self.lag.map(|lag| CLEAN_LAG + (lag - CLEAN_LAG) * factor.abs());
        Self { size, lag, ..self.clone() }
    }

    /// Checks that the verb has what it needs.
    ///
    /// # Errors
    /// The key that is missing, too many or out of bounds; `place` says which fault it is.
    pub fn validate(&self, place: &str) -> anyhow::Result<()> {
        use Verb::{
            AirFlow, Clog, Drift, HeaterPower, HeaterStuck, Missing, Offset, Open, Room, RoomDrift, Short,
            Spike, Stuck,
        };
        let needs_sensor = self.verb.needs_sensor();
        let label = self.label();
        anyhow::ensure!(
            self.sensor.is_some() == needs_sensor,
            "{place} ({label}): key `sensor` {}",
            if needs_sensor { "is missing, expected t0, t1 or t2" } else { "makes no sense with this verb" }
        );
        let bounds = match self.verb {
            Offset | Spike | Room => Some((-100.0, 100.0, "degC")),
            Drift | RoomDrift => Some((-600.0, 600.0, "degC a minute")),
            Clog => Some((0.0, 3.0, "times the rise")),
            Missing => Some((0.0, 1.0, "as a probability")),
            AirFlow => Some((0.05, 10.0, "times the nominal flow")),
            HeaterPower => Some((0.0, 3.0, "times the power")),
            HeaterStuck => Some((0.0, 100.0, "%")),
            Open | Short | Stuck => None,
        };
        match (bounds, self.size) {
            (Some((min, max, unit)), Some(size)) => {
                anyhow::ensure!(
                    size >= min && size <= max,
                    "{place} ({label}): size is {size}, expected {min} to {max} {unit}"
                );
            }
            (Some((min, max, unit)), None) => {
                anyhow::bail!("{place} ({label}): key `size` is missing, expected {min} to {max} {unit}")
            }
            (None, Some(size)) => {
                anyhow::bail!("{place} ({label}): size = {size} makes no sense with this verb")
            }
            (None, None) => {}
        }
        if let Some(lag) = self.lag {
            anyhow::ensure!(
                self.verb == Clog,
                "{place} ({label}): lag = {lag} goes with `do = \"clog\"` only"
            );
            anyhow::ensure!(
                (0.001..=100.0).contains(&lag),
                "{place} ({label}): lag is {lag}, expected 0.001 to 100 s"
            );
        }
        anyhow::ensure!(self.at >= 0.0, "{place} ({label}): at is {}, expected 0 s or more", self.at);
        anyhow::ensure!(
            self.duration > 0.0,
            "{place} ({label}): for is {}, expected more than 0 s",
            self.duration
        );
        Ok(())
    }
}

/// Lag of a clean T1, from which a clogged one's is scaled, s.
const CLEAN_LAG: f64 = 0.05;

/// The paper's three faults at its onsets and durations, at the nominal size.
pub fn paper_sequence() -> Vec<Fault> {
    let fault = |name: &str, verb, sensor, size, lag, at, duration| Fault {
        name: name.into(),
        verb,
        sensor,
        size: Some(size),
        lag,
        at,
        duration,
    };
    vec![
        fault("AFS2", Verb::Offset, Some(Sensor::T2), 1.5, None, 384.5, 25.0),
        fault("MFS1", Verb::Clog, Some(Sensor::T1), 0.85, Some(0.40), 495.0, 10.0),
        fault("MFP", Verb::AirFlow, None, 1.26, None, 730.0, 25.0),
    ]
}

/// How large the faults are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FaultSize {
    /// AFS2 0.5 degC, MFS1 0.95 and 0.20 s, MFP 1.10; a third of any other fault.
    Small,
    /// As written.
    #[default]
    Nominal,
    /// AFS2 3 degC, MFS1 0.70 and 0.60 s, MFP 1.50; twice any other fault.
    Large,
    /// So many times the nominal departure; negative: the other way.
    Factor(f64),
}

impl FaultSize {
    /// The fault at this size.
    pub fn apply(self, fault: &Fault) -> Fault {
        let named = |factor: f64, offset: f64, clog: (f64, f64), flow: f64| match fault.name.as_str() {
            "AFS2" => Fault { size: Some(offset), ..fault.clone() },
            "MFS1" => Fault { size: Some(clog.0), lag: Some(clog.1), ..fault.clone() },
            "MFP" => Fault { size: Some(flow), ..fault.clone() },
            _ => fault.scaled(factor),
        };
        match self {
            Self::Small => named(1.0 / 3.0, 0.5, (0.95, 0.20), 1.10),
            Self::Nominal => fault.clone(),
            Self::Large => named(2.0, 3.0, (0.70, 0.60), 1.50),
            Self::Factor(factor) => fault.scaled(factor),
        }
    }
}

impl std::str::FromStr for FaultSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "small" => Ok(Self::Small),
            "nominal" => Ok(Self::Nominal),
            "large" => Ok(Self::Large),
            number => match number.parse::<f64>() {
                Ok(factor) if (-20.0..=20.0).contains(&factor) => Ok(Self::Factor(factor)),
                _ => Err("expected small, nominal, large, or a factor from -20 to 20".into()),
            },
        }
    }
}

impl std::fmt::Display for FaultSize {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Small => f.write_str("small"),
            Self::Nominal => f.write_str("nominal"),
            Self::Large => f.write_str("large"),
            Self::Factor(factor) => write!(f, "{factor}"),
        }
    }
}

/// What the converter of a channel says, instead of the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Reading {
    /// The truth.
    #[default]
    True,
    /// Full scale.
    Open,
    /// Zero.
    Short,
    /// What it said before.
    Stuck,
    /// Nothing, now and then.
    Missing {
        /// Probability for each sample.
        probability: f64,
    },
}

/// All that acts on the rig at one time. Arrays are for T0, T1, T2.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// Added to what a sensor reads, degC.
    pub offset: [f64; 3],
    /// Share of the rise that a sensor sees.
    pub gain: [f64; 3],
    /// Time constant that a clogged sensor has, s.
    pub lag: [Option<f64>; 3],
    /// What the converter says.
    pub reading: [Reading; 3],
    /// Air flow, relative.
    pub flow: f64,
    /// Heater power, relative to what is asked for.
    pub power: f64,
    /// Heater power whatever is asked for, %.
    pub stuck_power: Option<f64>,
    /// Room temperature above its usual, degC.
    pub room: f64,
}

impl Conditions {
    /// What acts at time `t`; `sample_time` is how long a single sample stands for a spike.
    pub fn at(faults: &[Fault], t: f64, sample_time: f64) -> Self {
        let mut now = Self {
            offset: [0.0; 3],
            gain: [1.0; 3],
            lag: [None; 3],
            reading: [Reading::True; 3],
            flow: 1.0,
            power: 1.0,
            stuck_power: None,
            room: 0.0,
        };
        for fault in faults.iter().filter(|f| f.is_active(t)) {
            let i = fault.sensor.map_or(0, |s| s as usize);
            let size = fault.size.unwrap_or_default();
            match fault.verb {
                Verb::Offset => now.offset[i] += size,
                Verb::Drift => now.offset[i] += size * (t - fault.at) / 60.0,
                Verb::Clog => (now.gain[i], now.lag[i]) = (size, fault.lag),
                Verb::Open => now.reading[i] = Reading::Open,
                Verb::Short => now.reading[i] = Reading::Short,
                Verb::Stuck => now.reading[i] = Reading::Stuck,
                Verb::Spike if t - fault.at < sample_time => now.offset[i] += size,
                Verb::Spike => {}
                Verb::Missing => now.reading[i] = Reading::Missing { probability: size },
                Verb::AirFlow => now.flow *= size,
                Verb::HeaterPower => now.power *= size,
                Verb::HeaterStuck => now.stuck_power = Some(size),
                Verb::Room => now.room += size,
                Verb::RoomDrift => now.room += size * (t - fault.at) / 60.0,
            }
        }
        now
    }
}
