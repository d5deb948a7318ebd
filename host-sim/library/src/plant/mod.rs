//! A plant of several loops, watched by ARX models of its actuators, processes and controllers, and scored where the truth is known.
//!
//! Example: of a reactor with a cooling valve the settings name two temperatures that answer to the valve, and the controller that moves the
//! valve by what it reads. Which signals these are is all that is known of a plant; the rest is learnt from a file without a fault.
//! docs/scores.md has the protocol.

mod charts;
mod coils;
mod model;
mod report;
mod settings;
mod signs;

use std::path::Path;

use anyhow::{Context, ensure};

use crate::recording::table::Table;
use charts::Watch;
use coils::AirHandler;
use settings::{BUILT_IN, Plant, Truth};
use signs::name_of;

/// What a plant's files came to.
#[derive(Clone, Debug)]
pub struct Scored {
    /// Share in alarm where nothing is wrong: of the file without a fault, and of what comes before the faults.
    pub false_alarms: [f64; 2],
    /// Each fault.
    pub faults: Vec<FaultScore>,
    /// How often each name is given in the file without a fault.
    pub false_names: Vec<f64>,
}

/// How a fault was seen.
#[derive(Clone, Debug)]
pub struct FaultScore {
    /// Share of its samples that are in alarm.
    pub detected: f64,
    /// Samples from its onset to the first of `IN_A_ROW` alarms in a row.
    pub delay: Option<usize>,
    /// Share of the samples at which each name was given: where the fault comes, and in the run that has it from the first sample on.
    pub named: [Vec<f64>; 2],
}

/// So many alarms in a row are an alarm for the delay. Chosen.
const IN_A_ROW: usize = 3;

impl Plant {
    /// Learns from the plant's file without a fault, and judges all others. The files are looked for in `dir`.
    ///
    /// # Errors
    /// A file that is missing or wrong, or a setting that fits no file.
    pub fn score(&self, dir: &Path) -> anyhow::Result<Scored> {
        let watch = Watch::learn(self, &self.read(dir, &self.training)?)?;
        let judged = |file: &str| anyhow::Ok(watch.charts(&self.read(dir, file)?));
        let normal = judged(&self.normal)?;
        let mut before = Vec::new();
        let mut faults = Vec::new();
        for Truth { file, again, .. } in &self.faults {
            let (charts, again) = (judged(file)?, judged(again)?);
            let alarms = watch.alarms(&charts);
            ensure!(alarms.len() > self.onset, "{file}: it ends before `onset`, sample {}", self.onset);
            before.extend_from_slice(&alarms[self.skip.min(self.onset)..self.onset]);
            let alarms = &alarms[self.onset..];
            faults.push(FaultScore {
                detected: share(alarms.iter().copied()),
                delay: alarms.windows(IN_A_ROW).position(|row| row.iter().all(|alarm| *alarm)),
                named: [
                    self.named(&watch, &charts, self.onset + self.window),
                    self.named(&watch, &again, self.window),
                ],
            });
        }
        let quiet = watch.alarms(&normal);
        Ok(Scored {
            false_alarms: [share(quiet.into_iter().skip(self.skip)), share(before.into_iter())],
            faults,
            false_names: self.named(&watch, &normal, self.window),
        })
    }

    /// How often each row of the table of signs fits, from a sample on.
    fn named(&self, watch: &Watch, charts: &[Vec<f32>], from: usize) -> Vec<f64> {
        let names: Vec<Option<usize>> = (from..=charts[0].len())
            .map(|end| name_of(self, &watch.signs(charts, end - self.window..end)))
            .collect();
        (0..self.names.len()).map(|name| share(names.iter().map(|said| *said == Some(name)))).collect()
    }

    /// The signals of a file, each a column. A file with signals in rows is turned.
    fn read(&self, dir: &Path, file: &str) -> anyhow::Result<Vec<Vec<f32>>> {
        let table = Table::read(&dir.join(file))?;
        let rows = table.numbers()?;
        let is_turned = table.width() != self.signals;
        ensure!(
            !is_turned || rows.len() == self.signals,
            "{}: {} columns and {} rows, expected {} signals in columns or rows",
            table.file(),
            table.width(),
            rows.len(),
            self.signals
        );
        let single = |numbers: &mut dyn Iterator<Item = &f64>| numbers.map(|x| *x as f32).collect();
        Ok(match is_turned {
            true => rows.iter().map(|row| single(&mut row.iter())).collect(),
            false => (0..self.signals).map(|at| single(&mut rows.iter().map(|row| &row[at]))).collect(),
        })
    }
}

/// The settings of a plant that comes with the program, or those of a file.
///
/// # Errors
/// No such plant or file.
pub fn settings_of(name: &str) -> anyhow::Result<String> {
    if let Some((_, text)) = BUILT_IN.iter().find(|(of, _)| *of == name) {
        return Ok((*text).to_owned());
    }
    std::fs::read_to_string(name).with_context(|| {
        let names: Vec<&str> = BUILT_IN.iter().map(|(of, _)| *of).collect();
        format!("{name}: neither a file of settings nor one of {}", names.join(", "))
    })
}

/// Scores the files of a folder by the settings of a plant: an air handler's, which have `[coils]`, or those of loops. Markdown.
///
/// # Errors
/// Settings or files that are missing or wrong.
pub fn score(settings: &str, dir: &Path) -> anyhow::Result<String> {
    if settings.lines().any(|line| line.trim() == "[coils]") {
        return AirHandler::parse(settings)?.score(dir);
    }
    let plant = Plant::parse(settings)?;
    Ok(plant.score(dir)?.markdown(&plant))
}

/// Share of what is true; of nothing 0.
fn share(all: impl Iterator<Item = bool>) -> f64 {
    let (mut count, mut of) = (0, 0);
    for is in all {
        (count, of) = (count + usize::from(is), of + 1);
    }
    count as f64 / f64::from(of.max(1) as u32)
}

#[cfg(test)]
mod tests;
