//! A campaign as data: what is done how often to which rigs, and what is hoped for.

use crate::score::expectation::Expectation;
use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, ensure};
use fdi_core::{Celsius, Config};
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::cell::Cell;
use super::heat::MayTrip;
use super::target::Target;
use crate::experiment::scenario::{Action, Scenario};
use pt326_rig::fault::Fault;
use pt326_rig::{Disturbance, RigConfig};

/// The default campaign, commented.
pub const CAMPAIGN_TOML: &str = include_str!("../../defaults/campaign.toml");

/// A campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Campaign {
    /// The first seed; every cell has seeds of its own, in the order of the cells.
    pub seeds_from: u64,
    /// Numbers of runs are multiplied by this.
    pub scale: f64,
    /// Only the cells whose name contains this.
    pub only: String,
    /// A fault cell goes on so long after the last thing that happens, s.
    pub rest: f64,
    /// Settings of the instrument that take each of some values in turn: `"diagnosis.sigma_factor" = [2.5, 3.0]`.
    pub sweep: BTreeMap<String, Vec<Value>>,
    /// Settings that take each of some values by itself, all others as they are; once they are all as they are.
    pub vary: BTreeMap<String, Vec<Value>>,
    /// Rigs that differ from the reference rig.
    #[serde(rename = "plant")]
    pub plants: Vec<Plant>,
    /// What is done.
    #[serde(rename = "cell")]
    pub cells: Vec<CellDefinition>,
    /// What is hoped for.
    #[serde(rename = "target")]
    pub targets: Vec<Target>,
}

impl Default for Campaign {
    fn default() -> Self {
        Self {
            seeds_from: 1_000_000,
            scale: 1.0,
            only: String::new(),
            rest: 30.0,
            sweep: BTreeMap::new(),
            vary: BTreeMap::new(),
            plants: Vec::new(),
            cells: Vec::new(),
            targets: Vec::new(),
        }
    }
}

/// A rig that differs, with what the user would tell the instrument of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plant {
    /// Name, stands behind that of the cell.
    pub name: String,
    /// Turbulence and measurement noise are multiplied by this.
    #[serde(default = "one")]
    pub noise: f64,
    /// Its constants, as in a scenario.
    #[serde(default)]
    pub rig: RigConfig,
    /// Settings of the instrument that go with it, as in a configuration.
    #[serde(default)]
    pub config: Table,
}

/// What should come of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Expect {
    /// The first fault is to be detected and isolated.
    Fault,
    /// No alarm, whatever is done.
    Silence,
}

/// Runs of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CellDefinition {
    /// Name, such as `sizes/t2_offset`.
    pub name: String,
    /// What should come of it; left out: a fault if the first of `fault` is one.
    pub expect: Option<Expect>,
    /// Number of runs, before `scale`.
    pub runs: u64,
    /// How much the surroundings move.
    #[serde(default = "lively")]
    pub disturbance: Disturbance,
    /// Everything happens later by a time drawn for each run from 0 to this, s.
    #[serde(default)]
    pub phase: f64,
    /// Each run is armed at this time, s: until then the instrument sees the rig cold.
    #[serde(default)]
    pub arm_at: f64,
    /// Length of a run, s; left out: until the last thing that happens, and `rest`.
    pub duration: Option<f64>,
    /// Sizes that the first fault takes, each in a cell of its own.
    #[serde(default)]
    pub sizes: Vec<f64>,
    /// Lags that go with the sizes, s.
    #[serde(default)]
    pub lags: Vec<f64>,
    /// Names of the plants, each in a cell of its own; none: the reference rig.
    #[serde(default)]
    pub plants: Vec<String>,
    /// The room of each run is drawn between these, degC.
    pub ambient: Option<[f64; 2]>,
    /// The set-point of each run is drawn between these, degC.
    pub setpoint: Option<[f64; 2]>,
    /// Which trips are right; left out: none.
    #[serde(default)]
    pub may_trip: MayTrip,
    /// Settings of the instrument that differ, as in a configuration.
    #[serde(default)]
    pub config: Table,
    /// What happens to the rig; the first is the one that is scored.
    #[serde(default, rename = "fault")]
    pub faults: Vec<Fault>,
    /// What the user does.
    #[serde(default, rename = "action")]
    pub actions: Vec<Action>,
}

fn one() -> f64 {
    1.0
}

fn lively() -> Disturbance {
    Disturbance::Lively
}

impl Campaign {
    /// Reads a campaign; without a path the default one.
    ///
    /// # Errors
    /// The file, and the line and key that are wrong.
    pub fn read(path: Option<&Path>) -> anyhow::Result<Self> {
        let Some(path) = path else { return Ok(toml::from_str(CAMPAIGN_TOML)?) };
        let text = std::fs::read_to_string(path).with_context(|| format!("can't read {}", path.display()))?;
        toml::from_str(&text).with_context(|| path.display().to_string())
    }

    /// All cells, every size, plant and value of the sweep in one of its own.
    ///
    /// # Errors
    /// The cell and the key that is wrong.
    pub fn expand(&self, base: &Config) -> anyhow::Result<Vec<Cell>> {
        ensure!(self.scale > 0.0 && self.scale <= 1000.0, "scale is {}, expected up to 1000", self.scale);
        ensure!((0.0..=1e5).contains(&self.rest), "rest is {}, expected 0 to 100000 s", self.rest);
        let base = Table::try_from(base)?;
        let mut cells = Vec::new();
        let mut seed = self.seeds_from;
        for definition in &self.cells {
            let place = format!("cell {:?}", definition.name);
            for plain in definition.variants(&self.plants).with_context(|| place.clone())? {
                for setting in self.settings() {
                    let cell = self.cell(&plain, seed, &base, setting);
                    cells.push(cell.with_context(|| place.clone())?);
                }
                seed += definition.runs; // the same seeds for all values of a sweep
            }
        }
        cells.retain(|cell| cell.name.contains(&self.only));
        ensure!(!cells.is_empty(), "no cell has {:?} in its name", self.only);
        Ok(cells)
    }

    fn cell(
        &self,
        variant: &Variant,
        first_seed: u64,
        base: &Table,
        (setting, values): Setting,
    ) -> anyhow::Result<Cell> {
        let definition = variant.definition;
        let mut config = base.clone();
        merge(&mut config, &variant.plant.config);
        merge(&mut config, &definition.config);
        for (key, value) in values {
            merge(&mut config, &nested(key, value));
        }
        let config =
            crate::settings::from_table(config).with_context(|| format!("its settings {setting}"))?;
        fdi_core::Instrument::new(&config).with_context(|| format!("its settings {setting}"))?;
        let ends = variant.faults.iter().map(Fault::end);
        let last =
            ends.chain(definition.actions.iter().map(|a| a.at + a.over.unwrap_or(0.0))).fold(0.0, f64::max);
        let scenario = Scenario {
            duration: definition.duration.unwrap_or(last + self.rest),
            arm_at: definition.arm_at,
            disturbance: definition.disturbance,
            rig: variant.plant.noisy_rig(),
            faults: variant.faults.clone(),
            actions: definition.actions.clone(),
        };
        scenario.validate()?;
        let is_fault = scenario.faults.first().is_some_and(|f| f.expected_class().is_some());
        let expect = definition.expect.unwrap_or(if is_fault { Expect::Fault } else { Expect::Silence });
        ensure!(expect == Expect::Silence || is_fault, "expect: its first fault is none that could be named");
        let phase = definition.phase;
        ensure!((0.0..=1e4).contains(&phase), "phase is {phase}, expected 0 to 10000 s");
        ensure!(definition.runs > 0, "runs is 0, expected 1 or more");
        definition.check_draws(&config)?;
        Ok(Cell {
            name: variant.name.clone(),
            plant: variant.plant.name.clone(),
            setting,
            expect,
            runs: ((definition.runs as f64 * self.scale).round() as u64).clamp(1, 1_000_000),
            first_seed,
            may_trip: definition.may_trip.clone(),
            ambient: definition.ambient,
            setpoint: definition.setpoint,
            phase,
            scenario,
            config,
        })
    }

    /// Every combination of the values of the sweep, with its name; each with every variation by itself.
    fn settings(&self) -> Vec<Setting<'_>> {
        let mut all: Vec<Setting> = vec![(String::new(), Vec::new())];
        for (key, values) in &self.sweep {
            all = all.iter().flat_map(|before| values.iter().map(|value| and(before, key, value))).collect();
        }
        let varied =
            || self.vary.iter().flat_map(|(key, values)| values.iter().map(move |value| (key, value)));
        let each = all.iter().flat_map(|before| {
            std::iter::once(before.clone()).chain(varied().map(|(key, value)| and(before, key, value)))
        });
        each.collect()
    }
}

/// A combination with one value more.
fn and<'a>((name, pairs): &Setting<'a>, key: &'a str, value: &'a Value) -> Setting<'a> {
    let space = if name.is_empty() { "" } else { " " };
    (format!("{name}{space}{key}={value}"), [pairs.as_slice(), &[(key, value)]].concat())
}

/// One combination of values of the sweep: its name, and the values by key.
type Setting<'a> = (String, Vec<(&'a str, &'a Value)>);

/// A cell with one size on one plant.
struct Variant<'a> {
    definition: &'a CellDefinition,
    name: String,
    faults: Vec<Fault>,
    plant: Plant,
}

impl CellDefinition {
    /// Both ends of what is drawn must be such as could be set.
    fn check_draws(&self, config: &Config) -> anyhow::Result<()> {
        for (name, range) in [("ambient", self.ambient), ("setpoint", self.setpoint)] {
            let Some([low, high]) = range else { continue };
            ensure!(low <= high, "{name} is [{low}, {high}], expected the lower one first");
        }
        for ambient in self.ambient.into_iter().flatten() {
            RigConfig { ambient, ..RigConfig::default() }.validate()?;
        }
        for setpoint in self.setpoint.into_iter().flatten() {
            fdi_core::Instrument::new(&Config { setpoint: Celsius(setpoint as f32), ..config.clone() })?;
        }
        Ok(())
    }

    fn variants(&self, plants: &[Plant]) -> anyhow::Result<Vec<Variant<'_>>> {
        ensure!(!self.name.is_empty(), "expected a `name`");
        ensure!(self.sizes.is_empty() || !self.faults.is_empty(), "sizes: expected a `fault`");
        ensure!(
            self.lags.is_empty() || self.lags.len() == self.sizes.len(),
            "lags: {} values, expected as many as `sizes` has, {}",
            self.lags.len(),
            self.sizes.len()
        );
        let mut chosen = Vec::new();
        for name in &self.plants {
            let plant = plants.iter().find(|plant| plant.name == *name);
            chosen.push(
                plant.with_context(|| format!("plants: there is no [[plant]] named {name:?}"))?.clone(),
            );
        }
        if chosen.is_empty() {
            chosen.push(Plant {
                name: String::new(),
                noise: 1.0,
                rig: RigConfig::default(),
                config: Table::new(),
            });
        }
        let sizes: Vec<Option<f64>> =
            if self.sizes.is_empty() { vec![None] } else { self.sizes.iter().copied().map(Some).collect() };
        let mut variants = Vec::new();
        for plant in chosen {
            for (i, &size) in sizes.iter().enumerate() {
                let mut faults = self.faults.clone();
                let mut name = self.name.clone();
                if let (Some(size), Some(fault)) = (size, faults.first_mut()) {
                    fault.size = Some(size);
                    name += &format!(" {size}");
                    if let Some(&lag) = self.lags.get(i) {
                        fault.lag = Some(lag);
                        name += &format!("/{lag}");
                    }
                }
                if !plant.name.is_empty() {
                    name += &format!(" @ {}", plant.name);
                }
                variants.push(Variant { definition: self, name, faults, plant: plant.clone() });
            }
        }
        Ok(variants)
    }
}

impl Plant {
    fn noisy_rig(&self) -> RigConfig {
        RigConfig {
            turbulence: self.rig.turbulence * self.noise,
            white_noise: self.rig.white_noise * self.noise,
            ..self.rig.clone()
        }
    }
}

/// Puts every key of `over` into `table`.
fn merge(table: &mut Table, over: &Table) {
    for (key, value) in over {
        match (table.get_mut(key), value) {
            (Some(Value::Table(inner)), Value::Table(over)) => merge(inner, over),
            _ => drop(table.insert(key.clone(), value.clone())),
        }
    }
}

/// `a.b = value` as nested tables.
fn nested(key: &str, value: &Value) -> Table {
    match key.split_once('.') {
        Some((head, rest)) => Table::from_iter([(head.into(), Value::Table(nested(rest, value)))]),
        None => Table::from_iter([(key.into(), value.clone())]),
    }
}
