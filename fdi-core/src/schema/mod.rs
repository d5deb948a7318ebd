//! The numbers of a tick, each stated once: unit, kind, value, and where it stands in trace.csv, in a row of the lab's page, in the record of
//! a board's log and among the numbers for Prometheus. All of these read this list; to add a number is to add a line to `numbers.rs`.
//!
//! ```
//! use fdi_core::schema::{self, FIELDS, Moment};
//! use fdi_core::{Config, Instrument, RawSample};
//!
//! let mut instrument = Instrument::new(&Config::default())?;
//! let tick = instrument.control(RawSample::default());
//! let report = instrument.diagnose(&tick, tick.drive);
//! let row = schema::row(&Moment::new(&tick, &report));
//! let setpoint = FIELDS.iter().position(|field| field.name == "setpoint").unwrap();
//! assert_eq!((row[setpoint], FIELDS[setpoint].number.unit), (35.0, "degC"));
//! # Ok::<(), fdi_core::ConfigError>(())
//! ```

mod numbers;

use numbers::LISTED;
pub use numbers::words;

use crate::control::Tick;
use crate::diagnosis::Report;
use crate::diagnosis::baseline::Normal;
use crate::instrument::Instrument;
use crate::likelihood::{FaultClass, HYPOTHESES};
use crate::sense::{RawSample, Reading};
use crate::units::Percent;

/// Class and share of each hypothesis.
pub type Explained = [(FaultClass, f32); HYPOTHESES];

/// What each hypothesis explains of an alarm, on the tick that the instrument has just reported.
pub fn explained(instrument: &Instrument, report: &Report) -> Option<Explained> {
    report.likelihood.alarm.then(|| instrument.likelihood().explained()).flatten()
}

/// What is known of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// First half of the tick.
    pub tick: &'a Tick,
    /// Second half of the tick.
    pub report: &'a Report,
    /// Codes as they came.
    pub raw: RawSample,
    /// What the heater got from it on. That of a self-test is none of the controller's.
    pub applied: Percent,
    /// How late it began, µs.
    pub late_us: u32,
    /// It never began.
    pub missed: bool,
    /// Number of the fault that acts, 0 for none.
    pub truth: u8,
    /// What each hypothesis explains of an alarm, where that was asked.
    pub explained: Option<&'a Explained>,
    /// What was learnt of the low-passed features.
    pub normal: Option<&'a Normal>,
    /// Thresholds lie this many standard deviations from the mean.
    pub sigma_factor: f32,
}

impl<'a> Moment<'a> {
    /// A tick that began in time, whose power the heater got, and of which nothing else is known.
    pub fn new(tick: &'a Tick, report: &'a Report) -> Self {
        Self {
            tick,
            report,
            raw: RawSample::default(),
            applied: tick.drive,
            late_us: 0,
            missed: false,
            truth: 0,
            explained: None,
            normal: None,
            sigma_factor: 1.0,
        }
    }
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident($of:ty),)*) => {
        /// Of what kind a number is.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Kind {
            $($(#[$doc])* $kind,)*
        }

        /// A number of a tick. `None`: not defined on it.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Value {
            $($(#[$doc])* $kind($of),)*
        }
    };
}

kinds! {
    /// A real number; in a log its bits.
    Float(Option<f32>),
    /// What a thermistor reads, degC; to a page only where it reads anything.
    Reading(Reading),
    /// A count, a flag, the number of a fault.
    Count(Option<u32>),
    /// A part of the paper's vectors; in a log it is defined where symptoms are.
    Judged(Option<u8>),
    /// Number of a tick; in a trace its time, s.
    Tick(Option<u32>),
    /// Number from 0, always defined, and name; in a trace the name.
    Named((u32, &'static str)),
    /// Number from 1, and name; in a trace the name, in a log 0 for none.
    Choice(Option<(u32, &'static str)>),
    /// A place from 1; in a log 0 for none.
    Place(Option<u32>),
}

/// "Not defined", where a number has a whole word of a log: a NaN that no arithmetic gives.
pub const NONE: u32 = u32::MAX;

impl Value {
    /// As a page has it; NaN where it is not defined.
    pub fn number(self) -> f32 {
        let number = match self {
            Self::Float(x) => x,
            Self::Reading(reading) => reading.read(),
            Self::Named((number, _)) => Some(number as f32),
            Self::Choice(of) => of.map(|(number, _)| number as f32),
            Self::Judged(of) => of.map(f32::from),
            Self::Count(of) | Self::Tick(of) | Self::Place(of) => of.map(|number| number as f32),
        };
        number.unwrap_or(f32::NAN)
    }

    /// As a log has it. What a log has in another form, such as the code of a reading, is [`NONE`].
    #[inline(always)]
    const fn bits(self) -> u32 {
        const fn or(of: Option<u32>, none: u32) -> u32 {
            match of {
                Some(of) => of,
                None => none,
            }
        }
        match self {
            Self::Float(Some(x)) => x.to_bits(),
            Self::Float(None) | Self::Reading(_) => NONE,
            Self::Count(of) | Self::Tick(of) => or(of, NONE),
            Self::Named((number, _)) | Self::Choice(Some((number, _))) => number,
            Self::Judged(Some(of)) => of as u32,
            Self::Judged(None) | Self::Choice(None) => 0,
            Self::Place(of) => or(of, 0),
        }
    }
}

/// A number of a tick.
#[derive(Clone, Copy)]
pub struct Number {
    /// Its unit, empty where it has none.
    pub unit: &'static str,
    /// Its kind.
    pub kind: Kind,
    source: Source,
    /// Place and name of its column in trace.csv. To programs that read an older trace by position the others stay where they were.
    column: Option<(usize, &'static str)>,
    /// Place and name of its field in a row for a page.
    field: Option<(usize, &'static str)>,
    /// Its bits in the record of a tick.
    log: Option<Bits>,
    /// It among the numbers for Prometheus.
    pub metric: Option<Metric>,
}

/// Where the value of a number comes from.
#[derive(Clone, Copy)]
enum Source {
    /// A function.
    Of(fn(&Moment) -> Value),
    /// What this class explains of an alarm.
    Share(FaultClass),
}

/// Some bits of a word.
#[derive(Clone, Copy)]
struct Bits {
    word: usize,
    name: &'static str,
    shift: u32,
    width: u32,
}

impl Bits {
    const WHOLE: u32 = u32::BITS;

    /// As many ones.
    const fn mask(&self) -> u32 {
        u32::MAX >> (Self::WHOLE - self.width)
    }

    /// Puts bits into their place.
    #[inline(always)]
    fn put(&self, bits: u32, words: &mut [u32; WORDS]) {
        if let Some(word) = words.get_mut(self.word) {
            *word |= (bits & self.mask()) << self.shift;
        }
    }

    fn take(&self, words: &[u32; WORDS]) -> u32 {
        words[self.word] >> self.shift & self.mask()
    }
}

/// A number for Prometheus.
#[derive(Clone, Copy)]
pub struct Metric {
    /// Its name, which several may share.
    pub name: &'static str,
    /// What the first of its name is.
    pub help: &'static str,
    /// By what it differs from others of its name: `sensor="t0"`.
    pub label: &'static str,
}

/// A number where it stands under a name.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Its name there.
    pub name: &'static str,
    /// The number.
    pub number: &'static Number,
}

/// Every number: those of the list, then the share of each class that has one.
pub static NUMBERS: [Number; LISTED.len() + SHARES] = {
    let mut all = [LISTED[0]; _];
    let mut i = 0;
    while i < LISTED.len() {
        all[i] = LISTED[i];
        i += 1;
    }
    let mut class = 0;
    while class < FaultClass::ALL.len() {
        if let Some(share) = FaultClass::ALL[class].share() {
            let field = Some((share.place, share.field));
            let source = Source::Share(FaultClass::ALL[class]);
            all[i] =
                Number { unit: "", kind: Kind::Float, source, column: None, field, log: None, metric: None };
            i += 1;
        }
        class += 1;
    }
    all
};

/// Classes that explain a share of an alarm.
const SHARES: usize = {
    let (mut class, mut count) = (0, 0);
    while class < FaultClass::ALL.len() {
        count += FaultClass::ALL[class].share().is_some() as usize;
        class += 1;
    }
    count
};

/// Every one of the given place, in the order of the places. A place that is free, or given twice, does not compile.
macro_rules! by_place {
    ($(#[$doc:meta])* $all:ident, $place:ident) => {
        $(#[$doc])*
        pub static $all: [Entry; {
            let (mut i, mut count) = (0, 0);
            while i < NUMBERS.len() {
                count += NUMBERS[i].$place.is_some() as usize;
                i += 1;
            }
            count
        }] = {
            let mut all = [Entry { name: "", number: &NUMBERS[0] }; _];
            let mut i = 0;
            while i < NUMBERS.len() {
                if let Some((place, name)) = NUMBERS[i].$place {
                    assert!(all[place].name.is_empty(), "a place that is given twice");
                    all[place] = Entry { name, number: &NUMBERS[i] };
                }
                i += 1;
            }
            all
        };
    };
}

by_place! {
    /// The columns of trace.csv.
    COLUMNS, column
}
by_place! {
    /// The fields of a row for a page.
    FIELDS, field
}

/// Words in the record of a tick.
pub const WORDS: usize = {
    let (mut i, mut words) = (0, 0);
    while i < NUMBERS.len() {
        if let Some(Bits { word, .. }) = NUMBERS[i].log
            && word >= words
        {
            words = word + 1;
        }
        i += 1;
    }
    words
};

/// Names of these words; numbers that share one stand under a name of its own.
pub const WORD_NAMES: [&str; WORDS] = {
    let mut names = [""; WORDS];
    let mut i = 0;
    while i < numbers::SHARED.len() {
        let (word, name) = numbers::SHARED[i];
        names[word] = name;
        i += 1;
    }
    i = 0;
    while i < NUMBERS.len() {
        if let Some(Bits { word, name, width: Bits::WHOLE, .. }) = NUMBERS[i].log {
            assert!(names[word].is_empty(), "a word that is given twice");
            names[word] = name;
        }
        i += 1;
    }
    names
};

/// The numbers of a tick for a page.
pub type Numbers = [f32; FIELDS.len()];

/// All numbers of a tick that go to a page, in the order of [`FIELDS`].
pub fn row(on: &Moment) -> Numbers {
    core::array::from_fn(|i| FIELDS[i].number.value(on).number())
}

/// Place of a field in a row.
pub fn field(name: &str) -> Option<usize> {
    FIELDS.iter().position(|field| field.name == name)
}

impl Number {
    /// What it is on a tick.
    pub fn value(&self, on: &Moment) -> Value {
        match self.source {
            Source::Of(value) => value(on),
            Source::Share(class) => Value::Float(on.share(class)),
        }
    }

    /// Its bits in the record of a tick; `None` where it is not defined, or no record holds it.
    pub fn bits(&self, words: &[u32; WORDS]) -> Option<u32> {
        let at = self.log?;
        let bits = at.take(words);
        let defined = match self.kind {
            Kind::Choice | Kind::Place => bits != 0,
            Kind::Judged => words[numbers::SYMPTOMS] != NONE,
            _ => at.width < Bits::WHOLE || bits != NONE,
        };
        defined.then_some(bits)
    }
}

/// The number that a log calls so.
fn of_log(name: &str) -> Option<(&'static Number, Bits)> {
    NUMBERS.iter().find_map(|number| Some((number, number.log.filter(|at| at.name == name)?)))
}

/// The bits of the number that a log calls so; `None` where it is not defined.
pub fn logged(words: &[u32; WORDS], name: &str) -> Option<u32> {
    of_log(name)?.0.bits(words)
}

/// Clears the bits of the number that a log calls so.
pub fn forget(words: &mut [u32; WORDS], name: &str) {
    if let Some((_, at)) = of_log(name) {
        words[at.word] &= !(at.mask() << at.shift);
    }
}

#[cfg(test)]
mod tests;
