//! What was truly wrong while a recording was made: columns of it, or a list of events.

use std::path::Path;

use anyhow::{Context, bail};
use pt326_rig::fault::{Fault, Sensor, Verb};
use serde::Deserialize;

use super::table::Table;
use super::{Heater, Recording};

/// What a column of the truth may say of a heater, by the class that should be named.
const COLUMNS: [(&str, Verb, Option<Sensor>); 4] = [
    ("t0_fault", Verb::Offset, Some(Sensor::T0)),
    ("t1_offset", Verb::Offset, Some(Sensor::T1)),
    ("t2_offset", Verb::Offset, Some(Sensor::T2)),
    ("heater_power", Verb::HeaterPower, None),
];

/// The list of a scenario.
#[derive(Deserialize)]
struct Events {
    fault: Vec<Fault>,
}

/// Reads the truth of a heater: `class=column` of the recording itself, each stretch of one value other than 0 a fault; or a file of events, CSV with
/// the columns `do`, `sensor`, `size`, `at`, `for`, or TOML with the `[[fault]]` of a scenario. Times count from the first sample.
///
/// # Errors
/// A class that no column can tell, or the file, line and key that are wrong.
pub fn read(
    said: &[String],
    text: &str,
    recording: &Recording,
    heater: &Heater,
) -> anyhow::Result<Vec<Fault>> {
    let mut faults = Vec::new();
    for said in said {
        match said.split_once('=') {
            Some((class, column)) => faults.extend(columns(class, column, text, recording, heater)?),
            None => faults.extend(events(Path::new(said))?),
        }
    }
    for fault in &faults {
        fault.validate(&fault.label())?;
    }
    faults.sort_by(|a, b| a.at.total_cmp(&b.at));
    Ok(faults)
}

fn events(path: &Path) -> anyhow::Result<Vec<Fault>> {
    let place = || path.display().to_string();
    let text = std::fs::read_to_string(path).with_context(|| format!("can't read {}", place()))?;
    if path.extension().is_some_and(|extension| extension == "toml") {
        return Ok(toml::from_str::<Events>(&text).with_context(place)?.fault);
    }
    let mut reader = csv::ReaderBuilder::new();
    reader.trim(csv::Trim::All).comment(Some(b'#'));
    reader.from_reader(text.as_bytes()).deserialize().collect::<Result<_, _>>().with_context(place)
}

fn columns(
    class: &str,
    column: &str,
    text: &str,
    recording: &Recording,
    heater: &Heater,
) -> anyhow::Result<Vec<Fault>> {
    let Some((_, verb, sensor)) = COLUMNS.iter().find(|(known, ..)| *known == class) else {
        let known = COLUMNS.map(|(name, ..)| name).join(", ");
        bail!("--truth {class}={column}: expected one of {known} before the `=`, or a file")
    };
    let table = Table::parse(recording.file.clone(), text)?;
    let values = table.values_or_gaps(table.column(column)?)?.values;
    let at = |k: usize| values[recording.rows[k]?].filter(|x| *x != 0.0);
    let mut faults = Vec::new();
    let mut k = 0;
    while k < recording.len() {
        let Some(size) = at(k) else {
            k += 1;
            continue;
        };
        let first = k;
        while k < recording.len() && at(k) == Some(size) {
            k += 1;
        }
        let time = |k: usize| k as f64 * recording.sample_time;
        let known = match verb {
            Verb::HeaterPower => power(size, &heater.samples[first..k], recording.units.full_power.into()),
            verb => Some((*verb, size)),
        };
        faults.extend(
            known.map(|(verb, size)| {
                Fault::new(verb, *sensor, Some(size), time(first), time(k) - time(first))
            }),
        );
    }
    Ok(faults)
}

/// An amount of power beside that which is asked for meanwhile: the share of it that the heater gives, or where little is asked for what it gives
/// in the mean, %. Nothing is taken from a heater that is off.
fn power(amount: f64, samples: &[fdi_core::Observed], full: f64) -> Option<(Verb, f64)> {
    /// The largest share that a fault may have.
    const MOST: f64 = 3.0;
    let powers: Vec<f64> = samples.iter().filter_map(|sample| sample.power.map(f64::from)).collect();
    let mean = powers.iter().sum::<f64>() / powers.len().max(1) as f64;
    if amount <= (MOST - 1.0) * mean {
        (mean > 0.0).then_some((Verb::HeaterPower, (1.0 + amount / mean).max(0.0)))
    } else {
        Some((Verb::HeaterStuck, (100.0 * (mean + amount) / full).clamp(0.0, 100.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Reading;

    /// +20 % for 20 s each while 40 % are asked for, and while the heater is off.
    #[test]
    fn a_heater_that_gives_power_while_none_is_asked_for_is_a_fault_too() {
        let row = |k: usize| {
            let asked = if k < 60 { 40 } else { 0 };
            let amount = match k {
                20..40 | 80..100 => 20,
                100..110 => -20,
                _ => 0,
            };
            format!("{k},{asked},{},{amount}\n", 30 + k % 3)
        };
        let text = format!("t,power,temp,din\n{}", (0..120).map(row).collect::<String>());
        let how = Reading { full_power: Some(100.0), ..Reading::default() };
        let recording = Recording::parse("f".into(), &text, &how).unwrap();
        let said = ["heater_power=din".to_owned()];
        let faults = read(&said, &text, &recording, &recording.heaters[0]).unwrap();
        let known: Vec<_> =
            faults.iter().map(|fault| (fault.verb, fault.size, fault.at, fault.duration)).collect();
        assert_eq!(
            known,
            [(Verb::HeaterPower, Some(1.5), 20.0, 20.0), (Verb::HeaterStuck, Some(20.0), 80.0, 20.0)]
        );
    }
}
