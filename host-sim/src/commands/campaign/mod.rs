//! `pt326 campaign`: many runs of many kinds, both diagnoses side by side, in numbers with their uncertainty.

mod definition;
#[cfg(feature = "parquet")]
mod parquet;

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use anyhow::{Context, ensure};
use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};

use super::results::Folder;
use super::terminal::{coloured, print};
pub use definition::DefinitionArgs;
use definition::built_in;
use pt326_host::campaign::cell::Cell;
use pt326_host::campaign::output;
use pt326_host::campaign::results::Results;
use pt326_host::campaign::runner::{Progress, Remaining};
use pt326_host::campaign::store::{self, Header, Shard, Store};
use pt326_host::recording::harness;

/// Arguments of `campaign`.
#[derive(Clone, Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "Examples:
  pt326 campaign --quick                      every kind of run a few times: less than a minute
  pt326 campaign --full --out out/full        the numbers to report
  pt326 campaign --physics                    slow faults, and rigs that no model has
  pt326 campaign define > my.toml             the default campaign, commented: edit, then
  pt326 campaign my.toml
  pt326 campaign --only nominal/ --config tuning.toml --seeds-from 1
  pt326 campaign --quick --sweep diagnosis.sigma_factor=2.5,3,3.5,4
  pt326 campaign --seeds-from 1 --vary likelihood.naming=0.8,0.98 --vary likelihood.least_power=0
  pt326 campaign --ablate --out out/ablation  what is each number of the likelihood diagnosis worth?
  pt326 campaign --shard 2/8 --out part       one of eight jobs of a cluster, then
  pt326 campaign merge part/runs.*.jsonl
  pt326 campaign search --runs 1000000        heat that should not be: the worst are kept
  pt326 campaign records DIR                  recordings of real heaters
  pt326 campaign show \"nominal/mfs1\" --run 17   that run with its trace, figures and report

A campaign that was interrupted (Ctrl-C) goes on where it stopped when the same command is given again. Results of \
another definition, other settings or another build of this program are refused; --fresh deletes them.

Seeds 1 to 99999 are for tuning. Numbers to be reported come from seeds of 1000000 and more, which nothing may be tuned on."
)]
pub struct CampaignArgs {
    /// What else.
    #[command(subcommand)]
    pub command: Option<CampaignCommand>,
    #[command(flatten)]
    /// A campaign.
    pub campaign: CampaignRunArgs,
}

/// What else can be done.
#[derive(Clone, Debug, Subcommand)]
pub enum CampaignCommand {
    /// Print a built-in campaign as commented TOML; left out: the default one.
    Define {
        /// The campaign on physics that no model has.
        #[arg(long)]
        physics: bool,
        /// The runs of `--ablate`.
        #[arg(long, conflicts_with = "physics")]
        ablate: bool,
    },
    /// Put the results of all parts together, and write what a whole campaign writes.
    Merge(MergeArgs),
    /// Repeat one run of a cell, with its trace, figures and report.
    Show(ShowArgs),
    /// Search for heat that should not be: random plants, faults, commands and settings, judged by the true temperatures.
    Search(SearchArgs),
    /// Diagnose the recordings of a folder, and compare the findings with what is expected of each (docs/records.md).
    Records(RecordsArgs),
}

/// Which cases.
#[derive(Clone, Debug, Args)]
pub struct SearchArgs {
    /// How many.
    #[arg(long, default_value_t = 3000)]
    pub runs: u64,
    /// The first.
    #[arg(long, default_value_t = 1)]
    pub seeds_from: u64,
    /// Folder for the ten worst and for false trips, made if need be.
    #[arg(long, value_name = "DIR", default_value = "out/search")]
    pub out: PathBuf,
}

/// Which recordings.
#[derive(Clone, Debug, Args)]
pub struct RecordsArgs {
    /// The folder: a TOML a recording, or without any the recordings that docs/evidence/records.md names.
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// Settings of the diagnosis, TOML; see `pt326 config`.
    #[arg(long, value_name = "FILE.toml")]
    pub config: Option<PathBuf>,
    /// Folder for records.md, made if need be.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// Arguments of a campaign.
#[derive(Clone, Debug, Args)]
pub struct CampaignRunArgs {
    #[command(flatten)]
    /// Which.
    pub definition: DefinitionArgs,
    /// Folder for the results.
    #[arg(long, value_name = "DIR", default_value = "out/campaign")]
    pub out: PathBuf,
    /// Delete earlier results of the same shard in the folder and begin anew.
    #[arg(long)]
    pub fresh: bool,
    /// Only this part of the runs, such as 2/8.
    #[arg(long, value_name = "PART/PARTS", default_value = "1/1")]
    pub shard: Shard,
    /// Number of threads. Default: all cores.
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    pub threads: usize,
    #[command(flatten)]
    /// What else.
    pub more: MoreArgs,
}

/// What is written that not everybody wants.
#[derive(Clone, Debug, Args)]
pub struct MoreArgs {
    /// Write runs.parquet as well: the rows of runs.csv, with types and in a third of the bytes. It takes a program built
    /// with `--features parquet`.
    #[arg(long)]
    pub parquet: bool,
}

/// Arguments of `campaign merge`.
#[derive(Clone, Debug, Args)]
pub struct MergeArgs {
    /// Results files of the shards, runs.*.jsonl.
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Folder for the results.
    #[arg(long, value_name = "DIR", default_value = "out/campaign")]
    pub out: PathBuf,
    #[command(flatten)]
    /// What else.
    pub more: MoreArgs,
}

/// Arguments of `campaign show`.
#[derive(Clone, Debug, Args)]
pub struct ShowArgs {
    /// Name of the cell, as in the table.
    pub cell: String,
    #[command(flatten)]
    /// The campaign.
    pub definition: DefinitionArgs,
    /// Number of the run in the cell, from 0.
    #[arg(long, default_value_t = 0)]
    pub run: u64,
    /// Folder for trace.csv, summary.json, the figures and report.html.
    #[arg(long, value_name = "DIR", default_value = "out/campaign/run")]
    pub out: PathBuf,
}

/// Exit code of a program that Ctrl-C has stopped.
const INTERRUPTED: i32 = 130;

impl MoreArgs {
    /// Before hours of work are done.
    ///
    /// # Errors
    /// What is asked for cannot be written.
    fn check(&self, shard: Shard) -> anyhow::Result<()> {
        ensure!(
            !self.parquet || cfg!(feature = "parquet"),
            "--parquet: this pt326 was built without it; `cargo install --path host-sim --features parquet` builds it with"
        );
        ensure!(
            !self.parquet || shard == Shard::WHOLE,
            "--parquet: a part writes no tables; give it to `pt326 campaign merge`"
        );
        Ok(())
    }
}

/// Runs the command.
///
/// # Errors
/// A bad definition, results that don't fit, a folder that can't be written.
pub fn run(args: &CampaignArgs) -> anyhow::Result<()> {
    match &args.command {
        None => run_campaign(&args.campaign),
        Some(CampaignCommand::Define { physics, ablate }) => print(built_in(*physics, *ablate)),
        Some(CampaignCommand::Merge(args)) => merge(args),
        Some(CampaignCommand::Show(args)) => show(args),
        Some(CampaignCommand::Search(args)) => search_for_heat(args),
        Some(CampaignCommand::Records(args)) => records(args),
    }
}

fn search_for_heat(args: &SearchArgs) -> anyhow::Result<()> {
    let bar = super::terminal::progress(args.runs, "runs");
    let found = pt326_host::search::search(args.seeds_from..args.seeds_from.saturating_add(args.runs), &bar)?;
    bar.finish_and_clear();
    std::fs::create_dir_all(&args.out)?;
    for (case, _) in found.worst.iter().chain(found.false_trips.iter().take(10)) {
        std::fs::write(args.out.join(format!("{}.toml", case.number)), toml::to_string(case)?)?;
    }
    print(&found.to_string())
}

fn run_campaign(args: &CampaignRunArgs) -> anyhow::Result<()> {
    args.more.check(args.shard)?;
    let (campaign, config) = args.definition.load()?;
    let cells = campaign.expand(&config)?;
    let header = Header::new(&campaign, &config, args.shard)?;
    Folder::open(&args.out)?;
    let path = args.out.join(args.shard.file_name());
    let waits =
        || eprintln!("Another program is writing {}: this one waits until it has ended.", path.display());
    let store = Store::open(&path, &header, args.fresh, waits)?;
    let remaining = Remaining::new(&cells, args.shard, store);
    let Progress { finished, of } = run_until_interrupted(remaining, args.threads)?;
    if finished < of {
        eprintln!(
            "Interrupted: {finished} of {of} runs are finished and kept in {}. The same command goes on from there.",
            path.display()
        );
        std::process::exit(INTERRUPTED);
    }
    if args.shard == Shard::WHOLE {
        return conclude(&[path], &args.out, &args.more);
    }
    print(&format!(
        "Part {} of {} is finished: {}\nWhen all are: pt326 campaign merge {}/runs.*.jsonl\n",
        args.shard.part,
        args.shard.of,
        path.display(),
        args.out.display()
    ))
}

/// Ctrl-C lets the runs that are under way end; a second one ends the program at once.
fn run_until_interrupted(remaining: Remaining, threads: usize) -> anyhow::Result<Progress> {
    let stop = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        if asked.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED);
        }
    })?;
    let bar = progress(&remaining)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let (began, hours) = (Instant::now(), remaining.seconds() / 3600.0);
    let (tenths, is_seen) = (AtomicU64::new(0), std::io::stderr().is_terminal());
    let advance = |ticks: f64| {
        bar.inc(ticks as u64);
        let now = 10 * bar.position() / bar.length().unwrap_or(1).max(1);
        if tenths.fetch_max(now, Ordering::Relaxed) < now && !is_seen {
            eprintln!("{now}0 % after {:.0} s", began.elapsed().as_secs_f64());
        }
    };
    let progress = pool.install(|| remaining.run(&stop, advance))?;
    bar.finish_and_clear();
    let took = began.elapsed().as_secs_f64();
    if progress.finished == progress.of && hours > 0.0 {
        eprintln!("{hours:.1} h of the rig in {took:.0} s: {:.1} h a second", hours / took);
    }
    Ok(progress)
}

/// A bar that counts simulated ticks, since runs differ in length. Where it can't be seen, each tenth is told.
fn progress(remaining: &Remaining) -> anyhow::Result<ProgressBar> {
    let bar = ProgressBar::new(remaining.ticks() as u64);
    bar.set_style(
        ProgressStyle::with_template("{bar:40} {percent} % of {msg}, {eta} left").context("progress bar")?,
    );
    let before = match remaining.finished() {
        0 => String::new(),
        n => format!(" ({n} finished before)"),
    };
    bar.set_message(format!("{} runs, {:.0} h{before}", remaining.count(), remaining.seconds() / 3600.0));
    Ok(bar)
}

fn records(args: &RecordsArgs) -> anyhow::Result<()> {
    let config = pt326_host::settings::read(args.config.as_deref())?;
    Folder::open(&args.out)?;
    let mut text = String::new();
    for definition in harness::Definition::all(&args.dir)? {
        let said = match definition.run(&args.dir, &config) {
            Ok(outcomes) => harness::report(&outcomes),
            Err(error) => format!("### {}\n\nNot diagnosed: {error:#}.\n\n", definition.name),
        };
        print(&said)?;
        text += &said;
    }
    let path = args.out.join("records.md");
    std::fs::write(&path, text).with_context(|| format!("can't write {}", path.display()))?;
    print(&format!("Written to {}\n", path.display()))
}

fn merge(args: &MergeArgs) -> anyhow::Result<()> {
    args.more.check(Shard::WHOLE)?;
    Folder::open(&args.out)?;
    conclude(&args.files, &args.out, &args.more)
}

/// Prints and writes what a whole campaign showed. It always goes by the files, so that it does not matter how the runs
/// came into them.
fn conclude(files: &[PathBuf], out: &Path, more: &MoreArgs) -> anyhow::Result<()> {
    let store::Whole { campaign, cells, rows } = store::read(files)?;
    let results = Results::new(&campaign, &cells, &rows);
    print(&coloured(&output::table::of(&results)))?;
    let mut written = output::write(&results, &cells, &rows, out)?;
    if more.parquet {
        #[cfg(feature = "parquet")]
        parquet::write_runs(&cells, &rows, &out.join("runs.parquet"))?;
        written += ", runs.parquet";
    }
    print(&format!("\nWritten to {}: {written}\n", out.display()))
}

fn show(args: &ShowArgs) -> anyhow::Result<()> {
    let (campaign, config) = args.definition.load()?;
    let cells = campaign.expand(&config)?;
    let cell = cells.iter().find(|cell| cell.label() == args.cell || cell.name == args.cell);
    let cell = cell.with_context(|| no_such_cell(&args.cell, &cells))?;
    ensure!(
        args.run < cell.runs,
        "--run {}: the cell {} has {} of them here, from 0 to {}; --full or --scale give more",
        args.run,
        cell.label(),
        cell.runs,
        cell.runs - 1
    );
    let seed = cell.seed(args.run);
    let (config, scenario) = cell.draw(seed);
    super::run::carry_out(&config, &scenario, seed, &args.out)
}

fn no_such_cell(name: &str, cells: &[Cell]) -> String {
    let near: Vec<String> =
        cells.iter().filter(|cell| cell.name.contains(name)).map(Cell::label).take(12).collect();
    match near.as_slice() {
        [] => format!("no cell is named {name}; `pt326 campaign define` prints their names"),
        near => format!("no cell is named {name}; names that contain it: {}", near.join(", ")),
    }
}
