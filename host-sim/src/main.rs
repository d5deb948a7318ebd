//! `host-sim`: the PT-326 instrument on the host.

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;
use host_sim::commands::{Cli, Subcommand, campaign, config, console, cosim, identify, repeat, replay, run};
use host_sim::experiment::scenario;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let result = match cli.command.unwrap_or_default() {
        Subcommand::Run(args) => run::run(&args),
        Subcommand::Repeat(args) => repeat::run(&args),
        Subcommand::Campaign(args) => campaign::run(&args),
        Subcommand::Core(args) => cosim::run(&args),
        Subcommand::Identify(args) => identify::run(&args),
        Subcommand::Replay(args) => replay::run(&args),
        Subcommand::Console(args) => console::run(&args),
        Subcommand::Config(args) => config::run(&args),
        Subcommand::Scenario => print(&scenario::commented_toml()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn print(text: &str) -> anyhow::Result<()> {
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}

/// Whoever reads our output has had enough (`host-sim config | head`): no error.
fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let io = error.downcast_ref::<std::io::Error>();
    io.is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
}
