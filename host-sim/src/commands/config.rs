//! `config`: the settings of the instrument.

use std::io::Write;

use clap::Args;

use crate::settings::{commented_toml, markdown};

/// Arguments of `config`.
#[derive(Clone, Debug, Default, Args)]
pub struct ConfigArgs {
    /// Print a table in Markdown instead.
    #[arg(long)]
    pub markdown: bool,
}

/// Prints all settings with their defaults.
///
/// # Errors
/// Standard output cannot be written.
pub fn run(args: &ConfigArgs) -> anyhow::Result<()> {
    let text = if args.markdown { markdown() } else { commented_toml() };
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}
