//! What has changed since training, however slowly.

use super::tuning;

tuning! {
    /// Changes since training (docs/diagnosis.md, section 9). The smallest change of the power is the setting `likelihood.least_power`.
    pub struct SinceTrainingTuning: since_training {
        /// Evidence since training is divided by so much.
        kappa = 3.0, "1", measured "prototype 2: confidence and coverage";
        /// What the mean of a residual may be off by.
        mean_sd = 0.1, "degC", measured "prototype 2";
        /// And by which share of the distance of the rise from where training took place.
        away = 0.02, "1", chosen "as `likelihood.model_uncertainty`";
        /// The fast band counts so much where a size is estimated: its sensitivities are what the model knows worst.
        fast_in_size = 0.1, "1", chosen "";
        /// A tick counts no more than so many standard deviations, here and where a jump is looked for.
        clip = 8.0, "standard deviations", chosen "";
        /// Nor does a mean see more of a residual than so much of it away from it.
        jump = 1.0, "degC", measured "an alarm for a minute after a swap was put right (commit e55b598)";
        /// It is judged on each so many ticks.
        every = 30.0, "ticks", chosen "for the cost of a tick";
        /// And from so long on.
        first = 20.0, "s", chosen "";
        /// Log Bayes factor that raises an alarm.
        raise = 0.8, "1", chosen "commit 338b44e; prototype 2 had 4";
        /// It goes on above this share of that factor.
        lasting_raise = 0.4, "1", chosen "";
        /// And above this share of the smallest size.
        lasting_size = 0.7, "1", chosen "";
        /// What has changed is named from this probability on.
        naming = 0.9, "1", chosen "";
        /// Smallest offset.
        least_offset = 0.8, "degC", measured "prototype 2";
        /// Smallest loss of T1's gain.
        least_gain = 0.08, "1", measured "prototype 2";
    }
}

tuning! {
    /// The models in force held against those of the commissioning (docs/diagnosis.md, section 7).
    pub struct CommissionedTuning: commissioned {
        /// Smallest change of the rise that a power gives, a share.
        least = 0.15, "1", chosen "twice what one training differs from the next by where the mains step (preset harsh: 7 %)";
        /// 95 % of the trainings lie within this share of their mean.
        repeats = 0.06, "1", measured "12 starts each: presets paper 1.7 %, recorded 2.9 %, trainer 3.1 % standard deviation";
    }
}
