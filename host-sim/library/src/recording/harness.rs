//! A folder of recordings, each diagnosed as its TOML says, and held against bars.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use fdi_core::Config;
use indicatif::ProgressBar;
use pt326_rig::fault::Verb;
use serde::Deserialize;

use super::inject::{self, Injected};
use super::run::{Diagnosed, Training, diagnose};
use super::score::{Score, Seen, score, table};
use super::{Reading, Recording, truth};

/// The definitions that come with the program.
pub const BUILT_IN: [&str; 6] = [
    include_str!("../../defaults/records/tclab_faults_0.toml"),
    include_str!("../../defaults/records/tclab_setpoint_0.toml"),
    include_str!("../../defaults/records/tclab_step.toml"),
    include_str!("../../defaults/records/pt326_dryer.toml"),
    include_str!("../../defaults/records/floor_run1.toml"),
    include_str!("../../defaults/records/floor_run2.toml"),
];

/// A recording, where it is from, and what is expected of it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Definition {
    /// What to call it.
    pub name: String,
    /// What it is, where it comes from, under which licence, and how to obtain it.
    pub about: String,
    /// Its file in the folder.
    pub file: PathBuf,
    /// Another one of the same rig, in which nothing is wrong.
    pub train_on: Option<PathBuf>,
    /// Or a part of it, s since the first sample.
    pub train: Option<[f64; 2]>,
    /// The rig was cold and off before the first sample.
    #[serde(default)]
    pub from_rest: bool,
    /// How to read it.
    #[serde(default)]
    pub reading: Reading,
    /// What was truly wrong with each heater, in the order of the heaters; see `diagnose --truth`.
    #[serde(default)]
    pub truth: Vec<Vec<String>>,
    /// Faults are put in at so many places.
    #[serde(default)]
    pub inject: usize,
    /// What is expected.
    #[serde(default)]
    pub bars: Bars,
}

/// What is expected.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bars {
    /// Of a thermistor's faults.
    pub sensor: Option<Bar>,
    /// Of a heater's.
    pub heater: Option<Bar>,
    /// Least simulated fit on the training and on the rest, %.
    pub fit: Option<[f64; 2]>,
    /// Least share of onsets that are seen in time, %.
    pub seen: Option<f64>,
}

/// What is expected of a kind of fault: times in s, the error of the size in %.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bar {
    /// Latest alarm.
    pub alarm: Option<f64>,
    /// Latest right name.
    pub named: Option<f64>,
    /// Largest error of the size.
    pub size: Option<f64>,
    /// Longest alarm after its end.
    pub tail: Option<f64>,
}

/// What a heater of a recording came to.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Name of the recording, and which heater.
    pub name: String,
    /// What was learnt and said.
    pub done: Diagnosed,
    /// How its faults were seen.
    pub score: Score,
    /// How those that were put in were.
    pub injected: Vec<Injected>,
    /// What was expected and not reached; empty: all was.
    pub missed: Vec<String>,
}

impl Definition {
    /// The definitions of a folder, or where it has none those that come with the program.
    ///
    /// # Errors
    /// The file, line and key that are wrong.
    pub fn all(dir: &Path) -> anyhow::Result<Vec<Self>> {
        let entries =
            std::fs::read_dir(dir).with_context(|| format!("can't read the folder {}", dir.display()))?;
        let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        files.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
        files.sort();
        let read = |path: &PathBuf| {
            let text = std::fs::read_to_string(path)?;
            toml::from_str(&text).with_context(|| path.display().to_string())
        };
        if files.is_empty() {
            return BUILT_IN.iter().map(|text| Ok(toml::from_str(text)?)).collect();
        }
        files.iter().map(read).collect()
    }

    /// Diagnoses each heater of it; the files are looked for in `dir`.
    ///
    /// # Errors
    /// A file that is missing or wrong, or why nothing can be learnt.
    pub fn run(&self, dir: &Path, config: &Config) -> anyhow::Result<Vec<Outcome>> {
        let (file, text) = super::text::text_of(&dir.join(&self.file))?;
        let (mut recording, other) = Recording::with_other(
            (file, &text),
            self.train_on.as_ref().map(|of| super::text::text_of(&dir.join(of))).transpose()?,
            &self.reading,
        )?;
        let mut outcomes = Vec::new();
        let truths: Vec<_> = (0..recording.heaters.len())
            .map(|which| {
                let said = self.truth.get(which).map_or(&[][..], Vec::as_slice);
                truth::read(said, &text, &recording, &recording.heaters[which])
            })
            .collect::<anyhow::Result<_>>()?;
        if self.from_rest {
            ensure!(
                self.truth.is_empty(),
                "{}: no truth is known of a rig that heats up from rest",
                self.name
            );
            recording.put_rest_before();
        }
        for (which, faults) in truths.iter().enumerate() {
            let training = match (&other, self.train) {
                (Some(other), _) => Training::Other(Box::new(other.clone())),
                (None, Some([from, to])) => {
                    Training::Own(recording.at(from)..recording.at(to), "as told".into())
                }
                (None, None) if self.from_rest => Training::Own(0..recording.len(), "all of it".into()),
                (None, None) => Training::find(&recording, &recording.heaters[which], config)?,
            };
            let done = diagnose(&recording, which, &training, faults, config, &ProgressBar::hidden())?;
            let score = score(&done.record, done.watched_from as f64 * recording.sample_time);
            let injected = match self.inject {
                0 => Vec::new(),
                onsets => inject::inject(&recording, &recording.heaters[which], &done, onsets),
            };
            let missed = self.bars.missed(&done, &score, &injected);
            let name = match recording.heaters.len() {
                1 => self.name.clone(),
                _ => format!("{}, heater {}", self.name, which + 1),
            };
            outcomes.push(Outcome { name, done, score, injected, missed });
        }
        Ok(outcomes)
    }
}

impl Bars {
    fn missed(&self, done: &Diagnosed, score: &Score, injected: &[Injected]) -> Vec<String> {
        let mut missed = Vec::new();
        for (seen, fault) in score.faults.iter().zip(done.record.faults.iter()) {
            let bar = if fault.verb == Verb::HeaterPower { self.heater } else { self.sensor };
            missed.extend(bar.unwrap_or_default().missed(seen));
        }
        if score.false_alarms > 0 {
            missed.push(format!("{} alarms while nothing was wrong", score.false_alarms));
        }
        let fits =
            self.fit.unwrap_or([f64::MIN; 2]).into_iter().zip([done.trained.fit, done.fit_on_the_rest]);
        missed.extend(
            fits.filter(|(least, fit)| fit < least)
                .map(|(least, fit)| format!("fit {fit:.1} % for {least} %")),
        );
        let least = self.seen.unwrap_or(0.0);
        let late = injected.iter().filter(|injected| injected.seen_pct < least);
        missed.extend(late.map(|i| format!("{:?}: {:.1} % seen in time for {least} %", i.kind, i.seen_pct)));
        missed
    }
}

impl Bar {
    fn missed(&self, seen: &Seen) -> Vec<String> {
        let place = format!("{} at {:.0} s", seen.fault, seen.at);
        let mut missed = Vec::new();
        for (what, limit, time) in [("alarm", self.alarm, seen.alarmed), ("name", self.named, seen.named)] {
            let Some(limit) = limit else { continue };
            match time {
                Some(time) if time <= limit + 1e-6 => {}
                Some(time) => missed.push(format!("{place}: {what} after {time:.0} s for {limit} s")),
                None => missed.push(format!("{place}: no {what}")),
            }
        }
        if let (Some(limit), Some(size), Some(truth)) = (self.size, seen.size, seen.size_true) {
            let error = 100.0 * (size / truth - 1.0).abs();
            if error > limit {
                missed.push(format!("{place}: size off by {error:.0} % for {limit} %"));
            }
        }
        if seen.endless {
            missed.push(format!("{place}: its alarm does not end"));
        } else if let (Some(limit), Some(tail)) = (self.tail, seen.tail)
            && tail > limit
        {
            missed.push(format!("{place}: alarm for {tail:.0} s after its end for {limit} s"));
        }
        missed
    }
}

/// All outcomes as text that is Markdown as well.
pub fn report(outcomes: &[Outcome]) -> String {
    let mut text = String::new();
    for outcome in outcomes {
        let trained = &outcome.done.trained;
        let rest = outcome.done.fit_on_the_rest;
        let rest =
            if rest.is_finite() && rest > 0.0 { format!(", {rest:.1} % on the rest") } else { String::new() };
        let _ = writeln!(
            text,
            "### {}\n\nFit, simulated: {:.1} % of the training{rest}.\n",
            outcome.name, trained.fit
        );
        let _ = writeln!(text, "```text\n{}", table(&outcome.score));
        for injected in &outcome.injected {
            let _ = writeln!(
                text,
                "{:<8} put in {} times: {:.1} % seen in time, {:.1} % named rightly within 60 samples",
                format!("{:?}", injected.kind),
                injected.onsets,
                injected.seen_pct,
                injected.named_pct
            );
        }
        let missed = if outcome.missed.is_empty() { "nothing".to_owned() } else { outcome.missed.join("; ") };
        let _ = writeln!(text, "Missed: {missed}.\n```\n");
    }
    text
}
