//! The command line: what can be asked for. Arguments stand beside the command that takes them.

pub mod board;
pub mod campaign;
pub mod config;
pub mod console;
pub mod cosim;
pub mod diagnose;
pub mod experiment;
pub mod fit_rig;
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
    help_template = help_template(),
    after_help = "Examples:
  pt326                                   the paper's experiment; results in out/
  pt326 run --seed 7 --disturbance lively --fault-size small
  pt326 scenario > my.toml                the rig and the faults: edit them, then
  pt326 run --scenario my.toml
  pt326 campaign --quick                  every fault and disturbance, both diagnoses, in a minute
  pt326 diagnose record.csv               a recording of somebody else's heater: what was wrong?
  pt326 replay board.log                  a board's log through the same code again: the same bits?
  pt326 board --record board.log          what a board over its serial port does, until Ctrl-C
  pt326 console                           the board's console on the simulated rig

`pt326 COMMAND --help` explains each. Exit code: 0, or 2 after an error; `board`, `diagnose` and `teach` also give 1."
)]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Subcommand>,
}

#[cfg(not(feature = "live"))]
const NO_LIVE: &str = "this build has no `live`, for its web server takes as long to build as all the rest. From the \
    project's folder: cargo install --path host-sim --features live";

/// The commands: first those for everybody, as many as [`FOR_EVERYBODY`] says.
#[derive(Debug, clap::Subcommand)]
enum Subcommand {
    /// Run an experiment on the simulated rig; write a trace, figures and a report.
    Run(RunArgs),
    /// Diagnose a recording of a heater that something else controls.
    Diagnose(Box<DiagnoseArgs>),
    /// Use a real board over its serial port: console, record, settings, commissioning.
    Board(BoardArgs),
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
    /// Run many kinds of experiment many times, and score both diagnoses against the truth.
    Campaign(Box<CampaignArgs>),
    /// Run a recording (a board's log, a trace.csv) through the same code again and compare.
    Replay(ReplayArgs),
    /// Print the instrument's settings with their defaults as commented TOML.
    Config(ConfigArgs),
    /// Print the default rig and faults as commented TOML.
    Scenario,
    /// Run the same experiment with many seeds; print medians and percentiles.
    Repeat(RepeatArgs),
    /// Compute which faults can be told apart on a rig, how soon, and from which size on.
    Isolability(IsolabilityArgs),
    /// Make signatures of faults of your own from a recording in which you made them.
    Teach(TeachArgs),
    /// Fit a simulated rig to a recording, for `run --scenario`.
    FitRig(FitRigArgs),
    /// Score the models of a plant's loops on public data whose faults are known.
    Score(ScoreArgs),
    /// Be the instrument for another program: ADC codes in, power and diagnosis out.
    Core(CoreArgs),
    /// Print the completions for a shell.
    Completions(CompletionsArgs),
    /// Print a manual page.
    Man(ManArgs),
}

/// So many commands are for everybody. The help lists the others apart.
const FOR_EVERYBODY: usize = 9;

/// The help with its commands in two lists: clap makes one.
fn help_template() -> String {
    let commands = <Subcommand as clap::Subcommand>::augment_subcommands(clap::Command::new("pt326"));
    let line = |command: &clap::Command| {
        let about = command.get_about().map(ToString::to_string).unwrap_or_default();
        format!("  {:<12} {about}\n", command.get_name())
    };
    let lines: Vec<String> = commands.get_subcommands().map(line).collect();
    let (everybody, engineers) = lines.split_at(FOR_EVERYBODY);
    format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\nCommands:\n{}\nFor engineers:\n{}\nOptions:\n{{options}}{{after-help}}",
        everybody.concat(),
        engineers.concat()
    )
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
        let long = help_template().lines().find(|line| line.chars().count() > 100).map(str::to_owned);
        assert!(long.is_none(), "{long:?}");
    }

    #[test]
    fn what_most_people_use_comes_first() {
        let help = Cli::command().render_help().to_string();
        let of = |heading: &str| -> Vec<String> {
            let lines = help.lines().skip_while(|line| *line != heading).skip(1);
            let lines = lines.take_while(|line| !line.is_empty());
            lines.filter_map(|line| line.split_whitespace().next().map(str::to_owned)).collect()
        };
        let first =
            ["run", "diagnose", "board", "live", "console", "campaign", "replay", "config", "scenario"];
        assert_eq!(of("Commands:"), first, "{help}");
        assert!(of("For engineers:").contains(&"isolability".to_owned()), "{help}");
    }
}
