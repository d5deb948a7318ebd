//! Training: fit the models, freeze them, learn what is normal for their residuals; a gate at either end.

use super::fit::{Fit, FitState, Models, Simulations};
use super::noise::{NoiseModel, ResidualStatistics};
use super::verdict::RejectReason;

/// How far training has come.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one, and nowhere to box it")]
pub(super) enum Training {
    /// Fitting the models.
    Fitting {
        /// The estimators.
        fit: FitState,
        /// Samples used.
        count: u32,
    },
    /// Watching the residuals of frozen models.
    Checking {
        /// The models.
        models: Models,
        /// Their simulations.
        simulations: Simulations,
        /// Of the residuals of y1, y2, and y2 from y1.
        statistics: [ResidualStatistics; 3],
        /// Samples used.
        count: u32,
    },
}

/// What training gives: models, what is normal, and the rise of T1 at which it was learnt.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trained {
    pub(super) models: Models,
    pub(super) simulations: Simulations,
    pub(super) noise: [NoiseModel; 3],
    pub(super) rise: f32,
}

/// Lengths of both parts in samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trainer {
    pub(super) fit: Fit,
    pub(super) fit_samples: u32,
    pub(super) check_samples: u32,
}

impl Trainer {
    pub(super) fn start(&self) -> Training {
        Training::Fitting { fit: self.fit.start(), count: 0 }
    }

    /// One sample; `fit_to_learn` says whether it is one of undisturbed operation. Only whole ones count.
    ///
    /// # Errors
    /// Why what was learnt can't be trusted.
    pub(super) fn step(
        &self,
        training: &mut Training,
        y: [Option<f32>; 2],
        u: f32,
        fit_to_learn: bool,
    ) -> Result<Option<Trained>, RejectReason> {
        let y = y.map(|y| y.filter(|_| fit_to_learn));
        match training {
            Training::Fitting { fit, count } => {
                self.fit.step(fit, y, u);
                *count += u32::from(y.iter().all(Option::is_some));
                if *count >= self.fit_samples {
                    let (models, simulations) = self.fit.finish(fit)?;
                    *training =
                        Training::Checking { models, simulations, statistics: Default::default(), count: 0 };
                }
                Ok(None)
            }
            Training::Checking { models, simulations, statistics, count } => {
                let y1 = y[0].unwrap_or(simulations.y1.y[0]);
                let [y1_expected, y2_expected, y2_of_y1] = models.step(simulations, y1, u);
                if let [Some(y1), Some(y2)] = y {
                    *count += 1;
                    statistics[0].push(y1 - y1_expected, y1);
                    statistics[1].push(y2 - y2_expected, y2);
                    statistics[2].push(y2 - y2_of_y1, y2);
                }
                if *count < self.check_samples {
                    return Ok(None);
                }
                let [of_y1, of_y2, of_y2_of_y1] = statistics;
                Ok(Some(Trained {
                    models: *models,
                    simulations: *simulations,
                    noise: [of_y1.finish()?, of_y2.finish()?, of_y2_of_y1.finish()?],
                    rise: of_y1.level(),
                }))
            }
        }
    }
}
