//! A campaign as data: what is done how often to which rigs, and what is hoped for.

pub mod may_trip;
pub mod target;

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
pub use may_trip::MayTrip;
use serde::{Deserialize, Serialize};
use target::Target;
use toml::{Table, Value};

use crate::experiment::scenario::Action;
use pt326_rig::fault::Fault;
use pt326_rig::{Disturbance, RigConfig};

/// The default campaign, commented.
pub const CAMPAIGN_TOML: &str = include_str!("../../../defaults/campaign.toml");
/// The campaign on physics that no model has.
pub const PHYSICS_TOML: &str = include_str!("../../../defaults/physics.toml");
/// The runs that show what each number of the likelihood diagnosis is worth.
pub const ABLATION_TOML: &str = include_str!("../../../defaults/ablation.toml");
/// Share of the runs that a built-in campaign does when nobody asks for all.
pub const USUAL: f64 = 0.25;
/// The same when it is to be quick.
pub const QUICK: f64 = 0.05;

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
    /// Runs are armed at this time, where their cell says none, s.
    pub arm_at: f64,
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
            arm_at: 0.0,
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
    /// The name of a preset of the instrument (`oven`, `hotend`, `tclab`) whose settings go with it; all times of a cell are longer by
    /// the ratio of the sample times.
    pub instrument: Option<String>,
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
    /// Names of classes of which each is right; left out: that of the first fault. Where silence is expected an alarm stays wrong,
    /// but a verdict with one of these names is true.
    #[serde(default)]
    pub right: Vec<String>,
    /// Number of runs, before `scale`.
    pub runs: u64,
    /// Only a campaign of at least this `scale` has it.
    #[serde(default)]
    pub from_scale: f64,
    /// How much the surroundings move.
    #[serde(default = "lively")]
    pub disturbance: Disturbance,
    /// Everything happens later by a time drawn for each run from 0 to this, s.
    #[serde(default)]
    pub phase: f64,
    /// Each run is armed at this time, s: until then the instrument sees the rig cold. Left out: that of the campaign.
    pub arm_at: Option<f64>,
    /// Length of a run, s; left out: until the last thing that happens, and `rest`.
    pub duration: Option<f64>,
    /// Sizes that the first fault takes, each in a cell of its own.
    #[serde(default)]
    pub sizes: Vec<f64>,
    /// Lags that go with the sizes, s.
    #[serde(default)]
    pub lags: Vec<f64>,
    /// Names of the plants, each in a cell of its own; a star in one stands for anything. None: the reference rig.
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

/// Whether a pattern means a name: one star in it stands for anything.
pub(in crate::campaign) fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        Some((head, tail)) => {
            name.len() >= head.len() + tail.len() && name.starts_with(head) && name.ends_with(tail)
        }
        None => name == pattern,
    }
}

fn one() -> f64 {
    1.0
}

fn lively() -> Disturbance {
    Disturbance::Lively
}

impl Campaign {
    /// Reads a campaign.
    ///
    /// # Errors
    /// The file, and the line and key that are wrong.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| format!("can't read {}", path.display()))?;
        toml::from_str(&text).with_context(|| path.display().to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plant_starts_from_a_preset_and_changes_it() {
        let plant = |rig: &str| toml::from_str::<Plant>(&format!("name = \"p\"\nrig = {rig}"));
        let harsh = plant("{ preset = \"harsh\", gain = 0.4, fan = { hunting = 0.0 } }").unwrap().rig;
        let mut expected = RigConfig::preset("harsh").unwrap();
        expected.gain = 0.4;
        expected.fan.hunting = 0.0;
        assert_eq!(harsh, expected);
        let error = plant("{ preset = \"kettle\" }").unwrap_err().to_string();
        assert!(error.contains("kettle") && error.contains("harsh, recorded"), "{error}");
    }
}
