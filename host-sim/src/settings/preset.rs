//! Settings that belong to a rig of a name. A rig without any has the defaults.

use toml::Table;

/// Every preset that differs from the defaults, as commented TOML.
pub const TEXTS: [(&str, &str); 3] = [
    ("oven", include_str!("../../defaults/oven.toml")),
    ("hotend", include_str!("../../defaults/hotend.toml")),
    ("tclab", include_str!("../../defaults/tclab.toml")),
];

/// What the settings of a preset change; nothing for any other name.
///
/// # Errors
/// The text is no TOML, which a test excludes.
pub fn preset(name: &str) -> anyhow::Result<Table> {
    let text = TEXTS.iter().find(|(known, _)| *known == name).map_or("", |(_, text)| text);
    Ok(text.parse()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_makes_an_instrument_and_is_a_preset_of_the_rig() {
        for (name, _) in TEXTS {
            let config = crate::settings::from_table(preset(name).unwrap()).unwrap();
            fdi_core::Instrument::new(&config).unwrap();
            pt326_rig::RigConfig::preset(name).unwrap();
        }
        assert!(preset("paper").unwrap().is_empty());
    }
}
