//! The names of the settings, as in the TOML file of the host, and how each is read and written as text.

use core::fmt;

use fdi_core::Config;
use fdi_core::diagnosis::signature::{MAX_ROWS, PatternError};
use fdi_core::identify::observer::Bandwidth;
use fdi_core::identify::rls::Adaptation;

use super::table::{Table, set_row};
use crate::decimal::{self, Short};

/// Where a setting lies within a configuration.
enum Slot<'a> {
    Float(&'a mut f32),
    Byte(&'a mut u8),
    Word(&'a mut u16),
    Switch(&'a mut bool),
    Bandwidth(&'a mut Bandwidth),
    Adaptation(&'a mut Adaptation),
}

/// One setting that has one value.
pub struct Entry {
    /// Its name.
    pub name: &'static str,
    /// Its unit; empty for plain numbers and words.
    pub unit: &'static str,
    slot: fn(&mut Config) -> Slot<'_>,
}

macro_rules! entries {
    ($($kind:ident $name:literal $unit:literal $($field:tt).+;)*) => {
        &[$(Entry { name: $name, unit: $unit, slot: |c| Slot::$kind(&mut c.$($field).+) }),*]
    };
}

/// All settings with one value. The rows of the two signature tables come on top, see [`Name`].
#[rustfmt::skip]
pub const ENTRIES: &[Entry] = entries! {
    Float "sample_time" "s" sample_time.0;
    Float "setpoint" "degC" setpoint.0;
    Float "sensors.t0.r25" "ohm" sensors.t0.r25.0;
    Float "sensors.t0.beta" "K" sensors.t0.beta;
    Float "sensors.t0.pull_up" "ohm" sensors.t0.pull_up.0;
    Float "sensors.t0.gain" "" sensors.t0.gain;
    Float "sensors.t0.offset" "degC" sensors.t0.offset.0;
    Float "sensors.t1.r25" "ohm" sensors.t1.r25.0;
    Float "sensors.t1.beta" "K" sensors.t1.beta;
    Float "sensors.t1.pull_up" "ohm" sensors.t1.pull_up.0;
    Float "sensors.t1.gain" "" sensors.t1.gain;
    Float "sensors.t1.offset" "degC" sensors.t1.offset.0;
    Float "sensors.t2.r25" "ohm" sensors.t2.r25.0;
    Float "sensors.t2.beta" "K" sensors.t2.beta;
    Float "sensors.t2.pull_up" "ohm" sensors.t2.pull_up.0;
    Float "sensors.t2.gain" "" sensors.t2.gain;
    Float "sensors.t2.offset" "degC" sensors.t2.offset.0;
    Float "plausibility.open_code" "counts" plausibility.open_code.0;
    Float "plausibility.short_code" "counts" plausibility.short_code.0;
    Float "plausibility.min" "degC" plausibility.min.0;
    Float "plausibility.max" "degC" plausibility.max.0;
    Float "plausibility.jump" "degC" plausibility.jump.0;
    Float "plausibility.stuck_time" "s" plausibility.stuck_time.0;
    Float "plausibility.ambient_stuck_time" "s" plausibility.ambient_stuck_time.0;
    Float "plausibility.stuck_band" "counts" plausibility.stuck_band.0;
    Float "pid.kp" "%/degC" pid.kp;
    Float "pid.ti" "s" pid.ti.0;
    Float "pid.td" "s" pid.td.0;
    Float "pid.output_min" "%" pid.output_min.0;
    Float "pid.output_max" "%" pid.output_max.0;
    Byte "prbs.bits" "" prbs.bits;
    Byte "prbs.samples_per_bit" "" prbs.samples_per_bit;
    Float "prbs.amplitude" "%" prbs.amplitude.0;
    Word "prbs.start" "" prbs.start;
    Adaptation "identification.adaptation" "" identification.adaptation;
    Float "identification.d_initial" "" identification.d_initial;
    Float "identification.d_max" "" identification.d_max;
    Float "identification.y_scale" "degC" identification.y_scale.0;
    Float "identification.u_scale" "%" identification.u_scale.0;
    Bandwidth "identification.bandwidth" "" identification.bandwidth;
    Float "identification.dead_time" "s" identification.dead_time.0;
    Float "identification.gain_max" "degC/%" identification.gain_max;
    Float "diagnosis.filter_cutoff" "rad/s" diagnosis.filter_cutoff;
    Float "diagnosis.sigma_factor" "" diagnosis.sigma_factor;
    Float "diagnosis.onset_window" "s" diagnosis.onset_window.0;
    Float "diagnosis.clear_time" "s" diagnosis.clear_time.0;
    Float "likelihood.fit_time" "s" likelihood.fit_time.0;
    Float "likelihood.check_time" "s" likelihood.check_time.0;
    Float "likelihood.fast_slack" "" likelihood.fast_slack;
    Float "likelihood.fast_limit" "" likelihood.fast_limit;
    Float "likelihood.slow_slack" "" likelihood.slow_slack;
    Float "likelihood.slow_limit" "" likelihood.slow_limit;
    Float "likelihood.mean_time" "s" likelihood.mean_time.0;
    Float "likelihood.model_uncertainty" "" likelihood.model_uncertainty;
    Float "likelihood.tolerated_sag" "" likelihood.tolerated_sag;
    Float "likelihood.margin" "" likelihood.margin;
    Float "likelihood.power_margin" "" likelihood.power_margin;
    Float "supervisor.learn_start" "s" supervisor.learn_start.0;
    Float "supervisor.learn_end" "s" supervisor.learn_end.0;
    Float "supervisor.regulation_band" "%" supervisor.regulation_band.0;
    Float "supervisor.regulation_time" "s" supervisor.regulation_time.0;
    Float "supervisor.min_excitation" "%" supervisor.min_excitation.0;
    Float "supervisor.over_temperature" "degC" supervisor.over_temperature.0;
    Float "supervisor.signal_timeout" "s" supervisor.signal_timeout.0;
    Float "supervisor.response_time" "s" supervisor.response_time.0;
    Float "supervisor.min_response" "degC" supervisor.min_response.0;
    Float "supervisor.max_excess_power" "%" supervisor.max_excess_power.0;
    Float "supervisor.excess_power_time" "s" supervisor.excess_power_time.0;
    Float "supervisor.max_disagreement" "degC" supervisor.max_disagreement.0;
    Float "supervisor.disagreement_time" "s" supervisor.disagreement_time.0;
    Float "supervisor.cooling_time" "s" supervisor.cooling_time.0;
    Switch "supervisor.go_on_without_t1" "" supervisor.go_on_without_t1;
    Float "supervisor.min_air_flow" "%" supervisor.min_air_flow.0;
    Switch "supervisor.check_before_arming" "" supervisor.check_before_arming;
    Float "supervisor.setpoint_min" "degC" supervisor.setpoint_min.0;
    Float "supervisor.setpoint_max" "degC" supervisor.setpoint_max.0;
};

/// A value as it is kept: two words, so that an adaptation fits.
pub type Bits = [u32; 2];

/// In the second word where one is enough.
const UNUSED: u32 = u32::MAX;

impl Entry {
    /// A number that stands for the name in flash.
    pub const fn id(&self) -> u16 {
        let (name, mut hash, mut i) = (self.name.as_bytes(), 0x811C_9DC5u32, 0);
        while i < name.len() {
            hash = (hash ^ name[i] as u32).wrapping_mul(0x0100_0193); // FNV-1a
            i += 1;
        }
        (hash ^ hash >> 16) as u16
    }

    /// The value as it is kept.
    pub fn bits(&self, config: &mut Config) -> Bits {
        match (self.slot)(config) {
            Slot::Float(x) => [x.to_bits(), UNUSED],
            Slot::Byte(x) => [u32::from(*x), UNUSED],
            Slot::Word(x) => [u32::from(*x), UNUSED],
            Slot::Switch(x) => [u32::from(*x), UNUSED],
            Slot::Bandwidth(Bandwidth::RiseTime) => [0, UNUSED],
            Slot::Bandwidth(Bandwidth::ResidenceTime) => [1, UNUSED],
            Slot::Adaptation(Adaptation::Forgetting { lambda }) => [lambda.to_bits(), UNUSED],
            Slot::Adaptation(Adaptation::RandomWalk { r1, r2 }) => [r1.to_bits(), r2.to_bits()],
        }
    }

    /// Takes over a value that was kept; nonsense ends up out of bounds and is refused by the core.
    pub fn set_bits(&self, config: &mut Config, bits: Bits) {
        let [first, second] = bits.map(f32::from_bits);
        match (self.slot)(config) {
            Slot::Float(x) => *x = first,
            Slot::Byte(x) => *x = bits[0] as u8,
            Slot::Word(x) => *x = bits[0] as u16,
            Slot::Switch(x) => *x = bits[0] == 1,
            Slot::Bandwidth(x) if bits[0] == 0 => *x = Bandwidth::RiseTime,
            Slot::Bandwidth(x) => *x = Bandwidth::ResidenceTime,
            Slot::Adaptation(x) if bits[1] == UNUSED => *x = Adaptation::Forgetting { lambda: first },
            Slot::Adaptation(x) => *x = Adaptation::RandomWalk { r1: first, r2: second },
        }
    }
}

const _: () = assert!(ids_differ(), "two settings have the same id: rename one");

const fn ids_differ() -> bool {
    let mut i = 0;
    while i < ENTRIES.len() {
        let mut j = i + 1;
        while j < ENTRIES.len() {
            if ENTRIES[i].id() == ENTRIES[j].id() {
                return false;
            }
            j += 1;
        }
        i += 1;
    }
    true
}

/// The name of a setting, resolved.
#[derive(Clone, Copy)]
pub enum Name {
    /// An entry of [`ENTRIES`].
    Entry(&'static Entry),
    /// Row of a table, from 0; written from 1 on, as in `diagnosis.isolation.1`.
    Row(Table, usize),
}

/// Why a setting was not taken over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetError<'a> {
    /// No setting of this name.
    Unknown(&'a str),
    /// The text is no value of this kind.
    Value {
        /// The setting.
        name: &'a str,
        /// What was given.
        given: &'a str,
        /// What would have been accepted.
        expected: &'static str,
    },
    /// The text is no pattern.
    Pattern {
        /// The setting.
        name: &'a str,
        /// Why.
        error: PatternError,
    },
    /// A row can be added only behind the last.
    Gap {
        /// The setting.
        name: &'a str,
        /// Rows that the table has.
        rows: usize,
    },
}

impl fmt::Display for SetError<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(name) => write!(f, "no setting \"{name}\", see `get`"),
            Self::Value { name, given, expected } => {
                write!(f, "{name}: \"{given}\" given, expected {expected}")
            }
            Self::Pattern { name, error } => write!(f, "{name}: {error}, or `none`"),
            Self::Gap { name, rows } => {
                write!(f, "{name}: the table has {rows} rows, expected a row from 1 to {}", rows + 1)
            }
        }
    }
}

impl Name {
    /// Looks up a whole name.
    ///
    /// # Errors
    /// [`SetError::Unknown`].
    pub fn find(name: &str) -> Result<Self, SetError<'_>> {
        if let Some(entry) = ENTRIES.iter().find(|entry| entry.name == name) {
            return Ok(Self::Entry(entry));
        }
        Table::ALL
            .into_iter()
            .find_map(|(table, start)| {
                let row: usize = name.strip_prefix(start)?.parse().ok()?;
                (1..=MAX_ROWS).contains(&row).then(|| Self::Row(table, row - 1))
            })
            .ok_or(SetError::Unknown(name))
    }

    /// All names that have a value in `config`.
    pub fn all(config: &Config) -> impl Iterator<Item = Self> {
        let rows = |table: Table| (0..table.rows(config).len()).map(move |row| Self::Row(table, row));
        let rows = rows(Table::Detection).chain(rows(Table::Isolation));
        ENTRIES.iter().map(Self::Entry).chain(rows)
    }

    /// Whether the name begins so.
    pub fn starts_with(&self, beginning: &str) -> bool {
        match self {
            Self::Entry(entry) => entry.name.starts_with(beginning),
            Self::Row(table, _) => {
                Table::ALL.iter().any(|(t, start)| t == table && start.starts_with(beginning))
            }
        }
    }

    /// Whether the value is the same in both configurations.
    pub fn same(&self, a: &mut Config, b: &mut Config) -> bool {
        match self {
            Self::Entry(entry) => entry.bits(a) == entry.bits(b),
            Self::Row(table, row) => table.rows(a).get(*row) == table.rows(b).get(*row),
        }
    }

    /// The value as text.
    pub fn value<'a>(&self, config: &'a Config) -> Value<'a> {
        Value { name: *self, config }
    }

    /// Writes a value into a configuration; whether it is in bounds is for the core to judge.
    ///
    /// # Errors
    /// What was expected instead.
    pub fn set<'a>(&self, config: &mut Config, name: &'a str, text: &'a str) -> Result<(), SetError<'a>> {
        let entry = match self {
            Self::Entry(entry) => entry,
            Self::Row(table, row) => return set_row(table.rows_mut(config), *row, name, text),
        };
        let expected = |expected| SetError::Value { name, given: text, expected };
        match (entry.slot)(config) {
            Slot::Float(x) => *x = decimal::parse(text).ok_or_else(|| expected(decimal::EXPECTED))?,
            Slot::Byte(x) => *x = text.parse().map_err(|_| expected("a whole number up to 255"))?,
            Slot::Word(x) => *x = text.parse().map_err(|_| expected("a whole number up to 65535"))?,
            Slot::Switch(x) => *x = text.parse().map_err(|_| expected("true or false"))?,
            Slot::Bandwidth(x) => {
                *x = match text {
                    "rise-time" => Bandwidth::RiseTime,
                    "residence-time" => Bandwidth::ResidenceTime,
                    _ => return Err(expected("rise-time or residence-time")),
                }
            }
            Slot::Adaptation(x) => {
                *x = adaptation(text).ok_or_else(|| expected("forgetting LAMBDA or random-walk R1 R2"))?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Entry(entry) => f.write_str(entry.name),
            Self::Row(table, row) => {
                let (_, start) = Table::ALL[*table as usize];
                write!(f, "{start}{}", row + 1)
            }
        }
    }
}

/// A value with its unit, as text.
pub struct Value<'a> {
    name: Name,
    config: &'a Config,
}

impl fmt::Display for Value<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let entry = match self.name {
            Name::Entry(entry) => entry,
            Name::Row(table, row) => {
                return match table.rows(self.config).get(row) {
                    Some(signature) => write!(f, "{} {}", signature.number, signature.pattern),
                    None => f.write_str("none"),
                };
            }
        };
        // The table holds one function an entry, to a place that can be written; reading goes by way of a copy.
        let mut copy = self.config.clone();
        match (entry.slot)(&mut copy) {
            Slot::Float(x) => Short(*x).fmt(f)?,
            Slot::Byte(x) => write!(f, "{x}")?,
            Slot::Word(x) => write!(f, "{x}")?,
            Slot::Switch(x) => f.write_str(if *x { "true" } else { "false" })?,
            Slot::Bandwidth(Bandwidth::RiseTime) => f.write_str("rise-time")?,
            Slot::Bandwidth(Bandwidth::ResidenceTime) => f.write_str("residence-time")?,
            Slot::Adaptation(Adaptation::Forgetting { lambda }) => {
                write!(f, "forgetting {}", Short(*lambda))?
            }
            Slot::Adaptation(Adaptation::RandomWalk { r1, r2 }) => {
                write!(f, "random-walk {} {}", Short(*r1), Short(*r2))?
            }
        }
        if entry.unit.is_empty() { Ok(()) } else { write!(f, " {}", entry.unit) }
    }
}

fn adaptation(text: &str) -> Option<Adaptation> {
    let mut words = text.split_ascii_whitespace();
    let adaptation = match words.next()? {
        "forgetting" => Adaptation::Forgetting { lambda: decimal::parse(words.next()?)? },
        "random-walk" => {
            Adaptation::RandomWalk { r1: decimal::parse(words.next()?)?, r2: decimal::parse(words.next()?)? }
        }
        _ => return None,
    };
    words.next().is_none().then_some(adaptation)
}
