//! The command line: what can be asked for. Arguments stand beside the command that takes them.

pub mod board;
pub mod campaign;
pub mod config;
pub mod console;
pub mod cosim;
pub mod diagnose;
pub mod experiment;
pub mod fit_rig;
pub mod identify;
pub mod isolability;
#[cfg(feature = "live")]
pub mod live;
pub mod repeat;
pub mod replay;
pub mod results;
pub mod run;
pub mod score;
pub mod shell;
pub mod teach;
pub mod terminal;

use std::io::Write;
use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use board::BoardArgs;
use campaign::CampaignArgs;
use config::ConfigArgs;
use console::ConsoleArgs;
use cosim::CoreArgs;
use diagnose::DiagnoseArgs;
use fit_rig::FitRigArgs;
use identify::IdentifyArgs;
use isolability::IsolabilityArgs;
#[cfg(feature = "live")]
use live::LiveArgs;
use pt326_host::experiment::scenario;
use repeat::RepeatArgs;
use replay::ReplayArgs;
use run::RunArgs;
use score::ScoreArgs;
use shell::{CompletionsArgs, ManArgs};
use teach::TeachArgs;
use terminal::{BAD, in_words, is_unread, styled};

/// The PT-326 fault diagnosis instrument on the host: the code that the board runs, against a simulated rig.
///
/// Without a command: `run`, the paper's experiment.
#[derive(Debug, Parser)]
#[command(
    name = "pt326",
    version,
    after_help = "Examples:
  pt326                                   the paper's experiment; results in out/
  pt326 run --seed 7 --disturbance lively --fault-size small
  pt326 scenario > my.toml                the rig and the faults: edit them, then
  pt326 run --scenario my.toml
  pt326 repeat --seeds 200                delays and durations over 200 runs
  pt326 campaign --quick                  every fault and disturbance, both diagnoses, in a minute
  pt326 isolability --preset trainer      which faults can be told apart on this rig, and how soon
  pt326 diagnose record.csv               a recording of somebody else's heater: what was wrong?
  pt326 identify record.csv --u Q1 --y T1 --order 2,2,1
  pt326 replay board.log                  a board's log through the same code again: the same bits?
  pt326 teach board.log --fault hand:385..410,495..520 --fault cap:600..625 --out taught.toml
  pt326 board --record board.log          what a board over its serial port does, until Ctrl-C
  pt326 console                           the board's console on the simulated rig
  my-plant | pt326 core                   ADC codes in, power and diagnosis out, line by line

`pt326 COMMAND --help` explains each. Exit code: 0, or 2 after an error; `board`, `diagnose` and `teach` also give 1."
)]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Subcommand>,
}

#[cfg(not(feature = "live"))]
const NO_LIVE: &str = "this build has no `live`, for its web server takes as long to build as all the rest. From the \
    project's folder: cargo install --path host-sim --features live";

/// The commands.
#[derive(Debug, clap::Subcommand)]
enum Subcommand {
    /// Run an experiment on the simulated rig; write a trace, figures and a report.
    Run(RunArgs),
    /// Run the same experiment with many seeds; print medians and percentiles.
    Repeat(RepeatArgs),
    /// Run many kinds of experiment many times, and score both diagnoses against the truth.
    Campaign(Box<CampaignArgs>),
    /// Compute which faults can be told apart on a rig, how soon, and from which size on.
    Isolability(IsolabilityArgs),
    /// Be the instrument for another program: ADC codes on standard input, power and diagnosis on standard output.
    Core(CoreArgs),
    /// Diagnose a recording of a heater that something else controls.
    Diagnose(Box<DiagnoseArgs>),
    /// Fit a simulated rig to a recording, for `run --scenario`.
    FitRig(FitRigArgs),
    /// Identify an ARX model (autoregressive with external input) from a recording.
    Identify(IdentifyArgs),
    /// Run a recording (a board's log, a trace.csv) through the same code again and compare.
    Replay(ReplayArgs),
    /// Score the models of a plant's loops on public data whose faults are known.
    Score(ScoreArgs),
    /// Make signatures of faults of your own from a recording in which you made them.
    Teach(TeachArgs),
    /// Serve the lab to a browser: the simulated rig, or a recording, as it goes on.
    #[cfg(feature = "live")]
    Live(LiveArgs),
    /// Serve the lab to a browser: not in this build.
    ///
    /// Its web server takes as long to build as all the rest. From the project's folder: `cargo install --path host-sim --features live`.
    #[cfg(not(feature = "live"))]
    Live {
        #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Use the board's console, with the simulated rig in place of a board.
    Console(ConsoleArgs),
    /// Use a real board over its serial port: its console, a record of what it does, its settings.
    Board(BoardArgs),
    /// Print the instrument's settings with their defaults as commented TOML.
    Config(ConfigArgs),
    /// Print the default rig and faults as commented TOML.
    Scenario,
    /// Print the completions for a shell.
    Completions(CompletionsArgs),
    /// Print a manual page.
    Man(ManArgs),
}

impl Cli {
    /// Does what was asked for, and tells what went wrong; the exit code of `pt326`.
    pub fn carry_out(self) -> ExitCode {
        match self.run() {
            Ok(code) => code,
            Err(error) if is_unread(&error) => ExitCode::SUCCESS,
            Err(error) => {
                // Standard error may be closed, too: then there is nobody to tell.
                let _ = writeln!(anstream::stderr(), "{} {}", styled(BAD, "error:"), in_words(&error));
                ExitCode::from(2)
            }
        }
    }

    /// Does what was asked for.
    ///
    /// # Errors
    /// Those of the command.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let done = match self.command.unwrap_or_else(|| Subcommand::Run(RunArgs::default())) {
            Subcommand::Run(args) => run::run(&args),
            Subcommand::Repeat(args) => repeat::run(&args),
            Subcommand::Campaign(args) => campaign::run(&args),
            Subcommand::Isolability(args) => isolability::run(&args),
            Subcommand::Core(args) => cosim::run(&args),
            Subcommand::Diagnose(args) => return diagnose::run(&args),
            Subcommand::FitRig(args) => fit_rig::run(&args),
            Subcommand::Identify(args) => identify::run(&args),
            Subcommand::Replay(args) => replay::run(&args),
            Subcommand::Score(args) => score::run(&args),
            Subcommand::Teach(args) => return teach::run(&args),
            #[cfg(feature = "live")]
            Subcommand::Live(args) => live::run(&args),
            #[cfg(not(feature = "live"))]
            Subcommand::Live { .. } => anyhow::bail!("{NO_LIVE}"),
            Subcommand::Console(args) => console::run(&args),
            Subcommand::Board(args) => return board::run(&args),
            Subcommand::Config(args) => config::run(&args),
            Subcommand::Scenario => terminal::print(&scenario::commented_toml()),
            Subcommand::Completions(args) => shell::completions(&args, Self::command()),
            Subcommand::Man(args) => shell::man(&args, Self::command()),
        };
        done.map(|()| ExitCode::SUCCESS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clap_finds_no_contradiction_in_the_arguments() {
        Cli::command().debug_assert();
    }

    /// clap breaks longer lines: right for prose, not for tables and examples, which are indented.
    #[test]
    fn tables_and_examples_of_the_help_fit_100_columns() {
        fn check(command: &clap::Command) {
            let text = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let long = text.lines().find(|line| line.starts_with("  ") && line.chars().count() > 100);
            assert!(long.is_none(), "{}: {long:?}", command.get_name());
            command.get_subcommands().for_each(check);
        }
        check(&Cli::command());
    }
}
