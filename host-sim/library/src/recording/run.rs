//! A recording diagnosed: learnt from where it is normal, watched from then on.

use std::ops::Range;

use anyhow::{Context, ensure};
use fdi_core::likelihood::Readiness;
use fdi_core::monitor::OBSERVED;
use fdi_core::{Celsius, Config, Mode, Monitor, Observation, Observed, Percent, Phase, Report, Tick};
use indicatif::ProgressBar;
use pt326_rig::fault::Fault;

use super::believed::Believed;
use super::leaps::Leap;
use super::training::{self, Trained};
use super::{Heater, Recording, normal};
use crate::experiment::{Origin, Record, Row, truth};

/// What is learnt from.
#[derive(Clone, Debug)]
pub enum Training {
    /// These samples of the recording itself; why they are trusted.
    Own(Range<usize>, String),
    /// These samples, which seem to be normal; why, and leaps of T1 that are taken out of them first. They are judged as all others are.
    Found(Range<usize>, String, Vec<Leap>),
    /// All of another recording of the same rig.
    Other(Box<Recording>),
}

/// A recording, and what was made of it.
#[derive(Clone, Debug)]
pub struct Diagnosed {
    /// What was learnt.
    pub trained: Trained,
    /// How much of the recording the model explains where it was not learnt from, when it is simulated, %; NaN: nothing is left.
    pub fit_on_the_rest: f64,
    /// The first sample that was watched.
    pub watched_from: usize,
    /// Every tick from the beginning of the training or, if that was elsewhere, of the recording; of a very long one as many as [`MOST_ROWS`], and
    /// those around which something else is said.
    pub record: Record,
    /// One tick in so many of a very long one.
    pub thinned: usize,
    /// What was not judged: learnt from, or seen before it was known how the rig began; s.
    pub unjudged: Vec<Range<f64>>,
    /// Samples that no rig can have given, in the order of [`fdi_core::monitor::OBSERVED`].
    pub implausible: [u32; OBSERVED.len()],
    /// How often the monitor has begun anew: see [`Readiness::Restarted`].
    pub restarts: u32,
}

impl Diagnosed {
    /// For how long it was judged, s: behind what was learnt from, where it was known how the rig began.
    pub fn judged(&self) -> f64 {
        let from = self.watched_from as f64 * self.record.sample_time;
        let unjudged = self.unjudged.iter().map(|part| (part.end - part.start.max(from)).max(0.0));
        (self.record.end() - from - unjudged.sum::<f64>()).max(0.0)
    }

    /// What is said before all else where nothing could be judged.
    pub fn nothing_judged(&self) -> Option<&'static str> {
        let is_nothing = self.judged() < self.record.sample_time;
        is_nothing.then_some("Nothing could be judged: all of it was learnt from, has gaps, or ends before it is known how the rig began.")
    }
}

/// A row takes close to a kilobyte: of a longer recording not all are kept, unless there is a truth to hold each against.
pub const MOST_ROWS: usize = 250_000;

/// Learns, and watches; `faults` is what is known to have been wrong, in the recording's time.
///
/// # Errors
/// Why nothing can be learnt.
pub fn diagnose(
    recording: &Recording,
    which: usize,
    training: &Training,
    faults: &[Fault],
    config: &Config,
    progress: &ProgressBar,
) -> anyhow::Result<Diagnosed> {
    let heater = recording.heaters.get(which).context("there is no such heater")?;
    let samples = &heater.samples;
    let (trained, mut monitor, part) = learn(recording, which, training, config)?;
    let learnt = if let Training::Found(part, ..) = training { part } else { &part };
    let rest = learnt.len()..samples.len() - learnt.start;
    let fit_on_the_rest = training::fit(&trained.monitor, &samples[learnt.start..], rest);
    let thinned = if faults.is_empty() { (samples.len() - part.start).div_ceil(MOST_ROWS).max(1) } else { 1 };
    let (mut rows, mut restarts) = (Rows { kept: Vec::new(), last: None, every: thinned }, 0);
    let mut unjudged: Vec<Range<usize>> = Vec::new();
    let (before, believed) = (monitor.implausible(), Believed::of(heater));
    progress.set_length((samples.len() - part.start) as u64);
    let stretches = recording.stretches();
    let mut stretches = stretches.iter().skip_while(|stretch| stretch.end <= part.end).peekable();
    for (k, sample) in samples.iter().enumerate().skip(part.start) {
        if k >= part.end {
            // Where the logger wrote nothing there is nothing to judge, and what was before says little of what comes behind.
            stretches.next_if(|stretch| stretch.end <= k);
            let Some(stretch) = stretches.peek().filter(|stretch| stretch.contains(&k)) else { continue };
            if k == stretch.start && k > 0 {
                monitor.resume();
            }
        }
        let (seen, report) = monitor.step(&Observed { learn: part.contains(&k), ..*sample });
        if report.likelihood.readiness == Readiness::Restarted {
            restarts += 1;
            monitor = trained.monitor.clone();
            monitor.resume();
        }
        if part.contains(&k) || report.likelihood.expected[1].is_none() {
            match unjudged.last_mut() {
                Some(last) if last.end >= k => last.end = k + 1,
                _ => unjudged.push(k..k + 1),
            }
        }
        let shift = k as i64 - i64::from(seen.index);
        let time = recording.sample_time * k as f64;
        rows.push(k, row((&trained, &believed), heater, seen, report, shift, truth(faults, time)));
        if k.is_multiple_of(PROGRESS) {
            progress.set_position((k - part.start) as u64);
        }
    }
    rows.kept.extend(rows.last.take());
    progress.finish_and_clear();
    let counts = monitor.implausible().into_iter().zip(before);
    let mut counts = counts.map(|(now, before)| now.saturating_sub(before));
    let implausible = std::array::from_fn(|_| counts.next().unwrap_or(0));
    let origin = Origin::Watched { file: recording.file.clone() };
    let config =
        Config { sample_time: fdi_core::Seconds(recording.sample_time as f32), ..trained.config.clone() };
    let paper = heater.is_ours;
    let baseline = monitor.baseline().filter(|_| paper).copied();
    let mut record = Record::new(origin, &config, faults, rows.kept, baseline);
    record.setpoint = f64::NAN;
    let seconds = |k: usize| recording.sample_time * k as f64;
    let unjudged = unjudged.into_iter().map(|part| seconds(part.start)..seconds(part.end)).collect();
    let watched_from = part.end;
    Ok(Diagnosed { trained, fit_on_the_rest, watched_from, record, thinned, unjudged, implausible, restarts })
}

/// What was learnt, the monitor that goes on with the recording, and the samples of it that were learnt from.
fn learn(
    recording: &Recording,
    which: usize,
    training: &Training,
    config: &Config,
) -> anyhow::Result<(Trained, Monitor, Range<usize>)> {
    let heater = recording.heaters.get(which).context("there is no such heater")?;
    let samples = &heater.samples;
    match training {
        Training::Own(part, _) => {
            ensure!(
                part.end <= samples.len(),
                "the training ends after the recording, which has {} samples",
                samples.len()
            );
            let trained = training::train(recording, heater, &samples[part.clone()], config)?;
            let monitor = trained.monitor.clone();
            Ok((trained, monitor, part.clone()))
        }
        Training::Found(part, _, leaps) => {
            let normal = normal::without(leaps, &samples[part.clone()], recording.units.celsius.into());
            let trained = training::train(recording, heater, &normal, config)?;
            let monitor = trained.monitor.clone();
            // The paper's signatures learn what is normal by themselves.
            let learnt = if heater.is_ours { part.clone() } else { 0..0 };
            Ok((trained, monitor, learnt))
        }
        Training::Other(other) => {
            let theirs =
                other.heaters.get(which).with_context(|| format!("{} has no such heater", other.file))?;
            ensure!(
                theirs.inputs == heater.inputs && other.sample_time == recording.sample_time,
                "{} has other thermistors or another sample time than {}",
                other.file,
                recording.file
            );
            let mut trained = training::train(other, theirs, &theirs.samples, config)?;
            trained.monitor.resume();
            let monitor = trained.monitor.clone();
            Ok((trained, monitor, 0..0))
        }
    }
}

/// Samples between two looks at the progress.
const PROGRESS: usize = 4096;

/// The rows that are kept.
struct Rows {
    kept: Vec<Row>,
    /// The last one, where it was not kept.
    last: Option<Row>,
    every: usize,
}

impl Rows {
    /// One in so many, and both where what is said changes.
    fn push(&mut self, k: usize, row: Row) {
        let said = |row: &Row| {
            let likelihood = &row.report.likelihood;
            (likelihood.alarm, likelihood.readiness, likelihood.finding.map(|finding| finding.class))
        };
        let before = self.last.as_ref().or(self.kept.last());
        if before.is_some_and(|before| said(before) != said(&row)) {
            self.kept.extend(self.last.take());
            self.kept.push(row);
        } else if k.is_multiple_of(self.every) {
            self.last = None;
            self.kept.push(row);
        } else {
            self.last = Some(row);
        }
    }
}

/// A tick by the recording's own count, without what was fed in place of a thermistor that there is not.
fn row(
    (trained, believed): (&Trained, &Believed),
    heater: &Heater,
    mut seen: Observation,
    mut report: Report,
    shift: i64,
    truth: u8,
) -> Row {
    let shifted = |index: u32| (i64::from(index) + shift).max(0) as u32;
    seen.index = shifted(seen.index);
    report.tick = seen.index;
    let finding = &mut report.likelihood.finding;
    *finding =
        finding.filter(|finding| believed.believes(finding, &seen.sample, &report.likelihood.expected));
    if let Some(finding) = finding {
        trained.calibrate(finding);
        // A mean of several samples begins nowhere between them: what it names has begun by now.
        finding.onset = shifted(finding.onset).min(seen.index);
    }
    let nothing =
        fdi_core::Reading { celsius: fdi_core::Celsius(f32::NAN), validity: fdi_core::Validity::Missing };
    if !heater.inputs.t0 {
        seen.sample.t0 = nothing;
        report.likelihood.expected[0] = None;
    }
    if !heater.inputs.t2 {
        seen.sample.t2 = nothing;
        report.likelihood.expected[2] = None;
    }
    if !heater.is_ours {
        report =
            Report { tick: report.tick, y1: report.y1, likelihood: report.likelihood, ..Report::default() };
    }
    Row { applied: seen.power, tick: as_tick(&seen), report, truth }
}

/// A tick of an instrument that had seen the same, as tables and figures want one. What the set-point was nobody knows.
pub fn as_tick(seen: &Observation) -> Tick {
    Tick {
        index: seen.index,
        sample: seen.sample,
        virtual_t1: None,
        setpoint: Celsius(f32::NAN),
        pid: seen.power,
        prbs: Percent(0.0),
        drive: seen.power,
        mode: match seen.phase {
            Phase::Off | Phase::Tripped => Mode::Off,
            Phase::Heated => Mode::Settle { steady: 0 },
            Phase::Learning => Mode::Learn { accepted: 0 },
            Phase::Watched => Mode::Monitor,
        },
        tuning: None,
        learn: seen.learn,
        blocked: None,
        forget: seen.forget,
        shelve: seen.shelve,
        known: seen.known,
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::Finding;
    use fdi_core::likelihood::FaultClass;

    use super::*;
    use crate::experiment::scenario::Scenario;

    /// One row in ten, and each on either side of what changes.
    #[test]
    fn rows_around_which_something_else_is_said_are_kept() {
        let scenario = Scenario { duration: 8.0, ..Scenario::default() };
        let run = crate::experiment::run(&Config::default(), &scenario, 1).unwrap();
        let mut rows = Rows { kept: Vec::new(), last: None, every: 10 };
        for (k, mut row) in run.rows.into_iter().take(60).enumerate() {
            let finding = Finding { class: FaultClass::T2Offset, confidence: 0.9, magnitude: None, onset: 0 };
            row.report.likelihood.finding = (23..37).contains(&k).then_some(finding);
            rows.push(k, row);
        }
        let kept: Vec<u32> = rows.kept.iter().map(|row| row.tick.index).collect();
        assert_eq!(kept, [0, 10, 20, 22, 23, 30, 36, 37, 40, 50]);
    }
}
