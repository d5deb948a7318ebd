//! Ten million samples (by default) of each pattern and forgetting factor: does the estimator stay finite, and is its
//! static gain right once the excitation is back?

use clap::Parser;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use pt326_tests::endurance::{LAMBDAS, PATTERNS, run};
use rayon::prelude::*;

/// Endurance of the recursive least squares estimator in single precision.
#[derive(Parser)]
struct Arguments {
    /// Samples of each run, before the excitation comes back.
    #[arg(long, default_value_t = 10_000_000)]
    samples: u64,
}

fn main() -> anyhow::Result<()> {
    let samples = Arguments::parse().samples;
    let bars = MultiProgress::new();
    let style = ProgressStyle::with_template("{msg:24} {bar:40} {percent} %, {eta} left")?;
    let cases: Vec<_> = PATTERNS.iter().flat_map(|&p| LAMBDAS.map(|l| (p, l))).collect();
    let outcomes: Vec<_> = cases
        .par_iter()
        .map(|&(pattern, lambda)| {
            let bar = bars.add(ProgressBar::new(samples).with_style(style.clone()));
            bar.set_message(format!("{pattern:?}, {lambda}"));
            let outcome = run(pattern, lambda, samples, |k| bar.set_position(k));
            bar.finish_and_clear();
            outcome
        })
        .collect();
    println!("{samples} samples each, then excited again");
    println!("pattern      lambda   finite   resets   static gain   f64 reference   error");
    for ((pattern, lambda), o) in cases.iter().zip(&outcomes) {
        let finite = o.first_not_finite.map_or("always".into(), |k| format!("until {k}"));
        println!(
            "{:<12} {lambda:<8} {finite:<8} {:<8} {:<13.6} {:<15.6} {:.4} %",
            format!("{pattern:?}"),
            o.resets,
            o.static_gain,
            o.reference,
            100.0 * o.error()
        );
    }
    let failed = outcomes.iter().any(|o| o.first_not_finite.is_some() || !(o.error() < 0.01));
    anyhow::ensure!(!failed, "a run was not finite, or its static gain was off by more than 1 %");
    Ok(())
}
