//! Which fault was taken for which.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{Case, class};
use crate::campaign::by::By;

/// One entry of a confusion matrix.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Confusion {
    /// Values of the sweep.
    pub setting: String,
    /// Which diagnosis.
    pub by: By,
    /// True class.
    pub class: String,
    /// Class settled on; `none`: nothing was named.
    pub verdict: String,
    /// Runs.
    pub runs: u32,
}

/// Counts the verdicts that runs on the reference rig settled on, of both diagnoses.
pub(in crate::campaign) fn confusion(cases: &[Case]) -> Vec<Confusion> {
    let mut counts: BTreeMap<(&str, By, &str, &str), u32> = BTreeMap::new();
    for (cell, row) in cases.iter().filter(|(cell, _)| cell.plant.is_empty()) {
        let Some(class) = class(cell) else { continue };
        for by in By::BOTH {
            let verdict = row.by(by).settled.as_deref().unwrap_or("none");
            *counts.entry((&cell.setting, by, class, verdict)).or_default() += 1;
        }
    }
    let entry = |((setting, by, class, verdict), runs): ((&str, By, &str, &str), u32)| Confusion {
        setting: setting.into(),
        by,
        class: class.into(),
        verdict: verdict.into(),
        runs,
    };
    counts.into_iter().map(entry).collect()
}
