//! A board's settings, read from its answer to `get`.

use anyhow::Context;
use fdi_core::Config;
use firmware_logic::settings::schema::Name;

/// The settings that an answer to `get` tells.
///
/// # Errors
/// The board has a setting that is not known here.
pub fn read(answer: &str) -> anyhow::Result<Config> {
    let mut config = Config::default();
    for line in answer.lines() {
        let Some((name, value)) = line.split_once(" = ") else { continue };
        let told = put(&mut config, name, value);
        told.with_context(|| {
            format!("the board has {line}, which is not known here: its image and this page or program are of other releases; put the image that came with them on the board, or use what came with its image")
        })?;
    }
    Ok(config)
}

/// Puts a value as the board tells it, perhaps with a unit behind, into a configuration.
///
/// # Errors
/// No such setting, or a value that it does not take.
pub fn put(config: &mut Config, name: &str, value: &str) -> anyhow::Result<()> {
    let known = Name::find(name).map_err(|error| anyhow::anyhow!("{error}"))?;
    // A number with more digits than the board shows.
    let value = value.trim_start_matches('~');
    let number = value.rsplit_once(' ').map_or(value, |(number, _unit)| number);
    known
        .set(config, name, value)
        .or_else(|_| known.set(config, name, number))
        .map_err(|error| anyhow::anyhow!("{error}"))
}
