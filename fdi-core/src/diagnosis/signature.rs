//! Symptoms and signature tables (paper, sections 3.3 and 3.4): which pattern of deviations means which fault.
//!
//! The tables are data. The paper's own are constants, checked at compile time; a user's come from the configuration
//! and are checked when the instrument is built.
//!
//! ```
//! use fdi_core::diagnosis::baseline::Normal;
//! use fdi_core::diagnosis::signature::{PAPER_ISOLATION, Table, symptoms};
//!
//! // Features in the order of `residual::ALL`: T2 reads too high, so that y1 - y2 falls and the gain of MS2 rises.
//! let normal = Normal { mean: [0.0, 0.0, 40.0, 1.0, 0.3, 0.28, 2.0], sigma: [0.1, 0.1, 1.0, 0.1, 0.01, 0.01, 0.2] };
//! let features = [0.0, 0.0, 40.5, -0.5, 0.3, 0.35, 2.1];
//! let symptoms = symptoms(&features, &normal, 3.0);
//! assert_eq!(symptoms.map(|symptom| symptom.sign()), [0, -1, 0, 1, 0]);
//! assert_eq!(Table::new(&PAPER_ISOLATION).look_up(&symptoms), [1, 0]); // AFS2, and none of a user's own
//! ```

use core::fmt;

use super::baseline::Normal;
use super::residual::{DECISIVE, FIRST_DECISIVE, RESIDUALS};
use crate::error::ConfigError;
use crate::name::Name;

/// Number of residuals in a signature.
pub const WIDTH: usize = DECISIVE.len();

/// Rows that a table can hold: the paper's, and ten faults of the user's own.
pub const MAX_ROWS: usize = 13;

/// How a residual compares with its thresholds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Symptom {
    /// Below the lower threshold, -1.
    Low,
    /// Within, 0.
    #[default]
    Normal,
    /// Above the upper threshold, +1.
    High,
}

impl Symptom {
    /// -1, 0 or +1.
    pub fn sign(self) -> i8 {
        match self {
            Self::Low => -1,
            Self::Normal => 0,
            Self::High => 1,
        }
    }
}

/// Symptoms of the decisive residuals, in the order of [`DECISIVE`].
pub type Symptoms = [Symptom; WIDTH];

/// Compares features with mean plus and minus `factor` standard deviations.
#[inline]
pub fn symptoms(features: &[f32; RESIDUALS], normal: &Normal, factor: f32) -> Symptoms {
    core::array::from_fn(|i| {
        let i = FIRST_DECISIVE + i;
        let deviation = features[i] - normal.mean[i];
        let threshold = factor * normal.sigma[i];
        match (deviation.abs() > threshold, deviation.is_sign_negative()) {
            (false, _) => Symptom::Normal,
            (true, false) => Symptom::High,
            (true, true) => Symptom::Low,
        }
    })
}

/// What a signature asks of one residual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Cell {
    /// Exactly this symptom.
    Is(Symptom),
    /// Any symptom, the paper's x.
    Any,
}

/// A pattern of symptoms; written as five of `-1 0 +1 x`, separated by blanks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pattern(pub [Cell; WIDTH]);

/// A row of a table: the number that it gives and the pattern that gives it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Signature {
    /// Number shown in fdv or fiv; 1 or more.
    pub number: u8,
    /// Pattern over {rAP, ry12, rsg1, rsg2, rbw1}.
    pub pattern: Pattern,
    /// What the user calls it; the paper's rows have no name of their own.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Name::is_empty"))]
    pub name: Name,
}

/// A table of signatures as a configuration holds it.
pub type Rows = heapless::Vec<Signature, MAX_ROWS>;

const LOW: Cell = Cell::Is(Symptom::Low);
const ZERO: Cell = Cell::Is(Symptom::Normal);
const HIGH: Cell = Cell::Is(Symptom::High);
const X: Cell = Cell::Any;

const fn row(number: u8, cells: [Cell; WIDTH]) -> Signature {
    Signature { number, pattern: Pattern(cells), name: Name::NONE }
}

/// Fault detection, fdv: 1 additive fault on T2; 2 multiplicative fault on T1 or the process. Where both match, the
/// later row is the answer: the paper does not say which, and the multiplicative one is the graver.
pub const PAPER_DETECTION: [Signature; 2] = [row(1, [X, LOW, X, HIGH, X]), row(2, [HIGH, X, LOW, X, X])];

/// Fault isolation, fiv: 1 AFS2, 2 MFS1, 3 MFP.
pub const PAPER_ISOLATION: [Signature; 3] = [
    row(1, [ZERO, LOW, ZERO, HIGH, ZERO]),
    row(2, [HIGH, X, LOW, ZERO, LOW]),
    row(3, [HIGH, ZERO, LOW, X, HIGH]),
];

const _: () = assert!(first_overlap(&PAPER_ISOLATION).is_none(), "two faults share a signature");
const _: () = assert!(numbers_are_set(&PAPER_DETECTION) && numbers_are_set(&PAPER_ISOLATION));

impl Pattern {
    /// Whether the symptoms fit.
    pub fn matches(&self, symptoms: &Symptoms) -> bool {
        self.0.iter().zip(symptoms).all(|(cell, symptom)| match cell {
            Cell::Is(wanted) => wanted == symptom,
            Cell::Any => true,
        })
    }

    /// Whether some vector of symptoms fits both patterns.
    pub const fn overlaps(&self, other: &Pattern) -> bool {
        let mut i = 0;
        while i < WIDTH {
            if let (Cell::Is(a), Cell::Is(b)) = (self.0[i], other.0[i])
                && a as u8 != b as u8
            {
                return false;
            }
            i += 1;
        }
        true
    }
}

/// The first two rows that one vector of symptoms can match.
const fn first_overlap(rows: &[Signature]) -> Option<(usize, usize)> {
    let mut i = 0;
    while i < rows.len() {
        let mut j = i + 1;
        while j < rows.len() {
            if rows[i].pattern.overlaps(&rows[j].pattern) {
                return Some((i, j));
            }
            j += 1;
        }
        i += 1;
    }
    None
}

const fn numbers_are_set(rows: &[Signature]) -> bool {
    let mut i = 0;
    while i < rows.len() {
        if rows[i].number == 0 {
            return false;
        }
        i += 1;
    }
    true
}

/// Vectors of symptoms that there are.
const VECTORS: usize = 3usize.pow(WIDTH as u32);

/// The place of a vector of symptoms among all: its digits in base 3, the first lowest.
#[inline]
fn place(symptoms: &Symptoms) -> usize {
    symptoms.iter().rev().fold(0, |place, &symptom| 3 * place + symptom as usize)
}

const _: () = assert!(MAX_ROWS < 16, "a row takes half a byte");

/// A table ready to be looked up in: the answers to every vector of symptoms, whatever the rows ask for.
#[derive(Clone, Debug)]
pub struct Table {
    /// Of each row, counted from 1.
    numbers: [u8; MAX_ROWS + 1],
    /// The last row that matches and has no name, and in the upper half of the byte the last that has one.
    rows: [u8; VECTORS],
}

impl Table {
    /// Works out every answer; of more rows than there is room for, the first count.
    pub fn new(rows: &[Signature]) -> Self {
        const ALL: [Symptom; 3] = [Symptom::Low, Symptom::Normal, Symptom::High];
        let mut table = Self { numbers: [0; MAX_ROWS + 1], rows: [0; VECTORS] };
        let rows = || (1..=MAX_ROWS).zip(rows);
        rows().for_each(|(i, row)| table.numbers[i] = row.number);
        for (place, found) in table.rows.iter_mut().enumerate() {
            let mut rest = place;
            let symptoms = core::array::from_fn(|_| {
                let symptom = ALL[rest % ALL.len()];
                rest /= ALL.len();
                symptom
            });
            for (i, row) in rows().filter(|(_, row)| row.pattern.matches(&symptoms)) {
                *found = if row.name.is_empty() {
                    *found & 0xF0 | i as u8
                } else {
                    *found & 0x0F | (i as u8) << 4
                };
            }
        }
        table
    }

    /// The numbers of the last row that matches and has no name, and of the last that has one; 0 where there is none.
    #[inline]
    pub fn look_up(&self, symptoms: &Symptoms) -> [u8; 2] {
        let found = self.rows.get(place(symptoms)).copied().unwrap_or(0);
        [found & 0x0F, found >> 4].map(|row| self.numbers.get(usize::from(row)).copied().unwrap_or(0))
    }
}

/// Checks that each row has a number, and where it matters that no two rows can match at once.
pub(crate) fn validate(name: &'static str, rows: &[Signature], disjoint: bool) -> Result<(), ConfigError> {
    if !numbers_are_set(rows) {
        return Err(ConfigError::OutOfRange { name, value: 0.0, min: 1.0, max: 255.0 });
    }
    match first_overlap(rows) {
        Some((first, second)) if disjoint => Err(ConfigError::AmbiguousRows { name, first, second }),
        _ => Ok(()),
    }
}

impl fmt::Display for Pattern {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, cell) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_str(" ")?;
            }
            f.write_str(match cell {
                Cell::Is(Symptom::Low) => "-1",
                Cell::Is(Symptom::Normal) => "0",
                Cell::Is(Symptom::High) => "+1",
                Cell::Any => "x",
            })?;
        }
        Ok(())
    }
}

/// Why a text is no [`Pattern`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PatternError;

impl fmt::Display for PatternError {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("expected five of -1, 0, +1, x for {rAP ry12 rsg1 rsg2 rbw1}, such as \"x -1 x +1 x\"")
    }
}

impl core::error::Error for PatternError {}

impl core::str::FromStr for Pattern {
    type Err = PatternError;

    #[inline]
    fn from_str(text: &str) -> Result<Self, PatternError> {
        let mut cells = [X; WIDTH];
        let mut words = text.split_ascii_whitespace();
        for cell in &mut cells {
            *cell = match words.next().ok_or(PatternError)? {
                "-1" => LOW,
                "0" => ZERO,
                "+1" | "1" => HIGH,
                "x" | "X" => X,
                _ => return Err(PatternError),
            };
        }
        if words.next().is_some() { Err(PatternError) } else { Ok(Self(cells)) }
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Pattern {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Pattern {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text;
        impl serde::de::Visitor<'_> for Text {
            type Value = Pattern;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Display::fmt(&PatternError, f)
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Pattern, E> {
                text.parse().map_err(|_| E::invalid_value(serde::de::Unexpected::Str(text), &self))
            }
        }
        deserializer.deserialize_str(Text)
    }
}
