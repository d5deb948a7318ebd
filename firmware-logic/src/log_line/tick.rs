//! The record of one tick, as the log carries it: the bits of what went in and of what came out, so that a replay on
//! the host can run the core again and compare. It is text of 32 hexadecimal words after "tick ", in the order of
//! [`WORD_NAMES`]; which number stands where is declared in [`schema`].

use core::fmt;

use fdi_core::likelihood::Readiness;
use fdi_core::schema::{self, Moment, NONE, WORD_NAMES, WORDS};
use fdi_core::supervisor::Blocker;
use fdi_core::{AdcCode, Mode, Percent, RawSample, Report};

use crate::control_loop::TickRecord;

/// Characters of the longest record: "tick", and a blank and 8 digits a word.
pub const LONGEST: usize = 4 + 9 * WORDS;

/// One tick as words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickLine(pub [u32; WORDS]);

impl TickLine {
    /// The record of a tick.
    pub fn new(record: &TickRecord, report: &Report) -> Self {
        Self(schema::words(&Moment {
            raw: record.raw,
            applied: record.applied,
            late_us: record.arrival.late_us,
            missed: record.missed,
            ..Moment::new(&record.tick, report)
        }))
    }

    /// The bits of the number that the schema calls so in a log; `None` where it is not defined.
    pub fn bits(&self, name: &str) -> Option<u32> {
        schema::logged(&self.0, name)
    }

    /// Number of the tick.
    pub fn tick(&self) -> u32 {
        self.0[0]
    }

    /// What has this number, from `first` on, in a list.
    fn name<'a>(&self, number: &str, first: u32, names: &[&'a str]) -> Option<&'a str> {
        names.get(self.bits(number)?.checked_sub(first)? as usize).copied()
    }

    /// Name of the mode; `None` of one that is not known here.
    pub fn mode(&self) -> Option<&'static str> {
        self.name("mode", 0, &Mode::NAMES)
    }

    /// What kept the tick from being learnt, in words.
    pub fn blocked(&self) -> Option<&'static str> {
        self.name("blocked", 1, &Blocker::WORDS)
    }

    /// How far the likelihood diagnosis is, by name.
    pub fn readiness(&self) -> Option<&'static str> {
        self.name("readiness", 0, &Readiness::NAMES)
    }

    /// Codes that went in.
    pub fn raw(&self) -> RawSample {
        let [t0, t1, t2, supply] = ["t0_code", "t1_code", "t2_code", "supply_code"]
            .map(|name| AdcCode(f32::from_bits(self.bits(name).unwrap_or(NONE))));
        RawSample { t0, t1, t2, supply }
    }

    /// What the heater got.
    pub fn applied(&self) -> Percent {
        Percent(f32::from_bits(self.bits("applied").unwrap_or(NONE)))
    }

    /// The tick never began.
    pub fn missed(&self) -> bool {
        self.bits("missed") == Some(1)
    }

    /// Microseconds that the tick began late.
    pub fn late_us(&self) -> u32 {
        self.bits("late_us").unwrap_or(0)
    }

    /// Names of the words that differ, with the words; all NaN codes are one. Why it tripped stands in no record of before: there it is
    /// not compared.
    pub fn differences(&self, other: &Self) -> impl Iterator<Item = (&'static str, u32, u32)> {
        let mut other = *other;
        if self.bits("trip").is_none() {
            schema::forget(&mut other.0, "trip");
        }
        let pairs = self.0.into_iter().zip(other.0);
        WORD_NAMES.into_iter().zip(pairs).filter_map(|(name, (a, b))| (a != b).then_some((name, a, b)))
    }
}

impl fmt::Display for TickLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("tick")?;
        self.0.iter().try_for_each(|word| write!(f, " {word:x}"))
    }
}

/// The same text, put together where the log is decoded. defmt wants a literal: a word more is to be added here, and [`VERSION`](super::VERSION) to
/// be raised.
#[cfg(feature = "defmt")]
impl defmt::Format for TickLine {
    #[rustfmt::skip]
    fn format(&self, f: defmt::Formatter<'_>) {
        let w = &self.0;
        defmt::write!(
            f,
            "tick {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} \
             {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} \
             {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x} {=u32:x}",
            w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7], w[8], w[9], w[10], w[11], w[12],
            w[13], w[14], w[15], w[16], w[17], w[18], w[19], w[20], w[21], w[22], w[23], w[24], w[25],
            w[26], w[27], w[28], w[29], w[30], w[31],
        );
    }
}

const _: () = assert!(WORDS == 32, "the text for defmt above has 32 words");

/// Why a line is no record of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TickLineError {
    /// It has another number of words.
    Words {
        /// How many.
        found: usize,
    },
    /// A word is no hexadecimal number of up to 8 digits.
    Word {
        /// The name of the word.
        name: &'static str,
    },
}

impl fmt::Display for TickLineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Words { found } => write!(f, "record has {found} words, expected {WORDS}"),
            Self::Word { name } => write!(f, "{name}: expected a hexadecimal number of up to 8 digits"),
        }
    }
}

impl core::error::Error for TickLineError {}

/// Parses what follows "tick ", as far as it belongs to the record; `None` where it is a sentence that speaks of a tick.
pub(super) fn find(text: &str) -> Result<Option<TickLine>, TickLineError> {
    let words = || text.split_ascii_whitespace().take(WORDS);
    if words().count() < SENTENCE || words().take(SENTENCE).any(|digits| word(digits).is_none()) {
        return Ok(None);
    }
    let found = words().count();
    if found != WORDS {
        return Err(TickLineError::Words { found });
    }
    let mut line = TickLine([0; WORDS]);
    for ((to, name), digits) in line.0.iter_mut().zip(WORD_NAMES).zip(words()) {
        *to = word(digits).ok_or(TickLineError::Word { name })?;
    }
    Ok(Some(line))
}

/// Words at the beginning that are all hexadecimal in no sentence.
const SENTENCE: usize = 8;

/// A hexadecimal number of up to 8 digits.
pub(super) fn word(digits: &str) -> Option<u32> {
    let plain = digits.bytes().all(|b| b.is_ascii_hexdigit()); // from_str_radix would also take a sign
    u32::from_str_radix(digits, 16).ok().filter(|_| plain)
}
