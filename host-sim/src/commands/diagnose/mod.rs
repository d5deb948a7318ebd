//! `pt326 diagnose`: the diagnosis on a recording.

mod explain;
mod lines;
mod live;

use std::fmt::Write as _;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, ensure};
use fdi_core::Config;
use fdi_core::monitor::OBSERVED;
use pt326_rig::fault::Fault;

use super::results::{FILES, Folder};
use super::terminal::{in_words, print, progress};
use pt326_host::record::summary::Summary;
use pt326_host::recording::report::{Told, learnt, table as table_of};
use pt326_host::recording::run::{Diagnosed, Training, diagnose};
use pt326_host::recording::stamp::Unit;
use pt326_host::recording::{Reading, Recording, score, truth};
use pt326_host::{recording, settings};

/// Arguments of `diagnose`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Roles of --map: t1 (the heater's thermistor) and power are needed. These are used if they are there: time, t0 (the room), t2 (behind T1), known (the \
power of a second heater beside), fan (its level, %), supply (share of the nominal voltage), session (when this number changes, the logger began anew). \
Traces of this project, logs of its boards (the page's *Save log*, or `pt326 board --record`), TCLab, TCLab's historian and Klipper's log are known by their header. In logs that name each value (temp=93.1, JSON, Marlin's answers) each name is a column. Other columns are recognized by their names; the first \
printed line says how. Several heaters are diagnosed one after the other.

Times are numbers (seconds, or what --time-unit says), clocks or dates; 5/1/2024 is in May. Times count from the first sample. If they fall \
back or leap, another session begins.

Without T0 a constant is learnt in its place, and T0 is not diagnosed. Without T2, faults of T1, of the heater and of the air are told apart only by \
how fast T1 changes. docs/records.md begins with an example.

Examples:
  pt326 diagnose faults_0.csv --train-on prbs.csv
  pt326 diagnose box.csv --map time=t --map t1=T_box --map power=PWM --full-power 255 --train 0:1800
  pt326 diagnose board.log
  pt326 diagnose faults_0.csv --train-on prbs.csv --heater 1 --truth t1_offset=dout1_degC
  my-logger | pt326 diagnose - --live --train-on normal.csv")]
pub struct DiagnoseArgs {
    /// The recording, CSV or a known kind of log; `-` is standard input.
    #[arg(value_name = "RECORD")]
    pub file: PathBuf,
    #[command(flatten)]
    /// How to read it.
    pub reading: ReadingArgs,
    /// The only heater to diagnose, counted from 1, if the recording has several.
    #[arg(long, value_name = "N")]
    pub heater: Option<usize>,
    /// Learn from this part, in s from the first sample on; left out: a part that seems normal is looked for; of a board's log what the board learnt from is tried first.
    #[arg(long, value_name = "FROM:TO", conflicts_with = "train_on")]
    pub train: Option<String>,
    /// Learn from another recording of the same rig.
    #[arg(long, value_name = "RECORD")]
    pub train_on: Option<PathBuf>,
    /// Go on with a model that explains hardly anything.
    #[arg(long)]
    pub force: bool,
    /// The rig was cold and its heater off before the first sample.
    #[arg(long)]
    pub from_rest: bool,
    /// What was truly wrong: CLASS=COLUMN of the recording, or a file of events (CSV with do, sensor, size, at, for; or TOML with
    /// the faults of a scenario).
    #[arg(long, value_name = "TRUTH")]
    pub truth: Vec<String>,
    /// Say what was learnt, and what can be told apart with it.
    #[arg(long)]
    pub explain: bool,
    /// Read standard input continuously, one line per sample, and report findings as they come. If the lines have times, each sample is placed by its time.
    #[arg(long, requires = "train_on")]
    pub live: bool,
    /// With --live: report as JSON, one object per line.
    #[arg(long, requires = "live")]
    pub json: bool,
    /// Write the settings that a board would need.
    #[arg(long, value_name = "FILE.toml")]
    pub write_config: Option<PathBuf>,
    /// Settings of the diagnosis, TOML; see `pt326 config`.
    #[arg(long, value_name = "FILE.toml")]
    pub config: Option<PathBuf>,
    /// Folder for trace.csv, summary.json, the figures and report.html; of a second heater in heater-2.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// How a recording is read.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct ReadingArgs {
    /// Which column is what; left out: guessed from the header.
    #[arg(long, value_name = "ROLE=COLUMN")]
    pub map: Vec<String>,
    /// Sample time, s; left out: that of the time stamps.
    #[arg(long, value_name = "S")]
    pub ts: Option<f64>,
    /// Unit of times that are numbers: ns, ticks (of 100 ns), us, ms, s, min, h or d; left out: as their column's name says, or the numbers themselves. Of times such as 22:00 what the first number counts: h or min.
    #[arg(long, value_name = "UNIT")]
    pub time_unit: Option<String>,
    /// Resample time stamps even if they are nearly even; uneven ones are always resampled.
    #[arg(long)]
    pub resample: bool,
    /// The power that is 100 %, in the unit of its column; left out: guessed from the numbers (1, 100, 255, 1023 ..).
    #[arg(long, value_name = "POWER")]
    pub full_power: Option<f64>,
    /// The power of a row is what drove the heater up to it, such as a mean over the time since the row before. Left out: it drives the heater from
    /// that row on.
    #[arg(long)]
    pub power_before: bool,
    /// A power below zero cools (a Peltier element, a valve for cold water): it is taken for a second input, with a gain of its own.
    #[arg(long)]
    pub cooling: bool,
    /// For temperatures in another unit: how many degC one unit counts for.
    #[arg(long, value_name = "DEGC")]
    pub degc: Option<f64>,
    /// Whether a fan moves the air. Without one, the air flow and dirt that it carries are not considered. Left out: as the known format says, or whether
    /// a recognized column is called fan; with --map, yes.
    #[arg(long, value_name = "BOOL")]
    pub fan: Option<bool>,
}

impl ReadingArgs {
    /// The same for the library.
    ///
    /// # Errors
    /// A number that cannot be.
    pub fn reading(&self) -> anyhow::Result<Reading> {
        for (name, value) in [("--ts", self.ts), ("--full-power", self.full_power), ("--degc", self.degc)] {
            let value = value.unwrap_or(1.0);
            ensure!(value > 0.0 && value.is_finite(), "{name} is {value}, expected a number above 0");
        }
        Ok(Reading {
            map: self.map.clone(),
            sample_time: self.ts,
            time_unit: self.time_unit.as_deref().map(Unit::parse).transpose().context("--time-unit")?,
            resample: self.resample,
            full_power: self.full_power,
            celsius: self.degc,
            fan: self.fan,
            power_before: self.power_before,
            cooling: self.cooling,
            untimed: false,
        })
    }
}

/// Runs the command.
///
/// # Errors
/// A bad file or value, a recording that nothing can be learnt from, or a folder that can't be written.
pub fn run(args: &DiagnoseArgs) -> anyhow::Result<ExitCode> {
    let config = settings::read(args.config.as_deref())?;
    let how = args.reading.reading()?;
    if args.live {
        return live::run(args, &how, &config).map(|()| ExitCode::SUCCESS);
    }
    let (file, text) = recording::text::text_of(&args.file)?;
    let other = args.train_on.as_deref().map(recording::text::text_of).transpose()?;
    let (mut recording, other) = Recording::with_other((file, &text), other, &how)?;
    let truths = recording.heaters.iter().map(|heater| truth::read(&args.truth, &text, &recording, heater));
    let mut truths: Vec<Vec<Fault>> = truths.collect::<anyhow::Result<_>>()?;
    if args.from_rest {
        let rest = recording.put_rest_before();
        truths.iter_mut().flatten().for_each(|fault| fault.at += rest);
    }
    let mut remarks: String = recording.remarks.iter().map(|remark| format!("{remark}\n")).collect();
    let asked = |which: &usize| args.heater.is_none_or(|number| number == which + 1);
    let count = recording.heaters.len();
    ensure!((0..count).any(|which| asked(&which)), "--heater: the recording has heaters 1 to {count}");
    let folder = folder(args);
    let mut refusals = Vec::new();
    let (mut is_any, mut is_judged) = (false, false);
    for (which, faults) in truths.iter().enumerate().filter(|(which, _)| asked(which)) {
        let diagnosed = training(args, &recording, which, other.as_ref(), &config).and_then(|training| {
            let progress = progress(0, "samples");
            let done = diagnose(&recording, which, &training, faults, &config, &progress)?;
            Ok((training, done.trained.accepted(args.force, FORCED)?, done))
        });
        match diagnosed.with_context(|| format!("{}, {}", recording.file, recording.heaters[which].map)) {
            Ok((training, warning, done)) => {
                is_any = true;
                is_judged |= done.nothing_judged().is_none();
                let nothing = done.nothing_judged().map_or(String::new(), |said| format!("{said}\n"));
                print(&(nothing + &warning + &std::mem::take(&mut remarks)))?;
                let out =
                    if which == 0 { folder.clone() } else { folder.join(format!("heater-{}", which + 1)) };
                tell(args, &recording, which, &training, &done, &out)?;
            }
            Err(error) => refusals.push(error),
        }
    }
    // One heater that was never used does not hide what is found of another.
    for refusal in refusals {
        ensure!(is_any, refusal);
        print(&format!("\nNot diagnosed: {}\n", in_words(&refusal)))?;
    }
    Ok(if is_judged { ExitCode::SUCCESS } else { ExitCode::from(NOT_JUDGED) })
}

/// Where the results go: beside what is read, where that is among the results of a run, since these would be moved.
fn folder(args: &DiagnoseArgs) -> PathBuf {
    let within = |file: &Path| {
        let is_result = FILES.iter().any(|name| file.ends_with(name));
        Some(is_result && file.canonicalize().ok()?.parent()? == args.out.canonicalize().ok()?)
    };
    let is_there = [Some(&args.file), args.train_on.as_ref()]
        .into_iter()
        .flatten()
        .any(|file| within(file) == Some(true));
    if is_there { args.out.join("diagnosed") } else { args.out.clone() }
}

/// The exit code where nothing of the recording could be judged.
const NOT_JUDGED: u8 = 1;

/// How to go on with a model that is worth nothing.
const FORCED: &str = "Or take it as it is with --force";

/// What is learnt from.
fn training(
    args: &DiagnoseArgs,
    recording: &Recording,
    which: usize,
    other: Option<&Recording>,
    config: &Config,
) -> anyhow::Result<Training> {
    if let Some(other) = other {
        return Ok(Training::Other(Box::new(other.clone())));
    }
    match &args.train {
        Some(said) => Ok(Training::Own(part(said, recording)?, format!("{said} s is said to be normal"))),
        None if args.from_rest => {
            Ok(Training::Own(0..recording.len(), "all of it is taken for one heating up from rest".into()))
        }
        None => Training::find(recording, &recording.heaters[which], config),
    }
}

/// `FROM:TO` in s as samples.
fn part(said: &str, recording: &Recording) -> anyhow::Result<Range<usize>> {
    let parsed = said.split_once(':').and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
    let (from, to): (f64, f64) = parsed.with_context(|| format!("--train {said}: expected FROM:TO in s"))?;
    let end = recording.len() as f64 * recording.sample_time;
    ensure!(
        from >= 0.0 && from < to && to <= end + 1e-6,
        "--train {said}: expected 0 <= FROM < TO <= {end} s"
    );
    Ok(recording.at(from)..recording.at(to))
}

/// Writes the files of a heater, and prints what was found.
fn tell(
    args: &DiagnoseArgs,
    recording: &Recording,
    which: usize,
    training: &Training,
    done: &Diagnosed,
    out: &Path,
) -> anyhow::Result<()> {
    let heater = &recording.heaters[which];
    let mut text = format!("\n{}\n{}\n", heater.map, because(training));
    text += &explain::missing(heater.inputs);
    text += &explain::learnt(recording, heater, training, done);
    if args.explain {
        text += &table_of(&learnt(recording, heater, &done.trained));
        text += &explain::told_apart(recording, heater, training, done);
    }
    text += &remarks(done);
    let from = done.watched_from as f64 * recording.sample_time;
    let score = (!done.record.faults.is_empty()).then(|| score::score(&done.record, from));
    let mut told = Told::new(recording, heater, training, done, score.as_ref());
    told.has_others = args.heater.is_none();
    let summary = Summary::new(&done.record);
    let written = Folder::open(out)?.write(&done.record, &summary, Some(&told.page()))?;
    if let Some(score) = &score {
        let json = serde_json::to_string_pretty(score)?;
        std::fs::write(out.join("score.json"), json + "\n").context("can't write score.json")?;
        let _ = write!(text, "\n{}", score::table(score));
    } else {
        text += &format!("\n{}", told.text());
    }
    if let Some(path) = args.write_config.as_deref().filter(|_| which == 0) {
        let toml = explain::settings_of(&done.trained.config);
        std::fs::write(path, toml).with_context(|| format!("can't write {}", path.display()))?;
        let _ = writeln!(text, "Settings written to {}", path.display());
    }
    print(&format!("{text}{written}"))
}

/// So many parts that were not judged are told one by one.
const MOST_PARTS: usize = 8;

/// What of the recording was not taken as it stands.
fn remarks(done: &Diagnosed) -> String {
    let mut text = String::new();
    let parts: Vec<String> = done
        .unjudged
        .iter()
        .take(MOST_PARTS)
        .map(|part| format!("{:.0} to {:.0} s", part.start, part.end))
        .collect();
    if !parts.is_empty() {
        let more = done.unjudged.len().saturating_sub(MOST_PARTS);
        let more = if more > 0 { format!(" and {more} more parts") } else { String::new() };
        let _ = writeln!(
            text,
            "Not judged, since it was learnt from or how the rig began was not known yet: {}{more}.",
            parts.join(", ")
        );
    }
    if let Some(fit) = done.trained.fit_with_power_before {
        let _ = writeln!(
            text,
            "T1 answers to the power of its own row, which seems to be what drove the heater up to that row. With --power-before the model explains \
             {fit:.1} % of T1 instead of {:.1} %.",
            done.trained.fit
        );
    }
    if let Some(odd) = odd(&done.implausible) {
        let _ = writeln!(text, "Samples that no rig gives, taken as not known: {odd}.");
    }
    if done.restarts > 0 {
        let times = done.restarts;
        let _ = writeln!(
            text,
            "Its memory held what is no number, {times} times: it began anew as it was trained."
        );
    }
    if done.thinned > 1 {
        let every = done.thinned;
        let _ = writeln!(
            text,
            "One sample in {every} is in the trace, and each around which something else is said."
        );
    }
    text
}

/// Of which quantity how many samples were none that a rig can give; nothing where there were none.
fn odd(implausible: &[u32; OBSERVED.len()]) -> Option<String> {
    let counted = OBSERVED.iter().zip(implausible).filter(|(_, count)| **count > 0);
    let counted: Vec<String> = counted.map(|(name, count)| format!("{count} of {name}")).collect();
    (!counted.is_empty()).then(|| counted.join(", "))
}

fn because(training: &Training) -> String {
    match training {
        Training::Own(_, why) | Training::Found(_, why, _) => format!("Learnt: {why}."),
        Training::Other(other) => format!("Learnt: all of {}, which is said to be normal.", other.file),
    }
}
