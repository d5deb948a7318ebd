//! Does the estimator stay finite over millions of samples, and is its static gain right once the excitation is back?

use crate::estimator::{LAMBDAS, Outcome, PATTERNS, Pattern, run};

/// Every pattern with every forgetting factor, in threads of their own; prints each as it ends.
fn run_all(samples: u64) -> Vec<(Pattern, f32, Outcome)> {
    std::thread::scope(|scope| {
        let cases = PATTERNS.iter().flat_map(|&pattern| LAMBDAS.map(|lambda| (pattern, lambda)));
        let threads: Vec<_> = cases
            .map(|(pattern, lambda)| {
                scope.spawn(move || {
                    let outcome = run(pattern, lambda, samples);
                    println!(
                        "{pattern:?}, lambda {lambda}: {outcome:?}, error {:.4} %",
                        100.0 * outcome.error()
                    );
                    (pattern, lambda, outcome)
                })
            })
            .collect();
        threads.into_iter().map(|thread| thread.join().expect("a run panicked")).collect()
    })
}

fn check(samples: u64) {
    let failed: Vec<_> = run_all(samples)
        .into_iter()
        .filter(|(.., o)| o.first_not_finite.is_some() || o.resets > 0 || !(o.error() < 0.01))
        .collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

#[test]
fn a_million_samples_of_little_excitation() {
    check(1_000_000);
}

/// `cargo test --release -p fdi-core --test core -- --ignored --nocapture ten_million`
#[test]
#[ignore = "takes a minute in release"]
fn ten_million_samples_of_little_excitation() {
    check(10_000_000);
}
