//! What was truly wrong while a recording was made: columns of it, or a list of events.

use std::path::Path;

use anyhow::{Context, bail, ensure};
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
    let values = table.values_or_gaps(table.column(column)?)?;
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
        let size =
            if *verb == Verb::HeaterPower { 1.0 + share(size, &heater.samples[first..k])? } else { size };
        faults.push(Fault::new(*verb, *sensor, Some(size), time(first), time(k) - time(first)));
    }
    Ok(faults)
}

/// What an amount of power is of that which is asked for meanwhile.
fn share(amount: f64, samples: &[fdi_core::Observed]) -> anyhow::Result<f64> {
    let powers: Vec<f64> = samples.iter().filter_map(|sample| sample.power.map(f64::from)).collect();
    let mean = powers.iter().sum::<f64>() / powers.len().max(1) as f64;
    ensure!(mean > 0.0, "the power is {mean} while the truth says that it is off by {amount}");
    Ok(amount / mean)
}
