//! What was learnt, as a table.

use std::fmt::Write as _;

use super::super::intervals::{Known, numbers};
use super::super::map::Role;
use super::super::training::Trained;
use super::super::{Heater, Recording};
use super::Told;
use crate::record::report::significant;

/// A number that was learnt.
#[derive(Clone, Debug, PartialEq)]
pub struct Learnt {
    /// What it is.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// How well it is known, in its unit; none: it was not looked for.
    pub known: Option<Known>,
    /// Its unit.
    pub unit: String,
}

impl Learnt {
    /// Its 95 % interval in words; nothing where it was not looked for.
    pub fn interval(&self) -> String {
        match self.known {
            Some(Known::Within(low, high)) => format!("{} to {}", significant(low, 4), significant(high, 4)),
            Some(Known::No) => "not known".to_owned(),
            None => String::new(),
        }
    }
}

impl Told<'_> {
    /// What was learnt of the heater, in the recording's units.
    pub fn learnt(&self) -> Vec<Learnt> {
        learnt(self.recording, self.heater, &self.done.trained)
    }
}

/// What was learnt of a heater of a recording, in its units.
pub fn learnt(recording: &Recording, heater: &Heater, trained: &Trained) -> Vec<Learnt> {
    let unit = recording.unit(heater);
    let degc = 1.0 / f64::from(recording.units.celsius);
    // degC a % of the diagnosis, in units of temperature a unit of power.
    let per_power = (100.0 / f64::from(recording.units.full_power) * degc, format!("{unit} a unit of power"));
    let (seconds, percent, degrees) =
        ((1.0, "s".to_owned()), (100.0, "%".to_owned()), (degc, unit.to_owned()));
    let mut asked = vec![
        ("gain", "Gain: what T1 rises by in the end", &per_power),
        ("heater", "Heat store of the heater", &seconds),
        ("dead_time", "Dead time", &seconds),
        ("lag", "Lag of T1", &seconds),
    ];
    if trained.intervals.iter().any(|(name, _)| *name == "wall_share") {
        asked.push(("wall_share", "Share of the rise that comes slowly", &percent));
        asked.push(("wall", "Time of that share", &seconds));
    }
    if heater.map.column(Role::Known).is_some() {
        asked.push(("gain_beside", "Gain of the heater beside", &per_power));
        asked.push(("lag_beside", "Its further lag", &seconds));
    }
    if heater.inputs.t2 {
        asked.push(("transport", "Way from T1 to T2", &seconds));
        asked.push(("reaches", "Share of the rise that reaches T2", &percent));
    }
    asked.push(("noise", "What is left of T1, made white", &degrees));
    let numbers = numbers(&trained.model).into_iter().chain([("noise", trained.model.noise[0])]);
    let numbers: Vec<(&str, f32)> = numbers.collect();
    let row = |(key, name, (scale, unit)): (&str, &'static str, &(f64, String))| {
        let value =
            numbers.iter().find(|(known, _)| *known == key).map_or(f64::NAN, |(_, value)| f64::from(*value));
        let known = trained.intervals.iter().find(|(known, _)| *known == key).map(|(_, known)| *known);
        let known = known.map(|known| match known {
            Known::Within(low, high) => Known::Within(scale * low, scale * high),
            Known::No => Known::No,
        });
        Learnt { name, value: scale * value, known, unit: unit.clone() }
    };
    asked.into_iter().map(row).collect()
}

/// The same as lines of a terminal.
pub fn table(learnt: &[Learnt]) -> String {
    let mut text = format!("\n{:<36}{:>10}  {:<22}\n", "What was learnt", "value", "95 % interval");
    for one in learnt {
        let value = significant(one.value, 3);
        let _ = writeln!(text, "{:<36}{value:>10}  {:<22}{}", one.name, one.interval(), one.unit);
    }
    text
}
