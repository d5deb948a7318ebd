//! `pt326 config`: the settings of the instrument.

use super::terminal::print;
use crate::settings::{commented_toml, markdown};

/// Arguments of `config`.
#[derive(Clone, Debug, Default, clap::Args)]
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
    print(&if args.markdown { markdown() } else { commented_toml() })
}
