//! How a new row does on the recording that it was made from: found, missed, and said where it should not be.

use fdi_core::Config;
use fdi_core::Seconds;
use fdi_core::diagnosis::answer::{Answers, Standing};
use fdi_core::name::Name;

use super::{Marks, Span, Watch};

/// What fiv said of one fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// For each repetition, after how many s fiv named it; `None` if it was missed.
    pub hits: Vec<Option<f64>>,
    /// Times in s at which fiv began to name it while another fault was there, with that one's name.
    pub taken_for: Vec<(f64, Name)>,
    /// Times in s at which fiv began to name it while nothing that was marked was there.
    pub wrong: Vec<f64>,
    /// How long it was watched while nothing that was marked was there, s.
    pub quiet: f64,
}

/// What fiv said of one fault in recordings in which nothing was done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quiet {
    /// How long they were monitored, s.
    pub watched: f64,
    /// How often it began to name it.
    pub named: usize,
}

impl Quiet {
    /// Has the tables of `config` answer every tick, for the row of this number.
    pub(super) fn of(quiet: &[Watch], config: &Config, number: u8) -> Self {
        let watched = |watch: &Watch| watch.monitored().count() as f64 * watch.sample_time;
        Self {
            watched: quiet.iter().map(watched).sum(),
            named: quiet.iter().map(|watch| begins(watch, config, number).len()).sum(),
        }
    }
}

impl Trial {
    /// Has the tables of `config` answer every tick, for the row of this number.
    pub(super) fn of(watch: &Watch, config: &Config, number: u8, marks: &[Marks]) -> Self {
        let own = |marks: &&Marks| {
            config.diagnosis.isolation.iter().any(|row| row.number == number && row.name == marks.name)
        };
        let spans: &[Span] = marks.iter().find(own).map_or(&[], |marks| &marks.spans);
        let begins = begins(watch, config, number);
        let hit = |span: &Span| begins.iter().find(|at| span.holds(**at)).map(|at| at - span.from);
        let there =
            |at: f64| marks.iter().find(|marks| marks.spans.iter().any(|s| s.holds(at))).map(|m| m.name);
        let astray = || begins.iter().filter(|at| !spans.iter().any(|span| span.holds(**at)));
        let quiet = watch.monitored().filter(|(time, _)| there(*time).is_none()).count();
        Self {
            hits: spans.iter().map(hit).collect(),
            taken_for: astray().filter_map(|at| Some((*at, there(*at)?))).collect(),
            wrong: astray().filter(|at| there(**at).is_none()).copied().collect(),
            quiet: quiet as f64 * watch.sample_time,
        }
    }
}

/// When fiv came to this number, s; gaps below the time after which a fault counts as ended are flicker.
fn begins(watch: &Watch, config: &Config, number: u8) -> Vec<f64> {
    let clear = config.diagnosis.clear_time;
    let answers = Answers::new(&config.diagnosis.isolation, clear.ticks(Seconds(watch.sample_time as f32)));
    let (mut standing, gap) = (Standing::default(), f64::from(clear.0));
    let mut begins = Vec::new();
    let mut last = f64::NEG_INFINITY;
    for (time, symptoms) in watch.monitored() {
        if answers.step(&mut standing, symptoms) != number {
            continue;
        }
        if time - last > gap {
            begins.push(time);
        }
        last = time;
    }
    begins
}
