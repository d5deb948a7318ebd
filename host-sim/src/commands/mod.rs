//! The command line.

pub mod campaign;
pub mod config;
pub mod console;
pub mod cosim;
pub mod identify;
pub mod repeat;
pub mod replay;
pub mod run;

use std::path::PathBuf;

use clap::{Args, Parser};

use crate::experiment::FaultSize;
use crate::experiment::scenario::{self, Scenario};
use fdi_core::Config;
use pt326_rig::Disturbance;

/// The PT-326 fault diagnosis instrument on the host: the code that the board runs, against a simulated rig.
///
/// Without a command: `run`, the paper's experiment.
#[derive(Debug, Parser)]
#[command(
    version,
    after_help = "Examples:
  host-sim                                          the paper's experiment; results in out/
  host-sim run --seed 7 --disturbance lively --fault-size small
  host-sim scenario > my.toml; host-sim run --scenario my.toml
  host-sim repeat --seeds 200                       delays and durations over 200 runs
  host-sim campaign --quick                         every fault and disturbance, both diagnoses, in a minute
  host-sim identify record.csv --u Q1 --y T1 --order 2,2,1 --ts 1
  host-sim replay board.log                         a board's log through the core again, compared bit for bit
  host-sim console                                  the board's console on the simulated rig
  my-plant | host-sim core                          codes in, drive and diagnosis out, line by line"
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Option<Subcommand>,
}

/// The commands.
#[derive(Debug, clap::Subcommand)]
pub enum Subcommand {
    /// Run an experiment on the simulated rig; write trace, figures and report.
    Run(RunArgs),
    /// Run the same experiment over many seeds; print medians and percentiles.
    Repeat(RepeatArgs),
    /// Many runs of many kinds, scored against the truth: delays, verdicts, magnitudes, false alarms of both diagnoses.
    Campaign(Box<campaign::CampaignArgs>),
    /// The instrument on standard input and output, for co-simulation.
    Core(CoreArgs),
    /// Identify an ARX model from a recorded file.
    Identify(identify::IdentifyArgs),
    /// Run a recording (a board's log, a trace.csv) through the core again and compare.
    Replay(replay::ReplayArgs),
    /// The board's line console, against the simulated rig.
    Console(ConsoleArgs),
    /// Print the instrument's settings with their defaults as commented TOML.
    Config(config::ConfigArgs),
    /// Print the default rig and faults as commented TOML.
    Scenario,
}

impl Default for Subcommand {
    fn default() -> Self {
        Self::Run(RunArgs::default())
    }
}

/// What describes an experiment.
#[derive(Clone, Debug, Default, Args)]
pub struct ExperimentArgs {
    /// How much the surroundings move: none, calm (room drift), lively (and air flow and mains). Default: the
    /// scenario's, calm.
    #[arg(long)]
    pub disturbance: Option<Disturbance>,
    /// Size of the faults: small, nominal, large, or a factor on the nominal departure (negative: the other way).
    #[arg(long, default_value = "nominal", allow_negative_numbers = true)]
    pub fault_size: FaultSize,
    /// Settings of the instrument, TOML; see `host-sim config`.
    #[arg(long, value_name = "FILE.toml")]
    pub config: Option<PathBuf>,
    /// Rig and faults, TOML; see `host-sim scenario`.
    #[arg(long, value_name = "FILE.toml")]
    pub scenario: Option<PathBuf>,
}

impl ExperimentArgs {
    /// Reads and checks what the arguments name.
    ///
    /// # Errors
    /// The file, line, key or value that is wrong.
    pub fn load(&self) -> anyhow::Result<(Config, Scenario)> {
        let config = crate::settings::read(self.config.as_deref())?;
        let mut scenario = scenario::read_scenario(self.scenario.as_deref())?;
        scenario.disturbance = self.disturbance.unwrap_or(scenario.disturbance);
        scenario.faults = scenario.faults.iter().map(|fault| self.fault_size.apply(fault)).collect();
        scenario.validate()?;
        Ok((config, scenario))
    }
}

/// Arguments of `run`.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// Seed of the rig's noise and of the phase of the excitation.
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

/// Arguments of `repeat`.
#[derive(Clone, Debug, Args)]
pub struct RepeatArgs {
    /// How many runs.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub seeds: u64,
    /// The first seed.
    #[arg(long, default_value_t = 1)]
    pub from: u64,
    #[command(flatten)]
    /// The experiment.
    pub experiment: ExperimentArgs,
    /// Print JSON instead of a table.
    #[arg(long)]
    pub json: bool,
}

/// The board's line console, against the simulated rig.
///
/// On a terminal time passes as on the board. From a pipe it stands still but for `wait SECONDS` and for a `check`, which
/// ends before the next line is read:
/// printf 'check\narm\nwait 400\nstatus\nfaults\n' | host-sim console
/// `wire swap t1 t2` and others wire the rig wrongly, `fault offset t2 1.5 25` and others let something happen: see `help`.
#[derive(Clone, Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct ConsoleArgs {
    #[command(flatten)]
    /// The rig and the settings to begin with.
    pub experiment: ExperimentArgs,
    /// Seed of the rig's noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// On a terminal: how many times faster than the board.
    #[arg(long, default_value_t = 1.0, value_parser = speed)]
    pub speed: f64,
}

fn speed(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(speed) if (0.01..=1000.0).contains(&speed) => Ok(speed),
        _ => Err("expected 0.01 to 1000".into()),
    }
}

/// The instrument on standard input and output.
///
/// Each input line holds three 12-bit ADC codes, `t0_code,t1_code,t2_code`, 0..4095, decimals allowed; it is one tick.
/// The first output line is a header; then each input line is answered by one flushed line: the drive in % to apply until
/// the next tick, and the columns of trace.csv but for `truth`. The clock is the number of the tick times Ts; the
/// instrument begins to regulate at the first line. A bad line ends it with exit code 2.
#[derive(Clone, Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct CoreArgs {
    /// Settings of the instrument, TOML; see `host-sim config`.
    #[arg(long, value_name = "FILE.toml")]
    pub config: Option<PathBuf>,
}
