//! Rigs by name.

use anyhow::bail;

use crate::config::RigConfig;
use crate::wall::WallConfig;

/// Makes a rig.
type Make = fn() -> RigConfig;

/// Every preset.
const PRESETS: &[(&str, Make)] = &[("paper", RigConfig::default), ("trainer", trainer), ("harsh", harsh)];

impl RigConfig {
    /// The rig of a name: `paper`, the reference rig; `trainer`, with all ingredients, moderate; `harsh`, all strong.
    ///
    /// # Errors
    /// The name is none of these.
    pub fn preset(name: &str) -> anyhow::Result<Self> {
        let Some((_, make)) = PRESETS.iter().find(|(known, _)| *known == name) else {
            let names: Vec<&str> = PRESETS.iter().map(|(name, _)| *name).collect();
            bail!("no preset \"{name}\", expected {}", names.join(", "));
        };
        Ok(make())
    }
}

/// All ingredients, moderate.
fn trainer() -> RigConfig {
    RigConfig { wall: WallConfig { t1_share: 0.06, t2_share: 0.09, time: 30.0 }, ..RigConfig::default() }
}

/// All ingredients, strong.
fn harsh() -> RigConfig {
    RigConfig { wall: WallConfig { t1_share: 0.12, t2_share: 0.16, time: 40.0 }, ..RigConfig::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_preset_is_within_bounds_and_another_name_is_an_error_that_lists_them() {
        for (name, _) in PRESETS {
            RigConfig::preset(name).unwrap().validate().unwrap();
        }
        assert_eq!(RigConfig::preset("paper").unwrap(), RigConfig::default());
        let error = RigConfig::preset("oven").unwrap_err().to_string();
        assert!(error.contains("oven") && error.contains("paper, trainer, harsh"), "{error}");
    }
}
