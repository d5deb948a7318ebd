//! `pt326 repeat`: the same experiment over many seeds, in numbers that one run cannot give.

use std::sync::atomic::AtomicBool;

use super::experiment::ExperimentArgs;
use super::terminal::{HEAD, coloured, print, progress, styled};
use pt326_host::experiment::scenario::Scenario;
use pt326_host::repeat::{Repeated, Spread, repeat};

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

/// Runs the command.
///
/// # Errors
/// A bad file or value.
pub fn run(args: &RepeatArgs) -> anyhow::Result<()> {
    let (config, scenario) = args.experiment.load()?;
    let bar = progress(args.seeds, "runs");
    let repeated = repeat(&config, &scenario, args.from, args.seeds, &bar, &AtomicBool::new(false))?;
    bar.finish_and_clear();
    let text = if args.json {
        serde_json::to_string_pretty(&repeated)? + "\n"
    } else {
        coloured(&table(&repeated, &scenario))
    };
    print(&text)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_the_table_fits_100_columns_and_keeps_its_columns_apart() {
        let spread = |p5, median, p95| Spread {
            p5: Some(p5),
            median: Some(median),
            p95: Some(p95),
            missed: 9,
            runs: 200,
        };
        let long = spread(11.94, 12.61, 21.3);
        let (delay, share) = (long.text(2, 1.0), spread(1.0, 1.0, 1.0).text(0, 100.0));
        assert_eq!((delay.as_str(), share.as_str()), ("12.61 [11.94, 21.30]", "100 [100, 100]"));
        let short = "0.99 [0.44, 11.54]".to_owned();
        let cells = ["  likelihood", &short, "73.5 %", &delay, "74.5 %", &long.text(1, 1.0), &share];
        let line = line(cells.map(str::to_owned));
        assert!(line.trim_end().chars().count() <= 100, "{}", line.len());
        assert!(cells.iter().all(|cell| line.contains(cell)), "{line}");
    }
}
