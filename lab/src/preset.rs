//! Settings that belong to a rig of a name. A rig without any has the defaults.

use anyhow::Context;
use fdi_core::Config;

use crate::change;

/// Every preset that differs from the defaults, as commented TOML. Each line sets one setting by its whole name, so that it takes no
/// parser of TOML, which is larger than all else in a browser.
pub const TEXTS: [(&str, &str); 3] = [
    ("oven", include_str!("../presets/oven.toml")),
    ("hotend", include_str!("../presets/hotend.toml")),
    ("tclab", include_str!("../presets/tclab.toml")),
];

/// The settings of a preset; the defaults for any other name.
///
/// # Errors
/// A line that is none, which a test excludes.
pub fn config(name: &str) -> anyhow::Result<Config> {
    let text = TEXTS.iter().find(|(known, _)| *known == name).map_or("", |(_, text)| text);
    let mut config = Config::default();
    for line in text.lines() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if !line.is_empty() {
            set(&mut config, line).with_context(|| format!("preset {name}: {line}"))?;
        }
    }
    Ok(config)
}

/// The faults come at fixed times, so a fixed PRBS would meet each at the same phase in every run. The seed moves it;
/// seed 1 leaves the configured start, which is the board's.
pub fn with_prbs_phase(config: &Config, seed: u64) -> Config {
    let mut config = config.clone();
    let period = (1u64 << config.prbs.bits.min(16)) - 1;
    let shift = seed.wrapping_sub(1).wrapping_mul(0x9E37_79B9) % period;
    config.prbs.start = ((u64::from(config.prbs.start) + shift - 1) % period + 1) as u16;
    config
}

/// `name = 1.5`, `name = "word"`, or `name = { word = { key = 1.5 } }`.
fn set(config: &mut Config, line: &str) -> anyhow::Result<()> {
    let (name, value) = line.split_once(" = ").context("expected an assignment")?;
    let words = value.split([' ', '{', '}', '=', '"', ',']).filter(|word| !word.is_empty());
    let no_key = |(i, word): &(usize, &str)| *i == 0 || word.parse::<f32>().is_ok();
    let words: Vec<_> = words.enumerate().filter(no_key).map(|(_, word)| word).collect();
    change::set(config, name, &words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_makes_an_instrument_and_is_a_preset_of_the_rig() {
        for (name, _) in TEXTS {
            fdi_core::Instrument::new(&config(name).unwrap()).unwrap();
            pt326_rig::RigConfig::preset(name).unwrap();
        }
        assert_eq!(config("paper").unwrap(), Config::default());
    }
}
