//! What a setting is: its name, unit and bounds, and its value in a form that console, flash, files and documents share.
//!
//! A setting is declared once, with `settings!` (see declare.rs), in the file of the part that it belongs to. Everything that
//! handles settings reads [`crate::Config::settings`].
//!
//! ```
//! use fdi_core::settings::Value;
//! use fdi_core::{Config, Instrument};
//!
//! let mut config = Config::default();
//! let kp = Config::settings().find(|setting| setting.name == "pid.kp").expect("a setting");
//! assert_eq!((kp.unit, config.get(kp)), ("%/degC", Value::Number(config.pid.kp)));
//! assert!(config.set(kp, Value::Number(1e9)));
//! let error = Instrument::new(&config).err().expect("out of bounds");
//! assert!(error.to_string().starts_with("pid.kp"));
//! ```

mod declare;

pub(crate) use declare::settings;

use crate::error::{ConfigError, in_range};

/// What is known of a setting but for its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Name, as in `pid.kp`.
    pub name: &'static str,
    /// Number that stands for it where it is kept as bytes. It is made from the first name that the setting had, so that
    /// what was saved under that name is still found.
    pub id: u16,
    /// Unit; empty for plain numbers and words.
    pub unit: &'static str,
    /// What its value can be.
    pub kind: Kind,
    /// Where its value lies: in which group, and where in that.
    pub(crate) group: Group,
    pub(crate) index: u8,
    /// Where a protection rests on it: which way it gets wider.
    pub limit: Option<Limit>,
}

/// What makes a setting a limit. It is not widened while the heater is on, and told where it is wider than the default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// On which side of a value a wider one lies.
    pub wider: Wider,
    /// The default; of a switch 1 for on.
    pub default: f32,
    /// A time is at most so many `identification.answer_time`; 0 where that does not bound it.
    pub answers: u8,
}

/// On which side of a value a wider one lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wider {
    /// Larger values are wider, or a switch that is on.
    Above,
    /// Smaller values are wider, or a switch that is off.
    Below,
}

impl Limit {
    /// Whether `new` is wider than `now`, by the numbers of [`Value::number`].
    pub(crate) fn is_widened(&self, now: f32, new: f32) -> bool {
        match self.wider {
            Wider::Above => new > now,
            Wider::Below => new < now,
        }
    }
}

/// What only people read of a setting.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// What it is: the lines of its documentation.
    pub text: &'static str,
    /// The name that it once had.
    pub was: Option<&'static str>,
}

/// What a value can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number with decimals.
    Number {
        /// Smallest value, allowed.
        min: f32,
        /// Largest value, allowed.
        max: f32,
    },
    /// A whole number.
    Whole {
        /// Smallest value, allowed.
        min: u16,
        /// Largest value, allowed.
        max: u16,
    },
    /// On or off.
    Switch,
    /// One of several forms.
    Choice(&'static [Form]),
}

/// One form of a [`Kind::Choice`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form {
    /// The word for it.
    pub word: &'static str,
    /// The numbers that belong to it, at most two.
    pub numbers: &'static [FormNumber],
}

/// A number of a [`Form`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormNumber {
    /// Its name, as in `lambda`.
    pub key: &'static str,
    /// Its whole name, for errors.
    pub name: &'static str,
    /// Smallest value, allowed.
    pub min: f32,
    /// Largest value, allowed.
    pub max: f32,
}

/// A value of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Of a [`Kind::Number`], in the unit of the setting.
    Number(f32),
    /// Of a [`Kind::Whole`].
    Whole(u16),
    /// Of a [`Kind::Switch`].
    Switch(bool),
    /// Of a [`Kind::Choice`].
    Choice {
        /// Which form, counted from 0.
        form: usize,
        /// Its numbers; those that it does not have are 0.
        numbers: [f32; 2],
    },
}

impl Value {
    /// It as a number; of a switch 1 for on, of a choice its place.
    pub(crate) fn number(self) -> f32 {
        match self {
            Self::Number(x) => x,
            Self::Whole(n) => n.into(),
            Self::Switch(on) => on.into(),
            Self::Choice { form, .. } => form as f32,
        }
    }
}

impl Kind {
    /// Smallest and largest value, both allowed; `None` for what is no number.
    pub fn bounds(self) -> Option<(f32, f32)> {
        match self {
            Self::Number { min, max } => Some((min, max)),
            Self::Whole { min, max } => Some((min.into(), max.into())),
            Self::Switch | Self::Choice(_) => None,
        }
    }

    /// The same with the bounds of a declaration.
    pub(crate) const fn within(self, min: f32, max: f32) -> Self {
        match self {
            Self::Number { .. } => Self::Number { min, max },
            Self::Whole { .. } => Self::Whole { min: min as u16, max: max as u16 },
            other => other,
        }
    }
}

impl Setting {
    /// Checks a value against the bounds.
    ///
    /// # Errors
    /// Name, value and bounds of the number that is out of bounds.
    pub fn check(&self, value: Value) -> Result<(), ConfigError> {
        match (value, self.kind) {
            (Value::Number(x), Kind::Number { min, max }) => in_range(self.name, x, min, max),
            (Value::Whole(x), Kind::Whole { min, max }) => {
                in_range(self.name, x.into(), min.into(), max.into())
            }
            (Value::Choice { form, numbers }, Kind::Choice(forms)) => {
                let wanted = forms.get(form).map_or(&[][..], |form| form.numbers);
                wanted.iter().zip(numbers).try_for_each(|(n, x)| in_range(n.name, x, n.min, n.max))
            }
            _ => Ok(()),
        }
    }
}

/// A group of settings: the part of the configuration that they belong to, in the order in which they are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Group {
    /// What every part uses.
    General,
    /// Thermistor T0.
    T0,
    /// Thermistor T1.
    T1,
    /// Thermistor T2.
    T2,
    /// Supply voltage of the heater.
    Supply,
    /// Plausibility of readings.
    Plausibility,
    /// Temperature controller.
    Pid,
    /// Excitation.
    Prbs,
    /// ARX models.
    Identification,
    /// Residuals, thresholds, signatures.
    Diagnosis,
    /// Likelihood diagnosis.
    Likelihood,
    /// Modes and trips.
    Supervisor,
}

/// A field that is a setting.
pub(crate) trait Field {
    /// Its value.
    fn value(&self) -> Value;
    /// Takes over a value; `false` where it is of another kind, and nothing has changed then.
    fn set(&mut self, value: Value) -> bool;
}

/// A type that a setting can have.
pub(crate) trait FieldType: Field + Sized {
    /// How a declaration writes its value.
    type Plain;
    /// Its unit; empty where it has none.
    const UNIT: &'static str = "";
    /// What its values can be.
    const KIND: Kind;
    /// The value that a declaration writes.
    fn new(plain: Self::Plain) -> Self;
}

/// A struct whose fields are settings.
pub(crate) trait Fields {
    /// The field at a place of its group; `None` beyond the last.
    fn field(&self, index: usize) -> Option<&dyn Field>;
    /// The same, to be set.
    fn field_mut(&mut self, index: usize) -> Option<&mut dyn Field>;
}

/// Checks every setting of a group.
#[inline(never)]
pub(crate) fn check(settings: &[Setting], fields: &dyn Fields) -> Result<(), ConfigError> {
    settings.iter().try_for_each(|setting| match fields.field(setting.index.into()) {
        Some(field) => setting.check(field.value()),
        None => Ok(()),
    })
}

/// The id that a name gives: FNV-1a, folded to 16 bits.
pub(crate) const fn id(name: &str) -> u16 {
    let (name, mut hash, mut i) = (name.as_bytes(), 0x811C_9DC5u32, 0);
    while i < name.len() {
        hash = (hash ^ name[i] as u32).wrapping_mul(0x0100_0193);
        i += 1;
    }
    (hash ^ hash >> 16) as u16
}

/// The field types that are one plain value: how it is read and written.
macro_rules! plain {
    ($Type:ty, $kind:expr, $variant:ident) => {
        impl Field for $Type {
            fn value(&self) -> Value {
                Value::$variant((*self).into())
            }

            fn set(&mut self, value: Value) -> bool {
                let Value::$variant(x) = value else { return false };
                x.try_into().map(|x| *self = x).is_ok()
            }
        }

        impl FieldType for $Type {
            type Plain = Self;
            const KIND: Kind = $kind;

            fn new(plain: Self) -> Self {
                plain
            }
        }
    };
}

plain!(f32, Kind::Number { min: f32::MIN, max: f32::MAX }, Number);
plain!(u8, Kind::Whole { min: 0, max: u8::MAX as u16 }, Whole);
plain!(u16, Kind::Whole { min: 0, max: u16::MAX }, Whole);
plain!(bool, Kind::Switch, Switch);
