use super::*;

/// A change of several columns is one of a column that is their weighted sum.
#[test]
fn several_columns_are_freed_as_their_weighted_sum_is() {
    for seed in 131..151 {
        let mut random = Random::new(seed);
        let mut problem = Problem::new(&mut random, 60, 1.0, 1.5);
        let columns = [Column::Offset1, Column::LessFlow, Column::Gain2, Column::ShortLoss];
        let weights =
            columns.map(|column| (column, random.gaussian() as f32 / largest(column as usize) as f32));
        for row in &mut problem.rows {
            row[Column::Exchanged as usize] = core::array::from_fn(|m| {
                weights.iter().map(|(column, weight)| weight * row[*column as usize][m]).sum()
            });
        }
        let (mean, sd) = (1.0, 0.25);
        let first = free(Direction::Of(Column::Exchanged), mean, sd);
        let (_, means, sds) = problem.posterior(&with(&SINCE_ONSET, first, None));
        let wanted = problem.log_evidence(&with(&SINCE_ONSET, first, None))
            - problem.log_evidence(&narrow(&SINCE_ONSET));
        let normal = problem.normal();
        for nuisances in [
            Nuisances::new(&normal, &SINCE_ONSET, 1.5),
            Nuisances::new(&normal, &SINCE_ONSET, 1.5).for_many(),
        ] {
            let freed = nuisances.free_along(&weights, (mean, sd));
            close("gain", freed.gain, wanted, 1e-3 * (10.0 + wanted.abs()) + problem.rounding(first, None));
            let (mean, sd) = (means[SINCE_ONSET.len()], sds[SINCE_ONSET.len()]);
            close("value", freed.value, mean, 0.01 * sd + 1e-3 * mean.abs());
            close("sd", sqrt(freed.variance), sd, 0.01 * sd);
        }
    }
}

/// What has changed, all at once and beside the nuisances: the posterior means.
#[test]
fn changes_are_those_of_the_posterior() {
    let columns =
        [(Column::Power, 0.25), (Column::Offset1, 2.0), (Column::Gain1, 0.25), (Column::LongLag, 0.5)];
    for seed in 151..171 {
        let problem = Problem::new(&mut Random::new(seed), 60, 1.0, 1.5);
        let wide = columns.map(|(column, sd)| wide(free(Direction::Of(column), 0.0, sd)));
        let priors: Vec<Prior> = narrow(&SINCE_ONSET).into_iter().chain(wide).collect();
        let (_, mean, sd) = problem.posterior(&priors);
        let normal = problem.normal();
        let (changes, gain) = Nuisances::new(&normal, &SINCE_ONSET, 1.5).changes(&columns);
        let wanted = problem.posterior(&priors).0 - problem.posterior(&narrow(&SINCE_ONSET)).0;
        close("gain", gain, wanted, 1e-3 * (10.0 + wanted.abs()));
        for (i, change) in (SINCE_ONSET.len()..).zip(changes) {
            close("change", change, mean[i], 0.02 * sd[i] + 1e-3 * mean[i].abs());
        }
        assert_eq!(Nuisances::new(&<Normal>::default(), &SINCE_ONSET, 1.5).changes(&columns).0, [0.0; 4]);
    }
}
