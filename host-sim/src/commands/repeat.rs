//! `pt326 repeat`: the same experiment over many seeds, in numbers that one run cannot give.

use fdi_core::Config;
use indicatif::{ParallelProgressIterator, ProgressBar};
use rayon::prelude::*;
use serde::Serialize;

use super::experiment::ExperimentArgs;
use super::terminal::{HEAD, coloured, print, progress, styled};
use crate::experiment;
use crate::experiment::scenario::Scenario;
use crate::record::summary::{FaultSummary, Summary};
use crate::score::Score;

/// Arguments of `repeat`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
All cores work; the numbers do not depend on how many there are. What a run missed is counted as missed, and left out \
of medians and percentiles.

Examples:
  pt326 repeat --seeds 1000
  pt326 repeat --disturbance lively --fault-size small --json > small.json")]
pub struct RepeatArgs {
    /// How many runs.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub seeds: u64,
    /// The first seed.
    #[arg(long, default_value_t = 1)]
    pub from: u64,
    #[command(flatten)]
    /// The experiment.
    pub experiment: ExperimentArgs,
    /// Print JSON instead of a table.
    #[arg(long)]
    pub json: bool,
}

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

/// Runs the command.
///
/// # Errors
/// A bad file or value.
pub fn run(args: &RepeatArgs) -> anyhow::Result<()> {
    let (config, scenario) = args.experiment.load()?;
    let bar = progress(args.seeds, "runs");
    let repeated = repeat(&config, &scenario, args.from, args.seeds, &bar)?;
    bar.finish_and_clear();
    let text = if args.json {
        serde_json::to_string_pretty(&repeated)? + "\n"
    } else {
        coloured(&table(&repeated, &scenario))
    };
    print(&text)
}

/// Runs the seeds `from..from + runs` on all cores; the result does not depend on their number.
///
/// # Errors
/// The parameter of `config` that is out of bounds.
pub fn repeat(
    config: &Config,
    scenario: &Scenario,
    from: u64,
    runs: u64,
    bar: &ProgressBar,
) -> anyhow::Result<Repeated> {
    let summaries: Vec<Summary> = (0..runs)
        .into_par_iter()
        .progress_with(bar.clone())
        .map(|i| Ok(Summary::new(&experiment::run(config, scenario, from.wrapping_add(i))?)))
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

fn table(r: &Repeated, scenario: &Scenario) -> String {
    let last = r.from.wrapping_add(r.runs - 1);
    let mut text = format!(
        "{} runs of {:.0} s, seeds {} to {last}, disturbance {}; median [5 %, 95 %], and how many runs missed it\n\n",
        r.runs, scenario.duration, r.from, scenario.disturbance
    );
    let head = [
        "Fault",
        "detection delay, s",
        "missed",
        "isolation delay, s",
        "missed",
        "indicated, s",
        "isolated, %",
    ];
    text += &styled(HEAD, line(head.map(String::from)));
    for fault in &r.faults {
        let forms = [
            (fault.name.as_str(), &fault.signature),
            ("  raw", &fault.signature_raw),
            ("  likelihood", &fault.likelihood),
        ];
        for (name, score) in forms {
            let missed = |s: &Spread| match s.runs {
                0 => "-".to_string(),
                runs => format!("{:.1} %", 100.0 * s.missed as f64 / runs as f64),
            };
            text += &line([
                name.to_string(),
                score.detection_delay_s.text(2, 1.0),
                missed(&score.detection_delay_s),
                score.isolation_delay_s.text(2, 1.0),
                missed(&score.isolation_delay_s),
                score.indicated_duration_s.text(1, 1.0),
                score.isolated_share.text(0, 100.0),
            ]);
        }
    }
    let named = r.faults.iter().map(|f| format!("{} {}", f.name, f.likelihood_first_verdict_right));
    text + &format!(
        "\nLikelihood names it first  {} of {} runs\nLargest control error  {} % of the set-point\n\
         False alarms           fdv {}, fiv {} (low-passed), likelihood {} in all runs\n",
        named.collect::<Vec<_>>().join(", "),
        r.runs,
        r.control_error_max_pct.text(2, 1.0),
        r.false_alarms_fdv,
        r.false_alarms_fiv,
        r.false_alarms_likelihood
    )
}

/// 100 columns.
fn line([name, detection, missed, isolation, not_isolated, indicated, share]: [String; 7]) -> String {
    format!(
        "{name:<13} {detection:<18} {missed:>6} {isolation:<20} {not_isolated:>6} {indicated:<17} {share:<14}"
    )
    .trim_end()
    .to_owned()
        + "\n"
}

impl Spread {
    /// `median [p5, p95]`, each times `factor`, or that there is none.
    fn text(&self, decimals: usize, factor: f64) -> String {
        match (self.p5, self.median, self.p95) {
            (Some(p5), Some(median), Some(p95)) => {
                let [p5, median, p95] = [p5, median, p95].map(|x| format!("{:.decimals$}", factor * x));
                format!("{median} [{p5}, {p95}]")
            }
            _ if self.runs == 0 => "-".into(),
            _ => "never".into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_the_table_fits_100_columns_and_keeps_its_columns_apart() {
        let long = Spread { p5: Some(11.94), median: Some(12.61), p95: Some(21.3), missed: 9, runs: 200 };
        let (delay, share) = (
            long.text(2, 1.0),
            Spread { p5: Some(1.0), median: Some(1.0), p95: Some(1.0), missed: 0, runs: 200 },
        );
        assert_eq!(
            (delay.as_str(), share.text(0, 100.0).as_str()),
            ("12.61 [11.94, 21.30]", "100 [100, 100]")
        );
        let short = "0.99 [0.44, 11.54]".to_owned();
        let cells =
            ["  likelihood", &short, "73.5 %", &delay, "74.5 %", &long.text(1, 1.0), &share.text(0, 100.0)];
        let line = line(cells.map(str::to_owned));
        assert!(line.trim_end().chars().count() <= 100, "{}", line.len());
        assert!(cells.iter().all(|cell| line.contains(cell)), "{line}");
    }
}
