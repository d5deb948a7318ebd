//! What a setting buys and what it costs: delays of the nominal faults against false alarms.

use serde::Serialize;

use super::quantiles::Quantiles;
use super::{AlarmStatistics, Case, Statistics, settings};
use crate::campaign::by::By;
use crate::campaign::cell::Cell;
use crate::campaign::definition::Expect;
use pt326_rig::Disturbance;

/// Names of the cells whose delays are compared begin so.
const NOMINAL: &str = "nominal/";

/// One setting, by one diagnosis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trade {
    /// Values of the sweep; empty: as they are.
    pub setting: String,
    /// Which diagnosis.
    pub by: By,
    /// Alarms in lively surroundings with nothing done.
    pub undisturbed: AlarmStatistics,
    /// Runs with something that must not alarm, and how many of them did.
    pub disturbed_runs: usize,
    /// Those with an alarm.
    pub disturbed_with_alarm: usize,
    /// The nominal faults.
    pub faults: Vec<NominalFault>,
    /// Runs with any fault of the reference rig that were named rightly at first, %; where it has a name for it.
    pub first_right_pct: Option<f64>,
    /// Such runs whose fault was missed, %.
    pub missed_pct: Option<f64>,
}

/// One nominal fault.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NominalFault {
    /// Name of the cell.
    pub name: String,
    /// Delay of the detection, s.
    pub detection_delay_s: Quantiles,
}

/// The trade of every setting; none where there is but one.
pub fn of(cases: &[Case]) -> Vec<Trade> {
    let settings = settings(cases);
    if settings.len() < 2 {
        return Vec::new();
    }
    let all = settings.iter().flat_map(|setting| By::BOTH.map(|by| trade(setting, by, cases)));
    all.collect()
}

fn trade(setting: &str, by: By, cases: &[Case]) -> Trade {
    let chosen = |is: &dyn Fn(&Cell) -> bool| -> Vec<Case> {
        cases.iter().copied().filter(|(cell, _)| cell.setting == setting && is(cell)).collect()
    };
    let silent = |cell: &Cell| cell.expect == Expect::Silence && cell.plant.is_empty();
    let disturbed = chosen(&|cell| silent(cell) && !is_undisturbed(cell));
    let undisturbed = chosen(&|cell| {
        silent(cell) && is_undisturbed(cell) && cell.scenario.disturbance == Disturbance::Lively
    });
    let nominal = chosen(&|cell| cell.name.starts_with(NOMINAL) && cell.fault().is_some());
    let faults = nominal.chunk_by(|a, b| a.1.cell == b.1.cell).map(|cases| NominalFault {
        name: cases[0].0.name.clone(),
        detection_delay_s: Statistics::new(by, cases).fault.map(|f| f.detection_delay_s).unwrap_or_default(),
    });
    let faulty = chosen(&|cell| cell.fault().is_some() && cell.plant.is_empty());
    let any = Statistics::new(by, &faulty).fault;
    Trade {
        setting: setting.into(),
        by,
        undisturbed: Statistics::new(by, &undisturbed).alarms,
        disturbed_runs: disturbed.len(),
        disturbed_with_alarm: Statistics::new(by, &disturbed).alarms.runs_with,
        faults: faults.collect(),
        first_right_pct: any.as_ref().map(|f| f.first_right_pct),
        missed_pct: any.map(|f| 100.0 * f.missed as f64 / f.runs as f64),
    }
}

/// Nothing is done in it.
fn is_undisturbed(cell: &Cell) -> bool {
    cell.scenario.faults.is_empty() && cell.scenario.actions.is_empty()
}
