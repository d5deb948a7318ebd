//! How large the faults are: the paper's three, and any other scaled from its nominal size.

use pt326_rig::fault::{Fault, Sensor, Verb};

/// The paper's three faults at its onsets and durations, at the nominal size.
pub fn paper_sequence() -> Vec<Fault> {
    let fault = |name: &str, verb, sensor, size, lag, at, duration| Fault {
        name: name.into(),
        lag,
        ..Fault::new(verb, sensor, Some(size), at, duration)
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
