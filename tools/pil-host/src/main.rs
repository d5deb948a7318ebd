//! Builds the images of the crate `pil`, runs them in QEMU, and judges what they say.

mod bench;
mod compare;
mod counts;
mod cycles;
mod divergence;
mod image;
mod qemu;
mod recording;
mod trace;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// fdi-core on an emulated Cortex-M4F.
#[derive(Parser)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Do target, host debug and host release give the same bits? Fails where they do not.
    Compare,
    /// What does each part cost? Fails where a count has risen since it was committed.
    Bench {
        /// Write the counts as the new ones to hold.
        #[arg(long)]
        update: bool,
    },
}

fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Compare => compare::run(),
        Command::Bench { update } => bench::run(update),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
