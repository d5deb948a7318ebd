//! A board's settings and a file's: read from `get`, told with `set`.

use std::io::{Read, Write};

use fdi_core::Config;
use firmware_logic::settings::schema::Name;
use pt326_lab::board::settings::read as from_answer;
use pt326_lab::change::differing;

use super::Session;

/// The settings of the board.
///
/// # Errors
/// The port has gone, or the board has a setting that is not known here.
pub fn read<P: Read + Write>(session: &mut Session<P>) -> anyhow::Result<Config> {
    from_answer(&session.order("get")?)
}

/// Whether a board with this status keeps settings: nothing may heat, and its codes must be those of a rig.
pub fn can_be_kept(status: &str) -> bool {
    let rests = status.starts_with("mode off") || status.starts_with("mode tripped");
    rests && !status.lines().next().is_some_and(|mode| mode.contains("check under way"))
}

/// Gives the board each setting that differs from its own, and takes away rows that are not wanted; their names. What one refuses only until another has changed comes in the
/// end, too.
///
/// # Errors
/// The first setting that the board refuses, with its reason.
pub fn write<P: Read + Write>(session: &mut Session<P>, wanted: &Config) -> anyhow::Result<Vec<String>> {
    let mut now = read(session)?;
    let mut changed = Vec::new();
    loop {
        let (mut refused, before) = (None, changed.len());
        for name in differing(&now, wanted) {
            let value = name.value(wanted).to_string();
            let bare = bare(name, &value, wanted);
            match session.order(&format!("set {name} {bare}")) {
                Ok(_) => changed.push(name.to_string()),
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        let Some(error) = refused else { return Ok(changed) };
        if changed.len() == before {
            return Err(error);
        }
        now = read(session)?;
    }
}

/// A value without its unit; `config` has it.
fn bare(name: Name, value: &str, config: &Config) -> String {
    let text = name.to_string();
    let takes = |value: &str| name.set(&mut config.clone(), &text, value).is_ok();
    match value.rsplit_once(' ') {
        Some((number, _unit)) if !takes(value) => number.to_owned(),
        _ => value.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use pt326_lab::board::settings::put as told;

    use super::*;

    /// The usual settings with two rows of the user's own in either table, and two faults.
    fn taught() -> Config {
        let mut config = Config::default();
        for name in ["detection.3", "detection.4", "isolation.4", "isolation.5"] {
            let (name, number) = (format!("diagnosis.{name}"), name.len());
            let row = format!("{number} 0 +1 0 {} x hand", if name.ends_with('4') { "-1" } else { "+1" });
            Name::find(&name).unwrap().set(&mut config, &name, &row).unwrap();
        }
        for (place, changes) in
            [(1, "low 0 -37 31 -14 -113 24 -12 82 -44 13 -4"), (2, "cap 1 2 3 4 5 6 7 8 9 10 -32768")]
        {
            let name = format!("likelihood.taught.{place}");
            Name::find(&name).unwrap().set(&mut config, &name, changes).unwrap();
        }
        config
    }

    #[test]
    fn every_setting_is_read_as_the_board_tells_it_and_told_as_it_takes_it() {
        let usual = taught();
        let mut config = Config::default();
        for name in Name::all(&usual) {
            let (text, value) = (name.to_string(), name.value(&usual).to_string());
            told(&mut config, &text, &value).unwrap_or_else(|error| panic!("{text} = {value}: {error:#}"));
            assert!(name.set(&mut config, &text, &bare(name, &value, &usual)).is_ok(), "{text} = {value}");
            assert!(name.same(&config, &usual), "{text} = {value}");
        }
    }

    #[test]
    fn rows_that_are_not_wanted_go() {
        let (wanted, mut config) = (Config::default(), taught());
        for name in differing(&config.clone(), &wanted) {
            let (text, value) = (name.to_string(), name.value(&wanted).to_string());
            name.set(&mut config, &text, &bare(name, &value, &wanted)).unwrap();
        }
        assert_eq!(config, wanted);
    }
}
