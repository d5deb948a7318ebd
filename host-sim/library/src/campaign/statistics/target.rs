//! Whether what was hoped for came true.

use serde::Serialize;

use super::heat::HeatStatistics;
use super::said::SaidStatistics;
use super::{Case, FaultStatistics, Statistics, settings};
use crate::campaign::by::By;
use crate::campaign::definition::target::{Measure, Target};

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
    fn of(self, by: By, cases: &[Case]) -> Option<f64> {
        let of_heat = self.of_heat(&HeatStatistics::new(cases));
        let of_instrument = of_heat.or_else(|| self.of_said(&SaidStatistics::new(cases)));
        of_instrument.unwrap_or_else(|| self.of_diagnosis(&Statistics::new(by, cases)))
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

    /// Those that are measured of what the likelihood diagnosis said; none of the others.
    fn of_said(self, said: &SaidStatistics) -> Option<Option<f64>> {
        let fault = said.fault.as_ref();
        match self {
            Self::RightP95 => Some(fault.and_then(|f| f.right_delay_s.p95)),
            Self::EndRight => Some(fault.map(|f| f.end_right_pct)),
            Self::Lasted => Some(fault.map(|f| f.lasted_pct)),
            Self::TailP99 => Some(fault.and_then(|f| f.tail_s.p99)),
            Self::SureWrong => Some(fault.map(|f| f.sure_wrong_pct)),
            Self::EndCoverage => Some(fault.and_then(|f| f.end_coverage).map(|share| share.pct)),
            Self::Coverage => Some(said.coverage()),
            Self::Calibration => Some(said.calibration()),
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
            Self::AlarmTime => s.alarms.share_of_time.map(percent),
            Self::ToldTime => s.alarms.told_share_of_time.map(percent),
            Self::Hours => Some(s.alarms.hours),
            Self::RunsWithAlarm => s.alarms.per_hour.map(|_| s.alarms.runs_with as f64),
            Self::Unarmed => Some(s.unarmed as f64),
            _ => None,
        }
    }
}

impl Target {
    /// Who is judged: a diagnosis, or the instrument as a whole.
    pub(in crate::campaign) fn judged(&self) -> &'static str {
        match self.measure.of_heat(&HeatStatistics::default()) {
            Some(_) => "instrument",
            None => self.by.name(),
        }
    }
}

/// Judges all targets, for each setting of the sweep; those without a run are left out.
pub fn judge(targets: &[Target], cases: &[Case]) -> Vec<Outcome> {
    let mut outcomes = Vec::new();
    for setting in settings(cases) {
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
    let tells = |outcome: &Outcome| outcome.measured.is_some() || !target.measure.is_of_verdicts();
    if !target.each {
        return (!cases.is_empty()).then(|| outcome(&target.cells, cases)).filter(tells);
    }
    let by_cell = cases.chunk_by(|a, b| a.1.cell == b.1.cell);
    let all = by_cell.map(|cases| outcome(&cases[0].0.name, cases));
    all.filter(tells).min_by(|a, b| target.margin(a.measured).total_cmp(&target.margin(b.measured)))
}
