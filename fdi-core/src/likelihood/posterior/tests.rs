use super::super::reference::Random;
use super::*;

fn gains(random: &mut Random, spread: f64) -> [Estimate; COUNT] {
    core::array::from_fn(|_| Estimate { gain: (spread * random.gaussian()) as f32, ..Estimate::default() })
}

/// exp of the gains, averaged over the hypotheses of a class, as shares of the sum over classes, in f64.
fn probability(estimate: &[Estimate; COUNT], class: FaultClass) -> f64 {
    let mean = |class: FaultClass| {
        let of = HYPOTHESES.iter().zip(estimate).filter(|(row, _)| row.class == class);
        of.clone().map(|(_, estimate)| f64::from(estimate.gain).exp()).sum::<f64>() / of.count() as f64
    };
    let first = |h: &usize| HYPOTHESES[..*h].iter().all(|row| row.class != HYPOTHESES[*h].class);
    let all: f64 = (0..COUNT).filter(first).map(|h| mean(HYPOTHESES[h].class)).sum();
    mean(class) / all
}

#[test]
fn probabilities_are_those_of_bayes() {
    for (seed, spread) in [(1, 0.5), (2, 3.0), (3, 10.0), (4, 0.0)] {
        let estimate = gains(&mut Random::new(seed), spread);
        let posterior = Posterior::new(&estimate);
        for (h, row) in HYPOTHESES.iter().enumerate() {
            let wanted = probability(&estimate, row.class);
            for p in [posterior.of(h), posterior.of_class(row.class)] {
                assert!((f64::from(p) - wanted).abs() < 1e-5, "seed {seed}, {h}: {p}, not {wanted}");
            }
        }
        assert_eq!(posterior.of_class(FaultClass::Unknown), 0.0);
    }
}

/// Several weak hypotheses of one class do not outvote a strong one, and the best of the likeliest class stands for it.
#[test]
fn the_best_of_the_likeliest_class_stands_for_it() {
    for seed in 1..200 {
        let estimate = gains(&mut Random::new(seed), 4.0);
        let posterior = Posterior::new(&estimate);
        let best = (0..COUNT).max_by(|&a, &b| estimate[a].gain.total_cmp(&estimate[b].gain)).unwrap();
        assert_eq!((posterior.best, posterior.best_gain), (best, estimate[best].gain), "seed {seed}");
        let class = HYPOTHESES[posterior.likeliest].class;
        for (h, row) in HYPOTHESES.iter().enumerate() {
            assert!(posterior.of(h) <= posterior.of(posterior.likeliest), "seed {seed}, {h}");
            assert!(
                row.class != class || estimate[h].gain <= estimate[posterior.likeliest].gain,
                "seed {seed}, {h}"
            );
        }
    }
}

/// Whatever the gains are, probabilities are numbers.
#[test]
fn far_apart_or_no_numbers_at_all() {
    for gain in [1e30, -1e30, 0.0] {
        let mut estimate = [Estimate { gain: -50.0, ..Estimate::default() }; COUNT];
        estimate[7].gain = gain;
        let posterior = Posterior::new(&estimate);
        assert!((0..COUNT).all(|h| (0.0..=1.0).contains(&posterior.of(h))), "{gain}");
    }
}
