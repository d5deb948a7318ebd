use super::*;

/// A change of several regressors is one of a regressor that is their weighted sum.
#[test]
fn several_columns_are_freed_as_their_weighted_sum_is() {
    for seed in 131..151 {
        let mut random = Random::new(seed);
        let mut problem = Problem::new(&mut random, 60, 1.0, 1.5);
        let regressors = [Regressor::Offset1, Regressor::LessFlow, Regressor::Gain2, Regressor::ShortLoss];
        let weights = regressors
            .map(|regressor| (regressor, random.gaussian() as f32 / largest(regressor as usize) as f32));
        for row in &mut problem.rows {
            row[Regressor::Exchanged as usize] = core::array::from_fn(|m| {
                weights.iter().map(|(regressor, weight)| weight * row[*regressor as usize][m]).sum()
            });
        }
        let (mean, sd) = (1.0, 0.25);
        let first = free(Direction::Of(Regressor::Exchanged), mean, sd);
        let (_, means, sds) = problem.posterior(&with(&SINCE_ONSET, first, None));
        let wanted = problem.log_evidence(&with(&SINCE_ONSET, first, None))
            - problem.log_evidence(&narrow(&SINCE_ONSET));
        let normal = problem.normal();
        let estimate = Nuisances::new(normal.sums(), &SINCE_ONSET, 1.5)
            .beyond(&ALL_PAIRS)
            .among(&weights.map(|(regressor, _)| regressor))
            .estimate(&weights.map(|(_, weight)| weight), (mean, sd));
        close("gain", estimate.gain, wanted, 1e-3 * (10.0 + wanted.abs()) + problem.rounding(first, None));
        let (mean, sd) = (means[SINCE_ONSET.len()], sds[SINCE_ONSET.len()]);
        close("value", estimate.value, mean, 0.01 * sd + 1e-3 * mean.abs());
        close("sd", sqrt(estimate.variance), sd, 0.01 * sd);
    }
}

/// What has changed, all at once and beside the nuisances: the posterior means.
#[test]
fn changes_are_those_of_the_posterior() {
    let regressors = [
        (Regressor::Power, 0.25),
        (Regressor::Offset1, 2.0),
        (Regressor::Gain1, 0.25),
        (Regressor::LongLag, 0.5),
    ];
    for seed in 151..171 {
        let problem = Problem::new(&mut Random::new(seed), 60, 1.0, 1.5);
        let wide = regressors.map(|(regressor, sd)| wide(free(Direction::Of(regressor), 0.0, sd)));
        let priors: Vec<Gaussian> = narrow(&SINCE_ONSET).into_iter().chain(wide).collect();
        let (_, mean, sd) = problem.posterior(&priors);
        let normal = problem.normal();
        let (changes, gain) =
            Nuisances::new(normal.sums(), &SINCE_ONSET, 1.5).beyond(&ALL_PAIRS).changes(&regressors);
        let wanted = problem.posterior(&priors).0 - problem.posterior(&narrow(&SINCE_ONSET)).0;
        close("gain", gain, wanted, 1e-3 * (10.0 + wanted.abs()));
        for (i, change) in (SINCE_ONSET.len()..).zip(changes) {
            close("change", change, mean[i], 0.02 * sd[i] + 1e-3 * mean[i].abs());
        }
        assert_eq!(
            Nuisances::new(<Normal>::default().sums(), &SINCE_ONSET, 1.5)
                .beyond(&ALL_PAIRS)
                .changes(&regressors)
                .0,
            [0.0; 4]
        );
    }
}
