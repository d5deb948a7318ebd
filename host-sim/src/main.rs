//! `pt326`: the PT-326 instrument on the host.

use std::process::ExitCode;

use clap::Parser;
use pt326::commands::Cli;

fn main() -> ExitCode {
    Cli::parse().carry_out()
}
