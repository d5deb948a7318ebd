//! What is hoped for, as data.

use serde::{Deserialize, Serialize};

use super::matches;
use crate::campaign::by::By;

/// A bound on a measure of some cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Name of the cells; a star in it stands for anything.
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
    /// 95th percentile of the time from the onset to the first right name, s; one for two causes counts.
    RightP95,
    /// Runs whose name at the end of the fault was right, %.
    EndRight,
    /// Runs whose alarm, once raised, stood to the end of the fault without a break, %.
    Lasted,
    /// 99th percentile of the time that an alarm outlives its fault, s.
    TailP99,
    /// Runs in which a wrong name was said above 0.95 later than 5 s after the onset, %.
    SureWrong,
    /// Runs whose interval at the end of the fault holds the size that it had then, %; of those with the right name.
    EndCoverage,
    /// Verdicts of the right class whose interval holds the size of their moment, %; left out below 100 of them.
    Coverage,
    /// Verdicts of about one confidence: the share that is right above that confidence, in points of %, of the worst bin with 100
    /// verdicts or more.
    Calibration,
    /// Time beside the fault that an alarm stood that was no advice, %.
    AlarmTime,
    /// Time beside the fault that an alarm or advice stood, %.
    ToldTime,
    /// Alarms an hour beside the fault, without what is only advice.
    AlarmsPerHour,
    /// Hours watched.
    Hours,
    /// Runs with an alarm or advice beside the fault; does not exist where it never watched.
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

impl Measure {
    /// Whether it is a share of verdicts: where there are too few it is not missed, but left out.
    pub(in crate::campaign) fn is_of_verdicts(self) -> bool {
        matches!(self, Self::Coverage | Self::EndCoverage | Self::Calibration)
    }

    /// Its name in a definition.
    pub fn name(self) -> String {
        serde_json::to_value(self).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
    }
}

impl Target {
    /// Whether it is about the cell of this name.
    pub(in crate::campaign) fn chooses(&self, name: &str) -> bool {
        matches(&self.cells, name)
    }

    /// How far a value lies on the good side of its bounds; negative: missed.
    pub(in crate::campaign) fn margin(&self, measured: Option<f64>) -> f64 {
        let Some(x) = measured else { return f64::NEG_INFINITY };
        let below = self.at_most.map_or(f64::INFINITY, |bound| bound - x);
        let above = self.at_least.map_or(f64::INFINITY, |bound| x - bound);
        below.min(above)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(cells: &str, at_most: Option<f64>, at_least: Option<f64>) -> Target {
        let by = By::Likelihood;
        Target { cells: cells.into(), measure: Measure::Missed, by, each: false, at_most, at_least }
    }

    #[test]
    fn cells_are_chosen_by_name_with_a_star_for_anything() {
        let chooses = |cells, name| target(cells, None, None).chooses(name);
        assert!(chooses("a/*", "a/b 1") && !chooses("a/*", "ba/b"));
        assert!(chooses("*@ p", "a/b @ p") && chooses("*", "a") && chooses("a/* @ p", "a/b @ p"));
        assert!(!chooses("*@ p", "a/b @ p2") && !chooses("ab*ba", "aba"));
        assert!(target("a/b", None, None).chooses("a/b") && !target("a/b", None, None).chooses("a/b 1"));
    }

    #[test]
    fn what_never_happened_misses_every_bound() {
        assert!(target("a", Some(1.0), None).margin(None) < 0.0);
        assert!(target("a", Some(1.0), None).margin(Some(1.0)) >= 0.0);
        assert!(target("a", Some(1.0), Some(0.5)).margin(Some(0.25)) < 0.0);
    }
}
