//! Which campaign: arguments of `pt326 campaign` and of its `show`.

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use clap::Args;

use pt326_host::campaign::ablation;
use pt326_host::campaign::definition::{ABLATION_TOML, CAMPAIGN_TOML, Campaign, PHYSICS_TOML, QUICK, USUAL};

/// Names of the subcommands: a word near one of them is no file.
const SUBCOMMANDS: [&str; 4] = ["define", "merge", "show", "records"];

/// What describes a campaign.
#[derive(Clone, Debug, Args)]
pub struct DefinitionArgs {
    /// The campaign, TOML; see `pt326 campaign define`. Left out: the default one.
    #[arg(value_name = "FILE.toml")]
    pub file: Option<PathBuf>,
    /// The campaign on physics that no model has, in place of the default one.
    #[arg(long, conflicts_with = "file")]
    pub physics: bool,
    /// Vary each number of the likelihood diagnosis (`pt326 config --tuning`), at half and at twice its value: vary.md says what each is worth. Without a
    /// file, over a few runs of many kinds, all of them: more than an hour of one core.
    #[arg(long, conflicts_with_all = ["physics", "quick"])]
    pub ablate: bool,
    /// Settings of the instrument, TOML; see `pt326 config`.
    #[arg(long, value_name = "FILE.toml")]
    pub config: Option<PathBuf>,
    /// A twentieth of the runs: less than a minute. Without --quick, --full or --scale, a built-in campaign does a
    /// quarter of its runs, and that of a file all.
    #[arg(long, conflicts_with_all = ["full", "scale"])]
    pub quick: bool,
    /// All runs of the definition.
    #[arg(long, conflicts_with = "scale")]
    pub full: bool,
    /// Multiply the numbers of runs by this.
    #[arg(long)]
    pub scale: Option<f64>,
    /// Only the cells whose name contains this.
    #[arg(long, value_name = "TEXT")]
    pub only: Option<String>,
    /// The first seed, in place of the definition's.
    #[arg(long, value_name = "SEED")]
    pub seeds_from: Option<u64>,
    /// Repeat everything for each of some values of a setting; of several settings, for all combinations.
    #[arg(long, value_name = "KEY=VALUE,VALUE")]
    pub sweep: Vec<String>,
    /// The same, but vary one setting at a time: what is each worth?
    #[arg(long, value_name = "KEY=VALUE,VALUE")]
    pub vary: Vec<String>,
}

impl DefinitionArgs {
    /// Reads and checks what the arguments name.
    ///
    /// # Errors
    /// The file, line, key or value that is wrong.
    pub fn load(&self) -> anyhow::Result<(Campaign, fdi_core::Config)> {
        let config = pt326_host::settings::read(self.config.as_deref())?;
        if let Some(file) = &self.file {
            check_is_file(file)?;
        }
        let mut campaign = match &self.file {
            Some(file) => Campaign::read(file)?,
            None => toml::from_str(built_in(self.physics, self.ablate))?,
        };
        let preset = match (self.quick, self.full) {
            (true, _) => QUICK,
            (_, true) => 1.0,
            _ if self.file.is_none() && !self.ablate => USUAL,
            _ => 1.0,
        };
        campaign.scale *= self.scale.unwrap_or(preset);
        if let Some(only) = &self.only {
            campaign.only.clone_from(only);
        }
        campaign.seeds_from = self.seeds_from.unwrap_or(campaign.seeds_from);
        for text in &self.sweep {
            let (key, values) = parse_sweep(text)?;
            campaign.sweep.insert(key, values);
        }
        if self.ablate {
            campaign.vary.extend(ablation::vary());
        }
        for text in &self.vary {
            let (key, values) = parse_sweep(text)?;
            campaign.vary.insert(key, values);
        }
        Ok((campaign, config))
    }
}

/// The text of a built-in campaign.
pub(super) fn built_in(physics: bool, ablate: bool) -> &'static str {
    match (physics, ablate) {
        (true, _) => PHYSICS_TOML,
        (_, true) => ABLATION_TOML,
        _ => CAMPAIGN_TOML,
    }
}

/// A mistyped subcommand looks like a file that is not there.
fn check_is_file(file: &Path) -> anyhow::Result<()> {
    let word = file.to_string_lossy();
    let near = |name: &&&str| strsim::damerau_levenshtein(&word, name) <= 2;
    if let (false, Some(name)) = (file.exists(), SUBCOMMANDS.iter().find(near)) {
        anyhow::bail!("there is no file {word}; did you mean `pt326 campaign {name}`?");
    }
    Ok(())
}

/// `key=value,value` with values as in TOML.
fn parse_sweep(text: &str) -> anyhow::Result<(String, Vec<toml::Value>)> {
    let expected = || format!("{text}: expected key=value,value such as diagnosis.sigma_factor=2.5,3,4");
    let (key, values) = text.split_once('=').with_context(expected)?;
    let table: toml::Table = format!("values = [{values}]").parse().with_context(expected)?;
    let values = table["values"].as_array().cloned().unwrap_or_default();
    ensure!(!values.is_empty() && !key.is_empty(), expected());
    Ok((key.trim().into(), values))
}
