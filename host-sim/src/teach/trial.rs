//! How a new row does on the recording that it was made from: found, missed, and said where it should not be.

use fdi_core::Config;
use fdi_core::diagnosis::name::Name;
use fdi_core::diagnosis::signature::Table;

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

impl Trial {
    /// Looks every tick up in the tables of `config`, for the row of this number.
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
    let table = Table::new(&config.diagnosis.isolation);
    let gap = f64::from(config.diagnosis.clear_time.0);
    let mut begins = Vec::new();
    let mut last = f64::NEG_INFINITY;
    for (time, _) in watch.monitored().filter(|(_, symptoms)| table.look_up(symptoms) == number) {
        if time - last > gap {
            begins.push(time);
        }
        last = time;
    }
    begins
}
