//! What is kept in flash, as bytes: a version, the settings each with its id, the signature tables,
//! the baseline, and a CRC over all of it.
//!
//! ```text
//! version u8 | settings u8 | (id u16, bits 2 x u32) .. | detection rows u8 | (number u8, cells 5 x u8) .. |
//! isolation rows u8 | .. | baseline 0 or 1 | samples u32, 28 x f32 |
//! (0 detection or 1 isolation, row u8, name 12 x u8) .. | (2, length u8, name 12 x u8, effects 11 x i16) .. | CRC-32
//! ```
//!
//! The names of rows and what a user has taught come last, and only those that there are. From 2 on each has its length, and what a program does not know it passes
//! over. One from before faults could be taught takes a record with some for cut short, and says so.
//! Since each setting carries its id, a newer program that has more settings, or fewer, reads what an older one saved:
//! an update does not lose the calibration of a rig. All numbers are little-endian.

use core::fmt;

use fdi_core::control::Controller;
use fdi_core::diagnosis::Diagnosis;
use fdi_core::diagnosis::baseline::{Baseline, Normal};
use fdi_core::diagnosis::signature::{Cell, Pattern, Rows, Signature, Symptom};
use fdi_core::likelihood::taught::{EFFECTS, Response};
use fdi_core::name::{NAME_BYTES, Name};
use fdi_core::{Config, ConfigError, Setting};

use super::bits;
use super::table::Table;
use crate::cadence::SAMPLE_TIMES;
use crate::crc::CRC32;
use crate::explain::Explained;

/// Bytes that the longest record may take.
pub const MAX_BYTES: usize = 1824;
/// Changes when the layout does, not when settings come or go.
pub const VERSION: u8 = 1;
/// What begins a response; 0 and 1 begin the name of a row.
const TAUGHT: u8 = 2;

/// What is kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stored {
    /// All settings.
    pub config: Config,
    /// What was learnt as normal under them.
    pub baseline: Option<Baseline>,
}

/// Why a record is not used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StoredError {
    /// It ends before its content does.
    Short,
    /// The CRC does not fit.
    Damaged,
    /// Another layout.
    Version(u8),
    /// Settings out of bounds, which a newer core may have narrowed.
    Invalid(ConfigError),
    /// Longer than [`MAX_BYTES`].
    TooLong,
}

impl fmt::Display for StoredError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short => f.write_str("record is cut short"),
            Self::Damaged => f.write_str("record is damaged (CRC)"),
            Self::Version(found) => {
                write!(f, "record has version {}, expected {}", u32::from(*found), u32::from(VERSION))
            }
            Self::Invalid(error) => write!(f, "record is invalid: {}", Explained(error)),
            Self::TooLong => write!(f, "record is longer than {MAX_BYTES} bytes"),
        }
    }
}

/// Checks that a board can run with these settings.
///
/// # Errors
/// The first parameter that is out of bounds.
pub fn check(config: &Config) -> Result<(), ConfigError> {
    let (value, [min, max]) = (config.sample_time.0, SAMPLE_TIMES);
    if !(value >= min && value <= max) {
        return Err(ConfigError::OutOfRange { name: "sample_time", value, min, max });
    }
    config.validate_times()?;
    // One half after the other, so that only one lies on the stack.
    Controller::new(config).map(drop)?;
    Diagnosis::new(config).map(drop)
}

impl Stored {
    /// Writes the record into `buffer` and returns the part of it that is used.
    ///
    /// # Errors
    /// [`StoredError::TooLong`].
    pub fn encode<'a>(&self, buffer: &'a mut [u8]) -> Result<&'a [u8], StoredError> {
        let mut out = Writer { buffer, length: 0 };
        let config = &self.config;
        out.bytes(&[VERSION, Config::settings().count() as u8])?;
        for setting in Config::settings() {
            out.bytes(&setting.id.to_le_bytes())?;
            let words = bits::bits(setting.kind, config.get(setting));
            words.iter().try_for_each(|word| out.bytes(&word.to_le_bytes()))?;
        }
        for table in [Table::Detection, Table::Isolation] {
            encode_rows(&mut out, table.rows(config))?;
        }
        out.bytes(&[u8::from(self.baseline.is_some())])?;
        if let Some(baseline) = &self.baseline {
            out.bytes(&baseline.samples.to_le_bytes())?;
            let Baseline { raw, filtered, .. } = baseline;
            let numbers = [raw.mean, raw.sigma, filtered.mean, filtered.sigma];
            numbers.iter().flatten().try_for_each(|x| out.bytes(&x.to_le_bytes()))?;
        }
        for (table, row, name) in names(config) {
            out.bytes(&[table as u8, row as u8])?;
            out.bytes(&name.bytes())?;
        }
        for response in &config.likelihood.taught {
            out.bytes(&[TAUGHT, (NAME_BYTES + 2 * EFFECTS) as u8])?;
            out.bytes(&response.name.bytes())?;
            response.effects.iter().try_for_each(|effect| out.bytes(&effect.to_le_bytes()))?;
        }
        let crc = CRC32.checksum(out.written()).to_le_bytes();
        out.bytes(&crc)?;
        let length = out.length;
        Ok(&buffer[..length])
    }

    /// Reads a record. Settings that it does not name have their defaults; names that are no longer known are skipped.
    ///
    /// # Errors
    /// Why it is not to be used.
    pub fn decode(bytes: &[u8]) -> Result<Self, StoredError> {
        let (content, crc) = bytes.split_last_chunk().ok_or(StoredError::Short)?;
        if CRC32.checksum(content) != u32::from_le_bytes(*crc) {
            return Err(StoredError::Damaged);
        }
        let mut input = Reader(content);
        let [version, settings] = input.take()?;
        if version != VERSION {
            return Err(StoredError::Version(version));
        }
        let mut stored = Self::default();
        let config = &mut stored.config;
        for _ in 0..settings {
            let id = u16::from_le_bytes(input.take()?);
            let bits = [input.word()?, input.word()?];
            if let Some(setting) = Config::settings().find(|setting| setting.id == id) {
                take_over(config, setting, bits)?;
            }
        }
        for table in [Table::Detection, Table::Isolation] {
            *table.rows_mut(config) = decode_rows(&mut input)?;
        }
        if input.take()? == [1] {
            stored.baseline = Some(decode_baseline(&mut input)?);
        }
        while !input.0.is_empty() {
            match input.take()? {
                [0] => decode_name(Table::Detection, &mut input, &mut stored.config)?,
                [1] => decode_name(Table::Isolation, &mut input, &mut stored.config)?,
                [tag] => {
                    let [length] = input.take()?;
                    let mut body = input.part(usize::from(length))?;
                    if tag == TAUGHT {
                        decode_response(&mut body, &mut stored.config)?;
                    }
                }
            }
        }
        check(&stored.config).map_err(StoredError::Invalid)?;
        Ok(stored)
    }
}

fn take_over(config: &mut Config, setting: &Setting, bits: [u32; 2]) -> Result<(), StoredError> {
    if config.set(setting, bits::value(setting.kind, bits)) {
        return Ok(());
    }
    let (name, value) = (setting.name, bits[0] as f32);
    let (min, max) = setting.kind.bounds().unwrap_or_default();
    Err(StoredError::Invalid(ConfigError::OutOfRange { name, value, min, max }))
}

fn encode_rows(out: &mut Writer<'_>, rows: &Rows) -> Result<(), StoredError> {
    out.bytes(&[rows.len() as u8])?;
    rows.iter().try_for_each(|row| {
        out.bytes(&[row.number])?;
        out.bytes(&row.pattern.0.map(|cell| match cell {
            Cell::Any => 0,
            Cell::Is(Symptom::Low) => 1,
            Cell::Is(Symptom::Normal) => 2,
            Cell::Is(Symptom::High) => 3,
        }))
    })
}

fn decode_rows(input: &mut Reader<'_>) -> Result<Rows, StoredError> {
    let [count] = input.take()?;
    let mut rows = Rows::new();
    for _ in 0..count {
        let [number] = input.take()?;
        let pattern = Pattern(input.take()?.map(|cell| match cell {
            1 => Cell::Is(Symptom::Low),
            2 => Cell::Is(Symptom::Normal),
            3 => Cell::Is(Symptom::High),
            _ => Cell::Any,
        }));
        rows.push(Signature { number, pattern, name: Name::NONE }).map_err(|_| StoredError::TooLong)?;
    }
    Ok(rows)
}

/// The rows that have a name: table, row from 0, name.
fn names(config: &Config) -> impl Iterator<Item = (Table, usize, Name)> {
    let of = |table: Table| table.rows(config).iter().enumerate().map(move |(row, s)| (table, row, s.name));
    [Table::Detection, Table::Isolation].into_iter().flat_map(of).filter(|(.., name)| !name.is_empty())
}

fn decode_name(table: Table, input: &mut Reader<'_>, config: &mut Config) -> Result<(), StoredError> {
    let [row] = input.take()?;
    let name = Name::from_bytes(input.take()?);
    if let Some(signature) = table.rows_mut(config).get_mut(usize::from(row)) {
        signature.name = name;
    }
    Ok(())
}

fn decode_response(input: &mut Reader<'_>, config: &mut Config) -> Result<(), StoredError> {
    let mut response = Response { name: Name::from_bytes(input.take()?), ..Response::default() };
    for effect in &mut response.effects {
        *effect = i16::from_le_bytes(input.take()?);
    }
    let _ = config.likelihood.taught.push(response); // no more are ever written than there is room for
    Ok(())
}

fn decode_baseline(input: &mut Reader<'_>) -> Result<Baseline, StoredError> {
    let mut baseline = Baseline { samples: input.word()?, ..Baseline::default() };
    let Baseline { raw, filtered, .. } = &mut baseline;
    let (Normal { mean, sigma }, Normal { mean: mean_f, sigma: sigma_f }) = (raw, filtered);
    for x in [mean, sigma, mean_f, sigma_f].into_iter().flatten() {
        *x = f32::from_bits(input.word()?);
    }
    Ok(baseline)
}

struct Writer<'a> {
    buffer: &'a mut [u8],
    length: usize,
}

impl Writer<'_> {
    fn bytes(&mut self, bytes: &[u8]) -> Result<(), StoredError> {
        let place =
            self.buffer.get_mut(self.length..self.length + bytes.len()).ok_or(StoredError::TooLong)?;
        place.copy_from_slice(bytes);
        self.length += bytes.len();
        Ok(())
    }

    fn written(&self) -> &[u8] {
        &self.buffer[..self.length]
    }
}

struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], StoredError> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or(StoredError::Short)?;
        self.0 = rest;
        Ok(*bytes)
    }

    /// The next so many bytes by themselves.
    fn part(&mut self, length: usize) -> Result<Self, StoredError> {
        let (part, rest) = self.0.split_at_checked(length).ok_or(StoredError::Short)?;
        self.0 = rest;
        Ok(Self(part))
    }

    fn word(&mut self) -> Result<u32, StoredError> {
        self.take().map(u32::from_le_bytes)
    }
}
