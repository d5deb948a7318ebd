//! A million samples of each pattern and forgetting factor; `cargo run --release -p pt326-tests --example endurance` does ten.

use pt326_tests::endurance::{LAMBDAS, PATTERNS, run};
use rayon::prelude::*;

#[test]
fn a_million_samples_of_little_excitation() {
    let cases: Vec<_> = PATTERNS.iter().flat_map(|&p| LAMBDAS.map(|l| (p, l))).collect();
    let failures: Vec<String> = cases
        .par_iter()
        .filter_map(|&(pattern, lambda)| {
            let outcome = run(pattern, lambda, 1_000_000, |_| ());
            let good = outcome.first_not_finite.is_none() && outcome.resets == 0 && outcome.error() < 0.01;
            (!good).then(|| format!("{pattern:?} {lambda}: {outcome:?}"))
        })
        .collect();
    assert!(failures.is_empty(), "{failures:#?}");
}
