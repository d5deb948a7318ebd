//! A baseline in the log: a line with the number of samples, and a line of bits for each of its rows.

use core::fmt;

use fdi_core::diagnosis::baseline::Baseline;

use super::{LogLineError, tick};

/// Values of a row: one a residual.
pub(super) const WORDS: usize = 7;

/// One line of a baseline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BaselineLine {
    /// How many samples it was learnt from.
    Samples(u32),
    /// A row, by its place in the table, and its values.
    Row(usize, [f32; WORDS]),
}

type Row = fn(&mut Baseline) -> &mut [f32; WORDS];

/// The rows.
const ROWS: [(&str, Row); 4] = [
    ("raw.mean", |baseline| &mut baseline.raw.mean),
    ("raw.sigma", |baseline| &mut baseline.raw.sigma),
    ("filtered.mean", |baseline| &mut baseline.filtered.mean),
    ("filtered.sigma", |baseline| &mut baseline.filtered.sigma),
];

impl BaselineLine {
    /// All lines of a baseline.
    pub fn all(baseline: &Baseline) -> [Self; 5] {
        let mut baseline = *baseline;
        let mut row = |i: usize| Self::Row(i, *ROWS[i].1(&mut baseline));
        let [a, b, c, d] = [row(0), row(1), row(2), row(3)];
        [Self::Samples(baseline.samples), a, b, c, d]
    }

    /// Puts it into a baseline.
    pub fn restore(&self, baseline: &mut Baseline) {
        match self {
            Self::Samples(samples) => baseline.samples = *samples,
            Self::Row(i, values) => {
                if let Some((_, row)) = ROWS.get(*i) {
                    *row(baseline) = *values;
                }
            }
        }
    }
}

impl fmt::Display for BaselineLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Samples(samples) => write!(f, "baseline samples {samples}"),
            Self::Row(i, values) => {
                write!(f, "baseline {}", ROWS.get(*i).map_or("", |(name, _)| name))?;
                values.iter().try_for_each(|value| write!(f, " {:x}", value.to_bits()))
            }
        }
    }
}

/// Parses what follows "baseline "; `None` where it is a sentence.
pub(super) fn parse(text: &str) -> Result<Option<BaselineLine>, LogLineError<'_>> {
    let mut words = text.split_ascii_whitespace();
    let part = words.next().unwrap_or_default();
    if part == "samples" {
        return Ok(words.next().and_then(|word| word.parse().ok()).map(BaselineLine::Samples));
    }
    if !part.contains('.') {
        return Ok(None);
    }
    let row = ROWS.iter().position(|(name, _)| *name == part).ok_or(LogLineError::Part(part))?;
    let bits = words.map_while(tick::word);
    let found = bits.clone().count();
    let mut values = [0.0; WORDS];
    values.iter_mut().zip(bits).for_each(|(value, bits)| *value = f32::from_bits(bits));
    if found == WORDS {
        Ok(Some(BaselineLine::Row(row, values)))
    } else {
        Err(LogLineError::Words { part, found })
    }
}
