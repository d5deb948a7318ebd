//! `host-sim campaign`: many runs of many kinds, both diagnoses side by side, in numbers with their uncertainty.

pub mod cell;
pub mod confusion;
pub mod definition;
mod files;
pub mod heat;
mod markdown;
mod pictures;
pub mod results;
pub mod run;
mod runaway;
pub mod statistics;
pub mod store;
mod table;
pub mod target;
pub mod trade;

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use anyhow::{Context, ensure};
use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use crate::experiment::scenario::read_config;
use cell::Cell;
use definition::{CAMPAIGN_TOML, Campaign};
use results::Results;
use store::{Header, Shard, Store};

/// Arguments of `campaign`.
#[derive(Clone, Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "Examples:
  host-sim campaign --quick                      every kind of run a few times: less than a minute
  host-sim campaign --full --out out/full        the numbers to report
  host-sim campaign define > my.toml             the default campaign, commented: edit, then
  host-sim campaign my.toml
  host-sim campaign --only nominal/ --config tuning.toml --seeds-from 1
  host-sim campaign --quick --sweep diagnosis.sigma_factor=2.5,3,3.5,4
  host-sim campaign --seeds-from 1 --vary likelihood.margin=0,4 --vary likelihood.tolerated_sag=0
  host-sim campaign --shard 2/8 --out part       one of eight jobs of a cluster, then
  host-sim campaign merge part/runs.*.jsonl
  host-sim campaign show \"nominal/mfs1\" --run 17   that run with its trace, figures and report

An interrupted campaign goes on where it stopped when it is called again. Results of another definition, other
settings or another build of this program are refused: --fresh puts them away.

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
    /// Print the default campaign as commented TOML.
    Define,
    /// Put the results of shards together, and write what a whole campaign writes.
    Merge(MergeArgs),
    /// One run of a cell, with its trace, figures and report.
    Show(ShowArgs),
}

/// What describes a campaign.
#[derive(Clone, Debug, Args)]
pub struct DefinitionArgs {
    /// The campaign, TOML; see `host-sim campaign define`. Left out: the default one.
    #[arg(value_name = "FILE.toml")]
    pub file: Option<PathBuf>,
    /// Settings of the instrument, TOML; see `host-sim config`.
    #[arg(long, value_name = "FILE.toml")]
    pub config: Option<PathBuf>,
    /// Few runs: less than a minute (the default campaign has a quarter of its runs).
    #[arg(long, conflicts_with_all = ["full", "scale"])]
    pub quick: bool,
    /// All runs of the definition.
    #[arg(long, conflicts_with = "scale")]
    pub full: bool,
    /// So many times the runs of the definition.
    #[arg(long)]
    pub scale: Option<f64>,
    /// Only the cells whose name contains this.
    #[arg(long, value_name = "TEXT")]
    pub only: Option<String>,
    /// The first seed, in place of the definition's.
    #[arg(long, value_name = "SEED")]
    pub seeds_from: Option<u64>,
    /// Repeat everything for each of some values of a setting; of several settings, for all combinations.
    #[arg(long, value_name = "KEY=VALUE,VALUE")]
    pub sweep: Vec<String>,
    /// The same, but of several settings each by itself, beside all as they are: what is each worth?
    #[arg(long, value_name = "KEY=VALUE,VALUE")]
    pub vary: Vec<String>,
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
    /// Put earlier results in the folder away and begin anew.
    #[arg(long)]
    pub fresh: bool,
    /// Only this part of the runs, such as 2/8.
    #[arg(long, value_name = "PART/PARTS", default_value = "1/1")]
    pub shard: Shard,
    /// Number of threads. Default: all cores.
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    pub threads: usize,
}

/// Arguments of `campaign merge`.
#[derive(Clone, Debug, Args)]
pub struct MergeArgs {
    /// Results files of the shards, runs.*.jsonl.
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Folder for what comes of it.
    #[arg(long, value_name = "DIR", default_value = "out/campaign")]
    pub out: PathBuf,
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

/// Share of the runs that a campaign does without `--full`.
const USUAL: f64 = 0.25;
/// The same with `--quick`.
const QUICK: f64 = 0.05;

impl DefinitionArgs {
    /// Reads and checks what the arguments name.
    ///
    /// # Errors
    /// The file, line, key or value that is wrong.
    pub fn load(&self) -> anyhow::Result<(Campaign, fdi_core::Config)> {
        let config = read_config(self.config.as_deref())?;
        let mut campaign = Campaign::read(self.file.as_deref())?;
        let preset = match (self.quick, self.full) {
            (true, _) => QUICK,
            (_, true) => 1.0,
            _ if self.file.is_none() => USUAL,
            _ => 1.0,
        };
        campaign.scale *= self.scale.unwrap_or(preset);
        if let Some(only) = &self.only {
            campaign.only.clone_from(only);
        }
        campaign.seeds_from = self.seeds_from.unwrap_or(campaign.seeds_from);
        for text in &self.sweep {
            let (key, values) = parse_sweep(text)?;
            campaign.sweep.insert(key, values);
        }
        for text in &self.vary {
            let (key, values) = parse_sweep(text)?;
            campaign.vary.insert(key, values);
        }
        Ok((campaign, config))
    }
}

/// `key=value,value` with values as in TOML.
fn parse_sweep(text: &str) -> anyhow::Result<(String, Vec<toml::Value>)> {
    let expected = || format!("{text}: expected key=value,value such as diagnosis.sigma_factor=2.5,3,4");
    let (key, values) = text.split_once('=').with_context(expected)?;
    let table: toml::Table = format!("values = [{values}]").parse().with_context(expected)?;
    let values = table["values"].as_array().cloned().unwrap_or_default();
    ensure!(!values.is_empty() && !key.is_empty(), expected());
    Ok((key.trim().into(), values))
}

/// Runs the command.
///
/// # Errors
/// A bad definition, results that don't fit, a folder that can't be written.
pub fn run(args: &CampaignArgs) -> anyhow::Result<()> {
    match &args.command {
        None => run_campaign(&args.campaign),
        Some(CampaignCommand::Define) => Ok(print(CAMPAIGN_TOML)?),
        Some(CampaignCommand::Merge(args)) => merge(args),
        Some(CampaignCommand::Show(args)) => show(args),
    }
}

fn print(text: &str) -> std::io::Result<()> {
    std::io::Write::write_all(&mut std::io::stdout(), text.as_bytes())
}

fn run_campaign(args: &CampaignRunArgs) -> anyhow::Result<()> {
    let (campaign, config) = args.definition.load()?;
    let cells = campaign.expand(&config)?;
    let header = Header::new(&campaign, &config)?;
    std::fs::create_dir_all(&args.out)
        .with_context(|| format!("can't make the folder {}", args.out.display()))?;
    let path = args.out.join(args.shard.file_name());
    let store = Store::open(&path, &header, args.fresh)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads).build()?;
    pool.install(|| run_units(&cells, args.shard, store))?;
    if args.shard == Shard::WHOLE {
        return tell(&[path], &args.out);
    }
    println!(
        "Part {} of {} is finished: {}\nWhen all are: host-sim campaign merge {}/runs.*.jsonl",
        args.shard.part,
        args.shard.of,
        path.display(),
        args.out.display()
    );
    Ok(())
}

/// Runs all that is not finished, the longest first so that no core is left with one at the end.
fn run_units(cells: &[Cell], shard: Shard, store: Store) -> anyhow::Result<()> {
    let all =
        cells.iter().enumerate().flat_map(|(number, cell)| (0..cell.runs).map(move |run| (number, run)));
    let mut units: Vec<(usize, u64)> = all
        .enumerate()
        .filter(|(i, unit)| shard.holds(*i) && !store.finished.contains(unit))
        .map(|(_, unit)| unit)
        .collect();
    let length = |(cell, _): &(usize, u64)| cells[*cell].scenario.duration;
    units.sort_by(|a, b| length(b).total_cmp(&length(a)));
    let bar = progress(&units, store.finished.len(), |unit| length(unit) as u64)?;
    let store = Mutex::new(store);
    units.par_iter().with_max_len(1).try_for_each(|unit| {
        let row = run::run(&cells[unit.0], unit.0, unit.1)
            .with_context(|| format!("cell {:?}, run {}", cells[unit.0].name, unit.1))?;
        bar.inc(length(unit) as u64);
        store.lock().map_err(|_| anyhow::anyhow!("another thread has failed"))?.push(&row)
    })?;
    bar.finish_and_clear();
    Ok(())
}

/// A bar that counts simulated seconds, since runs differ in length.
fn progress(
    units: &[(usize, u64)],
    finished: usize,
    length: impl Fn(&(usize, u64)) -> u64,
) -> anyhow::Result<ProgressBar> {
    let bar = ProgressBar::new(units.iter().map(length).sum());
    bar.set_style(
        ProgressStyle::with_template("{bar:40} {percent} % of {msg}, {eta} left").context("progress bar")?,
    );
    let before = if finished > 0 { format!(" ({finished} finished before)") } else { String::new() };
    bar.set_message(format!("{} runs, {} h{before}", units.len(), bar.length().unwrap_or(0) / 3600));
    Ok(bar)
}

fn merge(args: &MergeArgs) -> anyhow::Result<()> {
    std::fs::create_dir_all(&args.out)
        .with_context(|| format!("can't make the folder {}", args.out.display()))?;
    tell(&args.files, &args.out)
}

/// Prints and writes what a whole campaign showed. It always goes by the files, so that it does not matter how the runs
/// came into them.
fn tell(files: &[PathBuf], out: &Path) -> anyhow::Result<()> {
    let (header, rows) = store::read(files)?;
    let campaign: Campaign = toml::from_str(&header.campaign)?;
    let cells = campaign.expand(&toml::from_str(&header.config)?)?;
    let wanted: u64 = cells.iter().map(|cell| cell.runs).sum();
    ensure!(
        rows.len() as u64 == wanted,
        "{} of {wanted} runs are there: a part is missing, or has not been finished",
        rows.len()
    );
    let results = Results::new(&campaign, &cells, &rows);
    print(&table::of(&results))?;
    files::write(&results, &cells, &rows, out)?;
    let runaway = if results.has_runaway() { ", runaway.md" } else { "" };
    let pictures = pictures::draw(&results, &cells, &rows, out)?;
    println!(
        "\nWritten to {}: campaign.json, cells.csv, runs.csv, tables.md{runaway}{pictures}",
        out.display()
    );
    Ok(())
}

fn show(args: &ShowArgs) -> anyhow::Result<()> {
    let (campaign, config) = args.definition.load()?;
    let cells = campaign.expand(&config)?;
    let cell = cells.iter().find(|cell| cell.label() == args.cell || cell.name == args.cell);
    let cell = cell.with_context(|| {
        let near = cells.iter().filter(|c| c.name.contains(&args.cell)).map(Cell::label).take(12);
        format!("no cell is named {:?}; some that contain it: {:?}", args.cell, near.collect::<Vec<_>>())
    })?;
    let seed = cell.seed(args.run);
    let (config, scenario) = cell.draw(seed);
    crate::commands::run::carry_out(&config, &scenario, seed, &args.out)
}
