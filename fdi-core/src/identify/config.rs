//! Settings of the estimators.

use crate::error::{ConfigError, above};
use crate::settings::{Field, FieldType, Form, FormNumber, Kind, Value, check, settings};
use crate::units::{Celsius, Percent, Seconds};

settings! {
    /// Identification: two ARX(3,3,1) models by recursive least squares.
    pub struct IdentificationConfig: Identification "identification." {
        /// How old data lose their weight: exponential forgetting by a factor lambda, with a memory of about `1 / (1 - lambda)`
        /// samples, or a Kalman filter for parameters that walk at random, with the variance r1 that a scaled parameter gains
        /// in a sample and the variance r2 of the scaled measurement.
        adaptation: Adaptation = Adaptation::Forgetting { lambda: 0.95 };
        /// D of the factored covariance at the start: the variance of a parameter nothing is known of.
        d_initial: f32 = 1e4, 1e-6..=1e9;
        /// Cap on D: how vague a parameter may become while nothing excites it.
        d_max: f32 = 1e5, 1.0..=1e9;
        /// Typical rise of the temperature; scales the regressor.
        y_scale: Celsius = 12.5, 1e-3..=1e6;
        /// Typical heater power; scales the regressor.
        u_scale: Percent = 41.7, 1e-3..=1e6;
        /// How the bandwidth is read off the model: 3 / tr with the rise time to 95 %, or 1 / tau in closed form from the
        /// mean residence time.
        bandwidth: Bandwidth = Bandwidth::RiseTime;
        /// Dead time of the rig; used by the residence time only.
        dead_time: Seconds = 0.1, 0.0..=100.0;
        /// How long the rig takes to answer to a change of power: its dead time and some four time constants. What is judged by
        /// heat and answers takes its times from it: 4 to 500 samples.
        answer_time: Seconds = 2.0, 0.1..=2500.0, limit above;
        /// A static gain beyond this size is not believed.
        gain_max: f32 = 2.0, 1e-3..=1e3, in "degC/%";
    }
}

/// How old data lose their weight.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "kebab-case", deny_unknown_fields)
)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Adaptation {
    /// Exponential forgetting; memory of about `1 / (1 - lambda)` samples.
    Forgetting {
        /// Forgetting factor, 0.5..=1.
        lambda: f32,
    },
    /// Kalman filter for parameters that walk at random.
    RandomWalk {
        /// Variance that each scaled parameter gains in a sample.
        r1: f32,
        /// Variance of the scaled measurement.
        r2: f32,
    },
}

/// How the bandwidth is read off the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Bandwidth {
    /// 3 / tr with the rise time to 95 % (paper, equation 11).
    RiseTime,
    /// 1 / tau with tau = Tres - L - Ts/2 from the mean residence time; a closed form.
    ResidenceTime,
}

/// Settings of one estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RlsConfig {
    /// How old data lose their weight.
    pub adaptation: Adaptation,
    /// D at the start and after a reset: the variance of a parameter nothing is known of.
    pub d_initial: f32,
    /// Cap on each element of D.
    pub d_max: f32,
}

impl IdentificationConfig {
    /// Checks every setting.
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        check(Self::SETTINGS[0], self)?;
        // The gain that the scales speak of must be believed, or nothing is ever learnt.
        let typical = self.y_scale.0 / self.u_scale.0;
        above("identification.gain_max", self.gain_max, "identification.y_scale / u_scale", typical)
    }

    /// Those of an estimator.
    pub(super) fn rls(&self) -> RlsConfig {
        RlsConfig { adaptation: self.adaptation, d_initial: self.d_initial, d_max: self.d_max }
    }
}

impl RlsConfig {
    /// Checks every setting.
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        let Self { adaptation, d_initial, d_max } = *self;
        let all = IdentificationConfig { adaptation, d_initial, d_max, ..IdentificationConfig::default() };
        check(IdentificationConfig::SETTINGS[0], &all)
    }
}

impl Field for Adaptation {
    fn value(&self) -> Value {
        match *self {
            Self::Forgetting { lambda } => Value::Choice { form: 0, numbers: [lambda, 0.0] },
            Self::RandomWalk { r1, r2 } => Value::Choice { form: 1, numbers: [r1, r2] },
        }
    }

    fn set(&mut self, value: Value) -> bool {
        *self = match value {
            Value::Choice { form: 0, numbers: [lambda, _] } => Self::Forgetting { lambda },
            Value::Choice { form: 1, numbers: [r1, r2] } => Self::RandomWalk { r1, r2 },
            _ => return false,
        };
        true
    }
}

impl FieldType for Adaptation {
    type Plain = Self;
    const KIND: Kind = Kind::Choice(&[
        Form {
            word: "forgetting",
            numbers: &[FormNumber {
                key: "lambda",
                name: "identification.adaptation.forgetting.lambda",
                min: 0.5,
                max: 1.0,
            }],
        },
        Form {
            word: "random-walk",
            numbers: &[
                FormNumber {
                    key: "r1",
                    name: "identification.adaptation.random-walk.r1",
                    min: 0.0,
                    max: 1.0,
                },
                FormNumber {
                    key: "r2",
                    name: "identification.adaptation.random-walk.r2",
                    min: 1e-9,
                    max: 1e6,
                },
            ],
        },
    ]);

    fn new(plain: Self) -> Self {
        plain
    }
}

impl Field for Bandwidth {
    fn value(&self) -> Value {
        Value::Choice { form: *self as usize, numbers: [0.0; 2] }
    }

    fn set(&mut self, value: Value) -> bool {
        *self = match value {
            Value::Choice { form: 0, .. } => Self::RiseTime,
            Value::Choice { form: 1, .. } => Self::ResidenceTime,
            _ => return false,
        };
        true
    }
}

impl FieldType for Bandwidth {
    type Plain = Self;
    const KIND: Kind = Kind::Choice(&[
        Form { word: "rise-time", numbers: &[] },
        Form { word: "residence-time", numbers: &[] },
    ]);

    fn new(plain: Self) -> Self {
        plain
    }
}
