//! `pt326 run`: one experiment, its table, its files.

use std::path::{Path, PathBuf};

use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::schema::Explained;
use fdi_core::{Command, Config, Instrument, RawSample, Report, Tick};
use indicatif::ProgressBar;

use super::experiment::ExperimentArgs;
use super::results::Folder;
use super::terminal::{coloured, print, progress};
use pt326_host::experiment::scenario::Scenario;
use pt326_host::experiment::{self, Backend, Record};
use pt326_host::record::summary::Summary;
use pt326_host::record::table;

/// Arguments of `run`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
docs/experiment.md explains the table that is printed; report.html has it again, with figures.

Results of an earlier run in the folder are not lost: unless the new run has the same trace, they are moved to \
earlier-1, earlier-2 and so on in the same folder.

Examples:
  pt326 run --seed 7 --disturbance lively --fault-size small --out small
  pt326 config > tuning.toml                every setting: edit it, then
  pt326 run --config tuning.toml
  pt326 scenario > my.toml                  the rig, the faults, the user: edit it, then
  pt326 run --scenario my.toml")]
pub struct RunArgs {
    /// Seed of the rig's noise and of the phase of the excitation: the same seed gives the same run.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    #[command(flatten)]
    /// The experiment.
    pub experiment: ExperimentArgs,
    /// Folder for trace.csv, summary.json, the figures and report.html; made if need be.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

impl Default for RunArgs {
    fn default() -> Self {
        Self { seed: 1, experiment: ExperimentArgs::default(), out: "out".into() }
    }
}

/// Runs the experiment, writes everything into `--out` and prints what happened.
///
/// # Errors
/// A bad file or value, or a folder that can't be written.
pub fn run(args: &RunArgs) -> anyhow::Result<()> {
    let (config, scenario) = args.experiment.load()?;
    carry_out(&config, &scenario, args.seed, &args.out)
}

/// The same, of an experiment that is given as data.
///
/// # Errors
/// A setting out of bounds, or a folder that can't be written.
pub fn carry_out(config: &Config, scenario: &Scenario, seed: u64, dir: &Path) -> anyhow::Result<()> {
    let folder = Folder::open(dir)?;
    let config = experiment::with_prbs_phase(config, seed);
    let instrument = Instrument::new(&config)?;
    let ticks = scenario.duration / experiment::as_written(config.sample_time.0);
    let mut watched = Watched { instrument, bar: progress(ticks as u64, "ticks") };
    let record = experiment::run_on(&mut watched, &config, scenario, seed);
    watched.bar.finish_and_clear();
    tell(&record, &folder, "")
}

/// Writes the files of a run and prints `remarks` and what it showed, in this order: whoever reads no further than the
/// first line still has the files.
///
/// # Errors
/// A file that can't be written.
pub fn tell(record: &Record, folder: &Folder, remarks: &str) -> anyhow::Result<()> {
    let summary = Summary::new(record);
    let written = folder.write(record, &summary, None)?;
    print(&format!("{remarks}{}\n{written}", coloured(&table::of_run(record, &summary))))
}

/// The instrument, and a bar that shows how far the run has come.
struct Watched {
    instrument: Instrument,
    bar: ProgressBar,
}

impl Backend for Watched {
    fn control(&mut self, raw: RawSample) -> Tick {
        Backend::control(&mut self.instrument, raw)
    }

    fn diagnose(&mut self, tick: &Tick) -> Report {
        self.bar.inc(1);
        Backend::diagnose(&mut self.instrument, tick)
    }

    fn command(&mut self, command: Command) -> Result<(), String> {
        Backend::command(&mut self.instrument, command)
    }

    fn baseline(&self) -> Option<Baseline> {
        Backend::baseline(&self.instrument)
    }

    fn explained(&self, report: &Report) -> Option<Explained> {
        Backend::explained(&self.instrument, report)
    }
}
