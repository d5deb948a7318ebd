//! From the definition of a campaign to its cells: every size, plant and value of the sweep in one of its own.

use anyhow::{Context, ensure};
use fdi_core::likelihood::FaultClass;
use fdi_core::{Celsius, Config};
use pt326_rig::RigConfig;
use pt326_rig::fault::Fault;
use toml::{Table, Value};

use super::cell::Cell;
use super::definition::{Campaign, CellDefinition, Expect, Plant, matches};
use crate::experiment::scenario::Scenario;
use crate::experiment::slowness;
use crate::score::expectation::Expectation;
use crate::settings::{merge, preset};

impl Campaign {
    /// All cells.
    ///
    /// # Errors
    /// The cell and the key that is wrong.
    pub fn expand(&self, base: &Config) -> anyhow::Result<Vec<Cell>> {
        ensure!(self.scale > 0.0 && self.scale <= 1000.0, "scale is {}, expected up to 1000", self.scale);
        ensure!((0.0..=1e5).contains(&self.rest), "rest is {}, expected 0 to 100000 s", self.rest);
        let base = Table::try_from(base)?;
        let mut cells = Vec::new();
        let mut seed = self.seeds_from;
        let enough = |cell: &CellDefinition| self.scale >= cell.from_scale;
        for definition in &self.cells {
            let place = format!("cell {:?}", definition.name);
            for plain in definition.variants(&self.plants).with_context(|| place.clone())? {
                let is_wanted = enough(definition) && plain.name.contains(&self.only);
                for setting in self.settings().into_iter().filter(|_| is_wanted) {
                    let cell = self.cell(&plain, seed, &base, setting);
                    cells.push(cell.with_context(|| place.clone())?);
                }
                seed += definition.runs; // the same seeds for all values of a sweep
            }
        }
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
        merge(&mut config, &variant.plant.preset()?);
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
            arm_at: definition.arm_at.unwrap_or(self.arm_at),
            disturbance: definition.disturbance,
            rig: variant.plant.noisy_rig(),
            faults: variant.faults.clone(),
            actions: definition.actions.clone(),
        };
        let slowness = if variant.plant.instrument.is_some() { slowness(&config) } else { 1.0 };
        let scenario = scenario.slowed(slowness);
        scenario.validate()?;
        let is_fault = scenario.faults.first().is_some_and(|f| Expectation::of(f).class.is_some());
        let expect = definition.expect.unwrap_or(if is_fault { Expect::Fault } else { Expect::Silence });
        ensure!(expect == Expect::Silence || is_fault, "expect: its first fault is none that could be named");
        let own = scenario.faults.first().filter(|_| expect == Expect::Fault);
        let own = own.and_then(|f| Expectation::of(f).class).into_iter();
        let right = if definition.right.is_empty() { own.collect() } else { definition.classes()? };
        let phase = definition.phase * slowness;
        ensure!((0.0..=1e4).contains(&phase), "phase is {phase}, expected 0 to 10000 s");
        ensure!(definition.runs > 0, "runs is 0, expected 1 or more");
        definition.check_draws(&config)?;
        Ok(Cell {
            name: variant.name.clone(),
            plant: variant.plant.name.clone(),
            setting,
            expect,
            right,
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

    /// # Errors
    /// A name in `right` that is no class's.
    fn classes(&self) -> anyhow::Result<Vec<FaultClass>> {
        let class = |name: &String| {
            let class = FaultClass::ALL.into_iter().find(|class| class.name() == name);
            class.with_context(|| format!("right: no class is named {name:?}"))
        };
        self.right.iter().map(class).collect()
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
            let before = chosen.len();
            chosen.extend(plants.iter().filter(|plant| matches(name, &plant.name)).cloned());
            ensure!(chosen.len() > before, "plants: there is no [[plant]] named {name:?}");
        }
        if chosen.is_empty() {
            chosen.push(Plant {
                name: String::new(),
                noise: 1.0,
                rig: RigConfig::default(),
                instrument: None,
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
    /// What the settings of its instrument change.
    fn preset(&self) -> anyhow::Result<Table> {
        let Some(name) = &self.instrument else { return Ok(Table::new()) };
        let preset = preset(name)?;
        ensure!(!preset.is_empty(), "instrument is {name:?}, expected a preset with settings of its own");
        Ok(preset)
    }

    fn noisy_rig(&self) -> RigConfig {
        RigConfig {
            turbulence: self.rig.turbulence * self.noise,
            white_noise: self.rig.white_noise * self.noise,
            ..self.rig.clone()
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
