//! The same experiment over many seeds, in numbers that one run cannot give.

use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::ensure;
use fdi_core::Config;
use indicatif::{ParallelProgressIterator, ProgressBar};
use rayon::prelude::*;
use serde::Serialize;

use crate::experiment;
use crate::experiment::scenario::Scenario;
use crate::record::summary::{FaultSummary, Summary};
use crate::score::Score;

/// What many runs showed.
#[derive(Clone, Debug, Serialize)]
pub struct Repeated {
    /// First seed.
    pub from: u64,
    /// Number of runs.
    pub runs: u64,
    /// Largest control error of a run, % of the set-point.
    pub control_error_max_pct: Spread,
    /// One entry a fault.
    pub faults: Vec<RepeatedFault>,
    /// False alarms of fdv in all runs, low-passed.
    pub false_alarms_fdv: u32,
    /// False alarms of fiv in all runs, low-passed.
    pub false_alarms_fiv: u32,
    /// False alarms of the likelihood diagnosis in all runs.
    pub false_alarms_likelihood: u32,
}

/// One fault over many runs.
#[derive(Clone, Debug, Serialize)]
pub struct RepeatedFault {
    /// Name.
    pub name: String,
    /// By the low-passed residuals.
    pub signature: RepeatedScore,
    /// By the raw residuals.
    pub signature_raw: RepeatedScore,
    /// By the likelihood diagnosis.
    pub likelihood: RepeatedScore,
    /// Runs in which the likelihood diagnosis first named the right class.
    pub likelihood_first_verdict_right: usize,
}

/// A score over many runs; what never happened in a run is counted as missed and left out of the spread.
#[derive(Clone, Debug, Serialize)]
pub struct RepeatedScore {
    /// Delay of the detection, s.
    pub detection_delay_s: Spread,
    /// Delay of the isolation, s.
    pub isolation_delay_s: Spread,
    /// Indicated duration, s.
    pub indicated_duration_s: Spread,
    /// Share of the fault's time that it was isolated.
    pub isolated_share: Spread,
}

/// Median and 5th and 95th percentile over the runs in which the value exists; null if in none.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Spread {
    /// 5th percentile.
    pub p5: Option<f64>,
    /// Median.
    pub median: Option<f64>,
    /// 95th percentile.
    pub p95: Option<f64>,
    /// Runs in which it does not exist.
    pub missed: usize,
    /// Runs that count: those in which it could exist.
    pub runs: usize,
}

impl Spread {
    /// `median [p5, p95]`, each times `factor`, or that there is none.
    pub fn text(&self, decimals: usize, factor: f64) -> String {
        match (self.p5, self.median, self.p95) {
            (Some(p5), Some(median), Some(p95)) => {
                let [p5, median, p95] = [p5, median, p95].map(|x| format!("{:.decimals$}", factor * x));
                format!("{median} [{p5}, {p95}]")
            }
            _ if self.runs == 0 => "-".into(),
            _ => "never".into(),
        }
    }

    /// Of the values that exist.
    pub fn of(values: impl Iterator<Item = Option<f64>>) -> Self {
        let all: Vec<Option<f64>> = values.collect();
        let mut known: Vec<f64> = all.iter().flatten().copied().collect();
        known.sort_by(f64::total_cmp);
        let at =
            |share: f64| known.get((share * known.len().saturating_sub(1) as f64).round() as usize).copied();
        Self {
            p5: at(0.05),
            median: at(0.5),
            p95: at(0.95),
            missed: all.len() - known.len(),
            runs: all.len(),
        }
    }
}

/// Runs the seeds `from..from + runs` on all cores; the result does not depend on their number.
///
/// # Errors
/// The parameter of `config` that is out of bounds; `stop` was set before all had begun.
pub fn repeat(
    config: &Config,
    scenario: &Scenario,
    from: u64,
    runs: u64,
    bar: &ProgressBar,
    stop: &AtomicBool,
) -> anyhow::Result<Repeated> {
    let summaries: Vec<Summary> = (0..runs)
        .into_par_iter()
        .progress_with(bar.clone())
        .map(|i| {
            ensure!(!stop.load(Ordering::Relaxed), "stopped");
            Ok(Summary::new(&experiment::run(config, scenario, from.wrapping_add(i))?))
        })
        .collect::<anyhow::Result<_>>()?;
    let fault = |i: usize| {
        let score = |form: fn(&FaultSummary) -> &Score| {
            let spread = |value: fn(&Score) -> Option<f64>| {
                let scores = summaries.iter().map(|s| form(&s.faults[i]));
                Spread::of(scores.filter(|score| score.not_scored.is_none()).map(value))
            };
            RepeatedScore {
                detection_delay_s: spread(|s| s.detection_delay_s),
                isolation_delay_s: spread(|s| s.isolation_delay_s),
                indicated_duration_s: spread(|s| s.indicated_duration_s),
                isolated_share: spread(|s| s.isolated_share),
            }
        };
        RepeatedFault {
            name: scenario.faults[i].label(),
            signature: score(|f| &f.signature),
            signature_raw: score(|f| &f.signature_raw),
            likelihood: score(|f| &f.likelihood.score),
            likelihood_first_verdict_right: summaries
                .iter()
                .filter(|s| s.faults[i].likelihood.first_verdict_right == Some(true))
                .count(),
        }
    };
    Ok(Repeated {
        from,
        runs,
        control_error_max_pct: Spread::of(summaries.iter().map(|s| s.control_error_max_pct)),
        faults: (0..scenario.faults.len()).map(fault).collect(),
        false_alarms_fdv: summaries.iter().filter_map(|s| s.false_alarms.fdv).sum(),
        false_alarms_fiv: summaries.iter().filter_map(|s| s.false_alarms.fiv).sum(),
        false_alarms_likelihood: summaries.iter().filter_map(|s| s.false_alarms.likelihood).sum(),
    })
}
