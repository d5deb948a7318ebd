//! What each value of `vary` is worth: its runs against the same runs with everything as it is, by the likelihood diagnosis.

use std::collections::HashMap;

use serde::Serialize;

use super::quantiles::Quantiles;
use super::{Case, settings};
use crate::campaign::cell::Cell;
use crate::campaign::run::RunRow;
use crate::experiment::as_written;
use crate::score::expectation::is_right;

/// What was counted with one setting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Counts {
    /// Runs.
    pub runs: usize,
    /// Runs with a fault.
    pub faults: usize,
    /// Alarms beside the faults.
    pub false_alarms: u32,
    /// Faults that were not detected.
    pub missed: usize,
    /// Faults that were detected, and whose class settled on was a wrong one.
    pub named_wrong: usize,
    /// Faults that were named rightly when they ended.
    pub right_at_end: usize,
    /// Intervals said under a right name, one a second.
    pub intervals: u64,
    /// How many of them held the true size.
    pub held: u64,
}

/// One setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Variation {
    /// The value, as `key=value`; empty: everything as it is.
    pub setting: String,
    /// What was counted.
    pub counts: Counts,
    /// Delay of the detection over all faults, s; missed: infinitely late.
    pub delay_s: Quantiles,
    /// Runs of which anything that is kept is another than with everything as it is, to the last bit.
    pub differ: usize,
    /// By how many % the faults that are detected with and without it are detected later; geometric mean, delays of less than a tick count as a tick.
    pub later_pct: f64,
}

/// Everything as it is, then each value; none where nothing is varied.
pub fn of(cases: &[Case]) -> Vec<Variation> {
    let by_setting = |setting: &str| -> Vec<Case> {
        cases.iter().copied().filter(|(cell, _)| cell.setting == setting).collect()
    };
    let settings = settings(cases);
    if settings.len() < 2 || !settings[0].is_empty() {
        return Vec::new();
    }
    let plain: HashMap<(&str, u64), &RunRow> =
        by_setting("").iter().map(|(cell, row)| ((cell.name.as_str(), row.run), *row)).collect();
    settings.iter().map(|setting| Variation::new(setting, &by_setting(setting), &plain)).collect()
}

impl Variation {
    fn new(setting: &str, cases: &[Case], plain: &HashMap<(&str, u64), &RunRow>) -> Self {
        let pairs = || cases.iter().map(|&(cell, row)| (cell, row, plain[&(cell.name.as_str(), row.run)]));
        let later: Vec<f64> = pairs().filter_map(|(cell, row, plain)| later(cell, row, plain)).collect();
        let mean = later.iter().sum::<f64>() / later.len().max(1) as f64;
        let faulty = cases.iter().filter(|(cell, _)| cell.fault().is_some());
        Self {
            setting: setting.into(),
            counts: Counts::new(cases),
            delay_s: Quantiles::of(faulty.map(|(_, row)| row.likelihood.detection_delay_s)),
            differ: pairs().filter(|(_, row, plain)| differs(row, plain)).count(),
            later_pct: 100.0 * libm::expm1(mean),
        }
    }
}

/// ln of the ratio of both delays.
fn later(cell: &Cell, row: &RunRow, plain: &RunRow) -> Option<f64> {
    let tick = as_written(cell.config.sample_time.0);
    let ln = |row: &RunRow| Some(libm::log(row.likelihood.detection_delay_s?.max(tick)));
    Some(ln(row)? - ln(plain)?)
}

fn differs(row: &RunRow, plain: &RunRow) -> bool {
    RunRow { cell: plain.cell, ..row.clone() } != *plain
}

impl Counts {
    fn new(cases: &[Case]) -> Self {
        let mut all = Self { runs: cases.len(), ..Self::default() };
        for (cell, row) in cases {
            let (said, observed) = (&row.said, &row.likelihood);
            all.false_alarms += observed.alarms;
            all.intervals += said.intervals;
            all.held += said.held;
            if cell.fault().is_none() {
                continue;
            }
            let is_wrong = observed.settled.as_ref().is_some_and(|name| !is_right(&cell.right, name));
            let missed = observed.detection_delay_s.is_none();
            all.faults += 1;
            all.missed += usize::from(missed);
            all.named_wrong += usize::from(is_wrong && !missed);
            all.right_at_end += usize::from(said.end_right == Some(true));
        }
        all
    }

    /// Share of the intervals that held, %.
    pub fn held_pct(&self) -> Option<f64> {
        (self.intervals > 0).then(|| 100.0 * self.held as f64 / self.intervals as f64)
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::Config;

    use super::*;
    use crate::campaign::definition::Campaign;
    use crate::campaign::run::Observation;

    #[test]
    fn runs_are_held_against_the_same_runs_with_everything_as_it_is() {
        let text = "[vary]\n\"pid.kp\" = [1.0]\n[[cell]]\nname = \"a\"\nruns = 2\nfault = [{ do = \"air-flow\", size = 1.25, at = 400.0, for = 25.0 }]";
        let campaign: Campaign = toml::from_str(text).unwrap();
        let cells = campaign.expand(&Config::default()).unwrap();
        let row = |cell, run, delay: Option<f64>, settled: &str| {
            let likelihood = Observation {
                detection_delay_s: delay,
                settled: Some(settled.into()),
                alarms: cell as u32,
                ..Observation::default()
            };
            RunRow { cell, run, likelihood, ..RunRow::default() }
        };
        let rows = [
            row(0, 0, Some(1.0), "air_flow"),
            row(0, 1, Some(0.0), "air_flow"),
            row(1, 0, Some(2.0), "drift"),
            row(1, 1, None, "drift"),
        ];
        let cases: Vec<Case> = rows.iter().map(|row| (&cells[row.cell], row)).collect();
        let [plain, varied] = &of(&cases)[..] else { panic!("two settings") };
        assert_eq!((plain.setting.as_str(), plain.differ, plain.later_pct), ("", 0, 0.0));
        assert_eq!((varied.setting.as_str(), varied.differ), ("pid.kp=1.0", 2));
        assert!((varied.later_pct - 100.0).abs() < 1e-9, "{varied:?}: 2 s for 1 s, the other was missed");
        let Counts { false_alarms, missed, named_wrong, .. } = varied.counts;
        assert_eq!((false_alarms, missed, named_wrong), (2, 1, 1), "what is missed is not named");
        assert!(of(&cases[..2]).is_empty(), "nothing is varied");
    }
}
