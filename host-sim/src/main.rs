//! `pt326`: the PT-326 instrument on the host.

use std::io::{ErrorKind, Write};
use std::process::ExitCode;

use clap::Parser;
use host_sim::commands::Cli;
use host_sim::commands::terminal::{BAD, in_words, styled};

fn main() -> ExitCode {
    match Cli::parse().run() {
        Ok(code) => code,
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            // Standard error may be closed, too: then there is nobody to tell.
            let _ = writeln!(anstream::stderr(), "{} {}", styled(BAD, "error:"), in_words(&error));
            ExitCode::from(2)
        }
    }
}

/// Whoever reads our output has had enough (`pt326 config | head`): no error.
fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let io = error.root_cause().downcast_ref::<std::io::Error>();
    io.is_some_and(|e| e.kind() == ErrorKind::BrokenPipe)
}
