//! `pt326 config`: the settings of the instrument.

use clap::builder::PossibleValuesParser;
use pt326_lab::preset;

use super::terminal::print;
use pt326_host::settings::{commented_toml, markdown, tuning};

/// Arguments of `config`.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct ConfigArgs {
    /// Print a table in Markdown instead.
    #[arg(long)]
    pub markdown: bool,
    /// Print the numbers of the likelihood diagnosis that are no settings as a table in Markdown instead: a file of settings, and `campaign --vary`, take
    /// them, a board does not.
    #[arg(long, conflicts_with_all = ["markdown", "preset"])]
    pub tuning: bool,
    /// Print the settings that belong to a plant (oven, hotend, tclab) instead: those that are not the defaults.
    #[arg(long, value_name = "NAME", conflicts_with = "markdown", value_parser = plants())]
    pub preset: Option<String>,
}

/// The names of the plants.
fn plants() -> PossibleValuesParser {
    preset::TEXTS.map(|(name, _)| name).into()
}

/// Prints all settings with their defaults.
///
/// # Errors
/// Standard output cannot be written.
pub fn run(args: &ConfigArgs) -> anyhow::Result<()> {
    let text = preset::TEXTS.iter().find(|(name, _)| args.preset.as_deref() == Some(*name));
    match text {
        Some((_, text)) => print(text),
        None if args.tuning => print(&tuning()),
        None => print(&if args.markdown { markdown() } else { commented_toml() }),
    }
}
