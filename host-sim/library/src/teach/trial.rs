//! How a new row does on the recording that it was made from: found, missed, and said where it should not be.

use fdi_core::Config;
use fdi_core::Seconds;
use fdi_core::diagnosis::answer::{Answers, Standing};
use fdi_core::name::Name;

use super::{Diagnoses, Marks, Span};

/// A name that is gone for less long has not gone, s.
const FLICKER: f64 = 2.0;

/// What fiv, or the likelihood diagnosis, said of one fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// For each repetition, after how many s it was named; `None` if it was missed.
    pub hits: Vec<Option<f64>>,
    /// Times in s at which it began to be named while another fault was there, with that one's name.
    pub taken_for: Vec<(f64, Name)>,
    /// Times in s at which it began to be named while nothing that was marked was there.
    pub wrong: Vec<f64>,
    /// How long it was watched while nothing that was marked was there, s.
    pub quiet: f64,
}

/// The same in recordings in which nothing was done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quiet {
    /// How long they were monitored, s.
    pub watched: f64,
    /// How often it began to name it.
    pub named: usize,
}

impl Quiet {
    /// Has the tables of `config` answer every tick, for the row of this number.
    pub(super) fn of(quiet: &[Diagnoses], config: &Config, number: u8) -> Self {
        Self::by(quiet, |diagnoses| begins(diagnoses, config, number))
    }

    /// What the likelihood diagnosis said of the fault of this name.
    pub(super) fn recalled(quiet: &[Diagnoses], name: Name) -> Self {
        Self::by(quiet, |diagnoses| recalls(diagnoses, name))
    }

    fn by(quiet: &[Diagnoses], begins: impl Fn(&Diagnoses) -> Vec<f64>) -> Self {
        let watched = |diagnoses: &Diagnoses| diagnoses.monitored().count() as f64 * diagnoses.sample_time;
        Self {
            watched: quiet.iter().map(watched).sum(),
            named: quiet.iter().map(|diagnoses| begins(diagnoses).len()).sum(),
        }
    }
}

impl Trial {
    /// Has the tables of `config` answer every tick, for the row of this number.
    pub(super) fn of(diagnoses: &Diagnoses, config: &Config, number: u8, marks: &[Marks]) -> Self {
        let row = config.diagnosis.isolation.iter().find(|row| row.number == number);
        let name = row.map_or(Name::NONE, |row| row.name);
        Self::by(diagnoses, &begins(diagnoses, config, number), marks, name)
    }

    /// What the likelihood diagnosis said of the fault of this name.
    pub(super) fn recalled(diagnoses: &Diagnoses, marks: &[Marks], name: Name) -> Self {
        Self::by(diagnoses, &recalls(diagnoses, name), marks, name)
    }

    fn by(diagnoses: &Diagnoses, begins: &[f64], marks: &[Marks], name: Name) -> Self {
        let own = marks.iter().find(|marks| marks.name == name);
        let spans: &[Span] = own.map_or(&[], |marks| &marks.spans);
        let hit = |span: &Span| begins.iter().find(|at| span.holds(**at)).map(|at| at - span.from);
        let there =
            |at: f64| marks.iter().find(|marks| marks.spans.iter().any(|s| s.holds(at))).map(|m| m.name);
        let astray = || begins.iter().filter(|at| !spans.iter().any(|span| span.holds(**at)));
        let quiet = diagnoses.monitored().filter(|(time, _)| there(*time).is_none()).count();
        Self {
            hits: spans.iter().map(hit).collect(),
            taken_for: astray().filter_map(|at| Some((*at, there(*at)?))).collect(),
            wrong: astray().filter(|at| there(**at).is_none()).copied().collect(),
            quiet: quiet as f64 * diagnoses.sample_time,
        }
    }
}

/// When the likelihood diagnosis began to say this name, s.
fn recalls(diagnoses: &Diagnoses, name: Name) -> Vec<f64> {
    let said = diagnoses.ticks().filter(|(_, said)| said.taught == Some(name));
    first_of_each(said.map(|(time, _)| time), FLICKER)
}

/// When fiv came to this number, s.
fn begins(diagnoses: &Diagnoses, config: &Config, number: u8) -> Vec<f64> {
    let clear = config.diagnosis.clear_time;
    let answers =
        Answers::new(&config.diagnosis.isolation, clear.ticks(Seconds(diagnoses.sample_time as f32)));
    let mut standing = Standing::default();
    let mut says = |symptoms| answers.step(&mut standing, symptoms) == number;
    let said = diagnoses.monitored().filter_map(|(time, symptoms)| says(symptoms).then_some(time));
    first_of_each(said, f64::from(clear.0))
}

/// The first of the times that are no further apart than this.
fn first_of_each(times: impl Iterator<Item = f64>, gap: f64) -> Vec<f64> {
    let mut begins = Vec::new();
    let mut last = f64::NEG_INFINITY;
    for time in times {
        if time - last > gap {
            begins.push(time);
        }
        last = time;
    }
    begins
}
