//! What the runs of a campaign showed, cell by cell and diagnosis by diagnosis.

use serde::Serialize;

use super::by::By;
use super::cell::Cell;
use super::definition::{Campaign, Expect};
use super::run::RunRow;
use super::statistics::confusion::{Confusion, confusion};
use super::statistics::heat::HeatStatistics;
use super::statistics::said::{self, Confidence, SaidStatistics};
use super::statistics::target::{self, Outcome};
use super::statistics::trade::{self, Trade};
use super::statistics::variation::{self, Variation};
use super::statistics::{Case, Statistics, class};
use crate::score::expectation::Expectation;

/// Names of the cells that stand in the runaway tables, and not among the faults, begin so.
pub(super) const RUNAWAY: &str = "runaway/";

/// `campaign.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Results {
    /// One entry a cell.
    pub cells: Vec<CellResults>,
    /// True class against the verdict settled on, over the fault cells of the reference rig.
    pub confusion: Vec<Confusion>,
    /// Verdicts of the likelihood diagnosis by confidence: of all runs, and of those on each plant.
    pub confidence: Vec<(String, Vec<Confidence>)>,
    /// False alarms against delays, for each setting; empty without a sweep.
    pub trade: Vec<Trade>,
    /// What each value of `vary` is worth; empty without.
    pub variations: Vec<Variation>,
    /// Targets and what became of them.
    pub targets: Vec<Outcome>,
    /// The campaign itself.
    pub campaign: Campaign,
}

/// One cell.
#[derive(Clone, Debug, Serialize)]
pub struct CellResults {
    /// Name with size and plant.
    pub name: String,
    /// Name of the plant; empty: the reference rig.
    pub plant: String,
    /// Values of the sweep.
    pub setting: String,
    /// What should come of it.
    pub expect: Expect,
    /// How much the surroundings moved.
    pub disturbance: pt326_rig::Disturbance,
    /// Class of the fault; null where silence is expected.
    pub class: Option<&'static str>,
    /// Its true magnitude in the unit of the class.
    pub magnitude: Option<f64>,
    /// Number of runs.
    pub runs: usize,
    /// What was done with the heat.
    pub heat: HeatStatistics,
    /// Class that the likelihood diagnosis settled on in most runs; null: it named none in most.
    pub settled: Option<String>,
    /// Names that are right.
    pub right: Vec<&'static str>,
    /// What the likelihood diagnosis said, against the truth.
    pub said: SaidStatistics,
    /// By the likelihood diagnosis.
    pub likelihood: Statistics,
    /// By the paper's signatures.
    pub signature: Statistics,
}

impl Results {
    /// Of all runs.
    pub fn new(campaign: &Campaign, cells: &[Cell], rows: &[RunRow]) -> Self {
        let cases: Vec<Case> = rows.iter().map(|row| (&cells[row.cell], row)).collect();
        let of_cell = |i: usize| {
            let from = rows.partition_point(|row| row.cell < i);
            let to = rows.partition_point(|row| row.cell <= i);
            CellResults::new(&cells[i], &cases[from..to])
        };
        Self {
            cells: (0..cells.len()).map(of_cell).collect(),
            confusion: confusion(&cases),
            confidence: said::by_plant(&cases),
            trade: trade::of(&cases),
            variations: variation::of(&cases),
            targets: target::judge(&campaign.targets, &cases),
            campaign: campaign.clone(),
        }
    }
}

impl CellResults {
    /// It stands in the runaway tables, where the heat counts and not the delay of an alarm.
    pub(super) fn is_runaway(&self) -> bool {
        self.name.starts_with(RUNAWAY)
    }

    fn new(cell: &Cell, cases: &[Case]) -> Self {
        Self {
            name: cell.name.clone(),
            plant: cell.plant.clone(),
            setting: cell.setting.clone(),
            expect: cell.expect,
            disturbance: cell.scenario.disturbance,
            class: class(cell),
            magnitude: cell.fault().and_then(|f| Expectation::of(f).magnitude),
            runs: cases.len(),
            heat: HeatStatistics::new(cases),
            settled: most(cases.iter().map(|(_, row)| row.likelihood.settled.clone())),
            right: cell.right.iter().map(|class| class.name()).collect(),
            said: SaidStatistics::new(cases),
            likelihood: Statistics::new(By::Likelihood, cases),
            signature: Statistics::new(By::Signature, cases),
        }
    }

    /// The statistics of one diagnosis.
    pub fn by(&self, by: By) -> &Statistics {
        match by {
            By::Likelihood => &self.likelihood,
            By::Signature => &self.signature,
        }
    }
}

/// What comes most often; of equals, any.
fn most(all: impl Iterator<Item = Option<String>>) -> Option<String> {
    let mut counts = std::collections::BTreeMap::new();
    all.for_each(|x| *counts.entry(x).or_insert(0) += 1);
    counts.into_iter().max_by_key(|(_, count)| *count).and_then(|(most, _)| most)
}
