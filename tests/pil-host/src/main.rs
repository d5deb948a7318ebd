//! Builds the images of the crate `pil`, runs them in QEMU, and judges what they say.

mod compare;
mod image;
mod qemu;
mod recording;

use std::path::PathBuf;

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
    /// Print the hashes of this build of the host.
    Digest {
        /// Recorded codes, as `compare` writes them.
        codes: PathBuf,
    },
}

fn main() -> anyhow::Result<()> {
    match Cli::parse().command {
        Command::Compare => compare::run(),
        Command::Digest { codes } => compare::print_digest(&codes),
    }
}
