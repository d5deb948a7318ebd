//! What is known of a plant: its signals, models, files and truth. docs/scores.md explains the words.

use anyhow::{Context, ensure};
use serde::Deserialize;

use super::model::PARAMETERS;
use super::signs::{Sign, Signs};

/// The plants that come with the program: name and settings.
pub(super) const BUILT_IN: [(&str, &str); 2] = [
    ("lbnl", include_str!("../../defaults/plants/lbnl.toml")),
    ("tep", include_str!("../../defaults/plants/tep.toml")),
];

/// A plant.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plant {
    /// What it is and where its files come from.
    pub about: String,
    /// How many signals a file has, in columns or in rows.
    pub signals: usize,
    /// The file that is learnt from: nothing is wrong in it.
    pub training: String,
    /// Another one in which nothing is wrong.
    pub normal: String,
    /// The sample at which the fault comes in a fault's file.
    pub onset: usize,
    /// First samples of each file that do not count, while lags and low-pass fill.
    pub skip: usize,
    /// Share by which a chart moves towards its input in a sample.
    pub low_pass: f32,
    /// Share of the training that is below the threshold.
    pub quantile: f64,
    /// Samples over which a chart has a sign.
    pub window: usize,
    /// The models.
    #[serde(rename = "model")]
    pub models: Vec<Model>,
    /// Rows of the table of signs.
    #[serde(rename = "name", default)]
    pub names: Vec<Name>,
    /// What was truly wrong.
    pub faults: Vec<Truth>,
}

/// An ARX model of a signal, with a constant.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// What to call it.
    pub name: String,
    /// The signal that it predicts, from 1.
    pub output: usize,
    /// How many past values of it.
    pub order: usize,
    /// What drives it.
    pub inputs: Vec<Input>,
}

/// What drives a model.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// The signal, from 1.
    pub signal: usize,
    /// How many values of it.
    pub order: usize,
    /// How many samples ago the newest of them is; 0: now.
    pub delay: usize,
}

/// A row of the table of signs.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Name {
    /// What is said.
    pub says: String,
    /// The signs of each model in the order of the models, two letters each: of the innovation and of its square.
    pub signs: Vec<String>,
    /// The same, read.
    #[serde(skip)]
    pub(super) rows: Signs,
}

/// A fault and its files.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Truth {
    /// What it is.
    pub what: String,
    /// The file in which it comes at `onset`.
    pub file: String,
    /// Another run, with the fault from its first sample on.
    pub again: String,
    /// The row of the table of signs that is right, from 1; none: no row is.
    pub name: Option<usize>,
}

impl Plant {
    /// Reads settings.
    ///
    /// # Errors
    /// What is wrong, and what was expected.
    pub fn parse(text: &str) -> anyhow::Result<Self> {
        let mut plant: Self = toml::from_str(text)?;
        for model in &plant.models {
            let parameters = model.order + model.inputs.iter().map(|input| input.order).sum::<usize>() + 1;
            ensure!(
                parameters <= PARAMETERS,
                "model {}: {parameters} parameters with its constant, expected at most {PARAMETERS}",
                model.name
            );
            let signals = model.inputs.iter().map(|input| input.signal).chain([model.output]);
            for signal in signals {
                let all = plant.signals;
                ensure!(
                    (1..=all).contains(&signal),
                    "model {}: signal {signal}, expected 1 to {all}",
                    model.name
                );
            }
        }
        ensure!(!plant.models.is_empty(), "no [[model]]: expected at least one");
        ensure!(plant.window > 0, "window is 0, expected at least 1 sample");
        ensure!(
            plant.low_pass > 0.0 && plant.low_pass < 1.0,
            "low_pass is {}, expected 0 to 1",
            plant.low_pass
        );
        ensure!((0.0..=1.0).contains(&plant.quantile), "quantile is {}, expected 0 to 1", plant.quantile);
        let count = plant.models.len();
        for name in &mut plant.names {
            ensure!(
                name.signs.len() == count,
                "{}: {} signs for {count} models",
                name.says,
                name.signs.len()
            );
            name.rows = name
                .signs
                .iter()
                .flat_map(|two| two.chars())
                .map(Sign::parse)
                .collect::<Option<_>>()
                .filter(|rows: &Signs| rows.len() == 2 * count)
                .with_context(|| {
                    format!("{}: {:?}, expected two of + - 0 ~ ! . for each model", name.says, name.signs)
                })?;
        }
        let rows = plant.names.len();
        for Truth { what, name, .. } in &plant.faults {
            ensure!(
                name.is_none_or(|name| (1..=rows).contains(&name)),
                "{what}: name {name:?}, expected 1 to {rows}"
            );
        }
        Ok(plant)
    }
}
