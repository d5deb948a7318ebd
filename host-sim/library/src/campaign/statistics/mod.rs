//! What many runs of some cells showed, one diagnosis at a time.

pub mod confusion;
pub mod heat;
pub mod quantiles;
pub mod said;
pub mod target;
pub mod trade;
pub mod variation;

use serde::Serialize;

use super::by::By;
use super::cell::Cell;
use super::run::{Observation, RunRow};
use crate::experiment::as_written;
use crate::score::expectation::{Expectation, is_right};
use quantiles::{Quantiles, poisson_interval};

/// A run with its cell.
pub type Case<'a> = (&'a Cell, &'a RunRow);

/// Name of the class of a cell's fault.
pub(super) fn class(cell: &Cell) -> Option<&'static str> {
    Some(Expectation::of(cell.fault()?).class?.name())
}

/// The values of the sweep, each once, in the order in which they come.
fn settings<'a>(cases: &[Case<'a>]) -> Vec<&'a str> {
    let mut settings: Vec<&str> = Vec::new();
    for (cell, _) in cases {
        if !settings.contains(&cell.setting.as_str()) {
            settings.push(&cell.setting);
        }
    }
    settings
}

/// Whether a diagnosis could see the fault of a cell at all.
fn knows(by: By, cell: &Cell) -> bool {
    by == By::Likelihood || cell.fault().is_some_and(|f| Expectation::of(f).fdv.is_some())
}

/// One diagnosis over some runs.
#[derive(Clone, Debug, Serialize)]
pub struct Statistics {
    /// Number of runs.
    pub runs: usize,
    /// Runs in which it did not watch in time.
    pub unarmed: usize,
    /// How it saw the fault; null where there was none, or where it is blind to it.
    pub fault: Option<FaultStatistics>,
    /// What it raised beside the fault.
    pub alarms: AlarmStatistics,
}

/// How a diagnosis saw a fault.
#[derive(Clone, Debug, Serialize)]
pub struct FaultStatistics {
    /// Number of runs.
    pub runs: usize,
    /// Delay of the detection, s.
    pub detection_delay_s: Quantiles,
    /// Delay of the right isolation, s.
    pub isolation_delay_s: Quantiles,
    /// Runs in which it was not detected.
    pub missed: usize,
    /// Runs in which an alarm stood before the fault: these are missed too.
    pub early: usize,
    /// Runs in which it was never rightly isolated.
    pub not_isolated: usize,
    /// Runs in which the class named first was the right one, %.
    pub first_right_pct: f64,
    /// Runs in which the class settled on was the right one, %.
    pub settled_right_pct: f64,
    /// |indicated - true duration|, s.
    pub duration_error_s: Quantiles,
    /// |estimate / truth - 1|; null in a run where another class was settled on. All null: the class has no magnitude.
    pub magnitude_error: Quantiles,
    /// Runs with an estimate under the right class whose 95 % interval holds the truth, %.
    pub magnitude_coverage_pct: Option<f64>,
    /// |estimated - true onset|, s.
    pub onset_error_s: Quantiles,
}

/// What a diagnosis raised while nothing was there to be reported.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlarmStatistics {
    /// Alarms.
    pub alarms: u32,
    /// Hours that it watched without an alarm standing.
    pub hours: f64,
    /// Alarms an hour, without what is only advice.
    pub per_hour: Option<f64>,
    /// Exact 95 % interval of that, if alarms come independently of each other.
    pub per_hour_95: Option<[f64; 2]>,
    /// Variance over mean of the alarms of a run. About 1 if they do come independently; where it is much more, they
    /// come in bursts, and the interval is too narrow.
    pub dispersion: Option<f64>,
    /// Runs with an alarm or advice.
    pub runs_with: usize,
    /// Share of the time that an alarm stood that was no advice; null: it never watched.
    pub share_of_time: Option<f64>,
    /// Share of the time that an alarm or advice stood.
    pub told_share_of_time: Option<f64>,
}

impl Statistics {
    /// Of one diagnosis over some runs.
    pub fn new(by: By, cases: &[Case]) -> Self {
        let observed = || cases.iter().map(|(_, row)| row.by(by));
        let known: Vec<Case> =
            cases.iter().copied().filter(|(cell, _)| knows(by, cell) && cell.fault().is_some()).collect();
        Self {
            runs: cases.len(),
            unarmed: observed().filter(|s| !s.armed).count(),
            fault: (!known.is_empty()).then(|| FaultStatistics::new(by, &known)),
            alarms: AlarmStatistics::new(by, cases),
        }
    }
}

impl FaultStatistics {
    fn new(by: By, cases: &[Case]) -> Self {
        let quantiles = |value: &dyn Fn(&Case) -> Option<f64>| Quantiles::of(cases.iter().map(value));
        let count =
            |is: &dyn Fn(&Observation) -> bool| cases.iter().filter(|(_, row)| is(row.by(by))).count();
        let percent = |is: &dyn Fn(&Case) -> bool| {
            100.0 * cases.iter().filter(|case| is(case)).count() as f64 / cases.len() as f64
        };
        let right = |name: &Option<String>, cell: &Cell| {
            name.as_deref().is_some_and(|name| is_right(&cell.right, name))
        };
        let covered: Vec<bool> = cases.iter().filter_map(|case| covered(by, case)).collect();
        let held = covered.iter().filter(|&&c| c).count() as f64;
        Self {
            runs: cases.len(),
            detection_delay_s: quantiles(&|(_, row)| row.by(by).detection_delay_s),
            isolation_delay_s: quantiles(&|(_, row)| row.by(by).isolation_delay_s),
            missed: count(&|s| s.detection_delay_s.is_none()),
            early: count(&|s| s.early),
            not_isolated: count(&|s| s.isolation_delay_s.is_none()),
            first_right_pct: percent(&|(cell, row)| right(&row.by(by).first, cell)),
            settled_right_pct: percent(&|(cell, row)| right(&row.by(by).settled, cell)),
            duration_error_s: quantiles(&|(cell, row)| {
                Some((row.by(by).indicated_duration_s? - cell.fault()?.duration).abs())
            }),
            magnitude_error: quantiles(&|case| magnitude_error(by, case)),
            magnitude_coverage_pct: (!covered.is_empty()).then(|| 100.0 * held / covered.len() as f64),
            onset_error_s: quantiles(&|(_, row)| Some(row.by(by).onset_error_s?.abs())),
        }
    }
}

/// Estimate and truth, where the right class was settled on and has a magnitude.
fn magnitudes(by: By, (cell, row): &Case) -> Option<(f64, f64)> {
    let observed = row.by(by);
    let is_right = observed.settled.as_deref() == class(cell);
    Some((observed.magnitude.filter(|_| is_right)?, Expectation::of(cell.fault()?).magnitude?))
}

fn magnitude_error(by: By, case: &Case) -> Option<f64> {
    let (estimate, truth) = magnitudes(by, case)?;
    (truth != 0.0).then(|| (estimate / truth - 1.0).abs())
}

fn covered(by: By, case: &Case) -> Option<bool> {
    let (estimate, truth) = magnitudes(by, case)?;
    Some((estimate - truth).abs() <= case.1.by(by).half_width?)
}

impl AlarmStatistics {
    fn new(by: By, cases: &[Case]) -> Self {
        let hours = |ticks: fn(&Observation) -> u64| {
            let of = |(cell, row): &Case| ticks(row.by(by)) as f64 * as_written(cell.config.sample_time.0);
            cases.iter().map(of).sum::<f64>() / 3600.0
        };
        let (watched, told) = (hours(|s| s.watched_ticks), hours(|s| s.alarm_ticks));
        let alarmed = hours(|s| s.alarm_ticks - s.advice_ticks);
        let share = |of: f64| (told + watched > 0.0).then(|| of / (told + watched));
        let alarms = cases.iter().map(|(_, row)| row.by(by).alarms).sum();
        let rate = |count: f64| count / watched;
        let watches = watched > 0.0;
        Self {
            alarms,
            hours: watched,
            per_hour: watches.then(|| rate(f64::from(alarms))),
            per_hour_95: watches.then(|| poisson_interval(alarms).map(rate)),
            dispersion: dispersion(cases.iter().map(|(_, row)| f64::from(row.by(by).alarms)).collect()),
            runs_with: cases.iter().filter(|(_, row)| row.by(by).alarms + row.by(by).advices > 0).count(),
            share_of_time: share(alarmed),
            told_share_of_time: share(told),
        }
    }
}

/// Variance over mean; none of fewer than two counts, or where all are zero.
fn dispersion(counts: Vec<f64>) -> Option<f64> {
    let n = counts.len() as f64;
    let mean = counts.iter().sum::<f64>() / n;
    let variance = counts.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    (n > 1.0 && mean > 0.0).then(|| variance / mean)
}

#[cfg(test)]
mod tests {
    use fdi_core::Config;

    use super::*;
    use crate::campaign::definition::Campaign;
    use crate::campaign::results::Results;

    /// One cell of an air flow of 1.25, and a row for each thing that likelihood saw.
    fn statistics(observed: Vec<Observation>) -> Statistics {
        let text = "[[cell]]\nname = \"flow\"\nruns = 1\nfault = [{ do = \"air-flow\", size = 1.25, at = 400.0, for = 25.0 }]";
        let campaign: Campaign = toml::from_str(text).unwrap();
        let cells = campaign.expand(&Config::default()).unwrap();
        let rows: Vec<RunRow> = observed
            .into_iter()
            .zip(0..)
            .map(|(likelihood, run)| RunRow {
                cell: 0,
                run,
                seed: run,
                onset_s: Some(400.0),
                likelihood,
                ..RunRow::default()
            })
            .collect();
        Results::new(&campaign, &cells, &rows).cells.remove(0).likelihood
    }

    fn right(magnitude: f64) -> Observation {
        Observation {
            armed: true,
            detection_delay_s: Some(0.5),
            isolation_delay_s: Some(1.0),
            indicated_duration_s: Some(26.5),
            first: Some("heater_power".into()),
            settled: Some("air_flow".into()),
            magnitude: Some(magnitude),
            half_width: Some(2.0),
            onset_error_s: Some(-0.25),
            ..Observation::default()
        }
    }

    #[test]
    fn a_fault_is_judged_against_its_truth() {
        let wrong = Observation { settled: Some("drift".into()), magnitude: Some(25.0), ..right(25.0) };
        let unarmed = Observation { first: Some("air_flow".into()), ..Observation::default() };
        let statistics = statistics(vec![right(26.0), right(20.0), wrong, unarmed]);
        let fault = statistics.fault.unwrap();
        assert_eq!((statistics.unarmed, fault.missed, fault.not_isolated), (1, 1, 1));
        assert_eq!((fault.first_right_pct, fault.settled_right_pct), (25.0, 50.0));
        assert_eq!((fault.duration_error_s.median, fault.onset_error_s.median), (Some(1.5), Some(0.25)));
        assert!((fault.magnitude_error.median.unwrap() - 0.2).abs() < 1e-12, "of 4 %, 20 % and two without");
        assert_eq!(fault.magnitude_error.p95, None);
        assert_eq!(fault.magnitude_coverage_pct, Some(50.0), "of the two under the right class");
    }

    #[test]
    fn alarms_are_a_rate_over_the_time_watched() {
        let observed = |alarms| Observation {
            alarms,
            watched_ticks: 32_727,
            alarm_ticks: 32_727,
            advice_ticks: 16_364,
            ..Observation::default()
        };
        let alarms = statistics(vec![observed(3), observed(0)]).alarms;
        assert!((alarms.hours - 2.0).abs() < 1e-3 && alarms.runs_with == 1);
        assert!((alarms.per_hour.unwrap() - 1.5).abs() < 1e-3);
        let [low, high] = alarms.per_hour_95.unwrap();
        assert!((low - 0.6187 / 2.0).abs() < 1e-3 && (high - 8.7673 / 2.0).abs() < 1e-3);
        assert_eq!(alarms.dispersion, Some(3.0), "3 and 0: variance 4.5, mean 1.5");
        assert!((alarms.share_of_time.unwrap() - 0.25).abs() < 1e-4, "the other half is advice");
        assert!((alarms.told_share_of_time.unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(statistics(vec![Observation::default()]).alarms.share_of_time, None, "never watched");
    }
}
