//! `pt326 score`: public data with faults, and how they are detected and named.

use std::path::PathBuf;

use anyhow::Context;

use super::terminal::print;
use pt326_host::plant::{score, settings_of};

/// Arguments of `score`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
A plant is described by settings: which signals its loops have, which models are to be learnt of them, which file is without a fault, and what is wrong in \
the others. docs/scores.md has the protocol, the numbers, and those of other methods. The data do not come with the program.

Examples:
  pt326 score tep DIR                  the 44 files of Tennessee Eastman in DIR
  pt326 score lbnl DIR                 days of LBNL's air handler in DIR
  pt326 score tep --settings > my.toml
  pt326 score my.toml DIR              a plant of your own")]
pub struct ScoreArgs {
    /// `tep`, `lbnl`, or a file of settings.
    #[arg(value_name = "PLANT")]
    pub plant: String,
    /// The folder with its files.
    #[arg(value_name = "DIR", required_unless_present = "settings")]
    pub dir: Option<PathBuf>,
    /// Print the settings of a plant that comes with the program (or of the file) instead.
    #[arg(long)]
    pub settings: bool,
}

/// Runs the command.
///
/// # Errors
/// Settings or a file that are missing or wrong.
pub fn run(args: &ScoreArgs) -> anyhow::Result<()> {
    let settings = settings_of(&args.plant)?;
    match &args.dir {
        Some(dir) if !args.settings => print(&score(&settings, dir).with_context(|| args.plant.clone())?),
        _ => print(&settings),
    }
}
