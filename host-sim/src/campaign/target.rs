//! What is hoped for, as data, and whether it came true.

use serde::{Deserialize, Serialize};

use super::heat::HeatStatistics;
use super::results::{By, Case, FaultStatistics, Statistics};

/// A bound on a measure of some cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Name of the cells; one that ends with `*` stands for all that begin so.
    pub cells: String,
    /// What is measured.
    pub measure: Measure,
    /// Which diagnosis.
    #[serde(default)]
    pub by: By,
    /// It is to hold for each cell by itself, not for all their runs together.
    #[serde(default)]
    pub each: bool,
    /// Upper bound.
    pub at_most: Option<f64>,
    /// Lower bound.
    pub at_least: Option<f64>,
}

/// What can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// Median delay of the detection, s.
    DetectionMedian,
    /// 95th percentile of the delay of the detection, s.
    DetectionP95,
    /// 95th percentile of the delay of the isolation, s.
    IsolationP95,
    /// Runs in which the fault was not detected, %.
    Missed,
    /// Runs in which it was rightly isolated at some time, %.
    Isolated,
    /// Runs in which the class named first was right, %.
    FirstRight,
    /// Runs in which the class settled on was right, %.
    SettledRight,
    /// 95th percentile of |indicated - true duration|, s.
    DurationErrorP95,
    /// Median of |estimated / true magnitude - 1|, %.
    MagnitudeErrorMedian,
    /// 95th percentile of the same, %.
    MagnitudeErrorP95,
    /// Runs whose interval holds the true magnitude, %.
    MagnitudeCoverage,
    /// Alarms an hour beside the fault.
    AlarmsPerHour,
    /// Hours watched.
    Hours,
    /// Runs with an alarm beside the fault; does not exist where it never watched.
    RunsWithAlarm,
    /// Runs in which it did not watch when it should have: silence means nothing then.
    Unarmed,
    /// Runs that tripped, %.
    Tripped,
    /// Runs that tripped for a reason that the cell does not allow, or before the fault, %.
    TrippedOtherwise,
    /// Highest true temperature of the air at T1 over the set-point, of any run, degC.
    OvershootMax,
    /// Longest time from the onset to heater off; does not exist where a run never did.
    OffDelayMax,
    /// The same from when the fault could be seen in a thermistor or in a saturated controller.
    OffAfterVisibleMax,
    /// Longest time at full power, s.
    SaturatedMax,
    /// Longest time at more than 1.8 times the power that the set-point needed, s; does not exist where a run never learnt.
    OverpowerMax,
}

/// A target and what became of it.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// The target.
    pub target: Target,
    /// Values of the sweep.
    pub setting: String,
    /// The cell that it was judged by: the worst, or all of them.
    pub judged: String,
    /// What was measured; null: never, or no such run.
    pub measured: Option<f64>,
    /// Whether it holds.
    pub met: bool,
    /// Number of runs behind it.
    pub runs: usize,
}

impl Measure {
    /// Its name in a definition.
    pub fn name(self) -> String {
        serde_json::to_value(self).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
    }

    fn of(self, by: By, cases: &[Case]) -> Option<f64> {
        match self.of_heat(&HeatStatistics::new(cases)) {
            Some(measured) => measured,
            None => self.of_diagnosis(&Statistics::new(by, cases)),
        }
    }

    /// Those that are measured of the instrument as a whole; none of the others.
    fn of_heat(self, heat: &HeatStatistics) -> Option<Option<f64>> {
        match self {
            Self::Tripped => Some(Some(heat.tripped_pct)),
            Self::TrippedOtherwise => Some(Some(heat.tripped_otherwise_pct)),
            Self::OvershootMax => Some(heat.overshoot_max_c),
            Self::OffDelayMax => Some(heat.off_delay_max_s),
            Self::OffAfterVisibleMax => Some(heat.off_after_visible_max_s),
            Self::SaturatedMax => Some(heat.saturated_max_s),
            Self::OverpowerMax => Some(heat.overpower_max_s),
            _ => None,
        }
    }

    /// Those that are measured of one diagnosis.
    fn of_diagnosis(self, s: &Statistics) -> Option<f64> {
        let fault = s.fault.as_ref();
        let share = |count: usize| 100.0 * count as f64 / s.runs as f64;
        let percent = |x: f64| 100.0 * x;
        match self {
            Self::DetectionMedian => fault?.detection_delay_s.median,
            Self::DetectionP95 => fault?.detection_delay_s.p95,
            Self::IsolationP95 => fault?.isolation_delay_s.p95,
            Self::Missed => fault.map(|f| share(f.missed)),
            Self::Isolated => fault.map(|f: &FaultStatistics| 100.0 - share(f.not_isolated)),
            Self::FirstRight => fault.map(|f| f.first_right_pct),
            Self::SettledRight => fault.map(|f| f.settled_right_pct),
            Self::DurationErrorP95 => fault?.duration_error_s.p95,
            Self::MagnitudeErrorMedian => fault?.magnitude_error.median.map(percent),
            Self::MagnitudeErrorP95 => fault?.magnitude_error.p95.map(percent),
            Self::MagnitudeCoverage => fault?.magnitude_coverage_pct,
            Self::AlarmsPerHour => s.alarms.per_hour,
            Self::Hours => Some(s.alarms.hours),
            Self::RunsWithAlarm => s.alarms.per_hour.map(|_| s.alarms.runs_with as f64),
            Self::Unarmed => Some(s.unarmed as f64),
            _ => None,
        }
    }
}

impl Target {
    /// Who is judged: a diagnosis, or the instrument as a whole.
    pub(super) fn judged(&self) -> &'static str {
        match self.measure.of_heat(&HeatStatistics::default()) {
            Some(_) => "instrument",
            None => self.by.name(),
        }
    }

    fn chooses(&self, name: &str) -> bool {
        match self.cells.strip_suffix('*') {
            Some(head) => name.starts_with(head),
            None => name == self.cells,
        }
    }

    /// How far a value lies on the good side of its bounds; negative: missed.
    fn margin(&self, measured: Option<f64>) -> f64 {
        let Some(x) = measured else { return f64::NEG_INFINITY };
        let below = self.at_most.map_or(f64::INFINITY, |bound| bound - x);
        let above = self.at_least.map_or(f64::INFINITY, |bound| x - bound);
        below.min(above)
    }
}

/// Judges all targets, for each setting of the sweep; those without a run are left out.
pub fn judge(targets: &[Target], cases: &[Case]) -> Vec<Outcome> {
    let mut settings: Vec<&str> = Vec::new();
    for (cell, _) in cases {
        if !settings.contains(&cell.setting.as_str()) {
            settings.push(&cell.setting);
        }
    }
    let mut outcomes = Vec::new();
    for setting in settings {
        for target in targets {
            let chosen: Vec<Case> = cases
                .iter()
                .copied()
                .filter(|(cell, _)| cell.setting == setting && target.chooses(&cell.name))
                .collect();
            outcomes.extend(judge_one(target, setting, &chosen));
        }
    }
    outcomes
}

fn judge_one(target: &Target, setting: &str, cases: &[Case]) -> Option<Outcome> {
    let outcome = |judged: &str, cases: &[Case]| {
        let measured = target.measure.of(target.by, cases);
        let met = target.margin(measured) >= 0.0;
        Outcome {
            target: target.clone(),
            setting: setting.into(),
            judged: judged.into(),
            measured,
            met,
            runs: cases.len(),
        }
    };
    if !target.each {
        return (!cases.is_empty()).then(|| outcome(&target.cells, cases));
    }
    let by_cell = cases.chunk_by(|a, b| a.1.cell == b.1.cell);
    let all = by_cell.map(|cases| outcome(&cases[0].0.name, cases));
    all.min_by(|a, b| target.margin(a.measured).total_cmp(&target.margin(b.measured)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(cells: &str, at_most: Option<f64>, at_least: Option<f64>) -> Target {
        let by = By::Likelihood;
        Target { cells: cells.into(), measure: Measure::Missed, by, each: false, at_most, at_least }
    }

    #[test]
    fn cells_are_chosen_by_name_or_by_how_it_begins() {
        assert!(target("a/*", None, None).chooses("a/b 1") && !target("a/*", None, None).chooses("ba/b"));
        assert!(target("a/b", None, None).chooses("a/b") && !target("a/b", None, None).chooses("a/b 1"));
    }

    #[test]
    fn what_never_happened_misses_every_bound() {
        assert!(target("a", Some(1.0), None).margin(None) < 0.0);
        assert!(target("a", Some(1.0), None).margin(Some(1.0)) >= 0.0);
        assert!(target("a", Some(1.0), Some(0.5)).margin(Some(0.25)) < 0.0);
    }
}
