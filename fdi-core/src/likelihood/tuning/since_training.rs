//! What has changed since training, however slowly.

use super::tuning;

tuning! {
    /// Changes since training (docs/diagnosis.md, section 9). The smallest change of the power is the setting `likelihood.least_power`.
    pub struct SinceTrainingTuning: since_training {
        /// The evidence since training is divided by this, because innovations are not quite independent.
        kappa = 3.0, "1", measured "prototype 2: confidence and coverage";
        /// Standard deviation of the mean of a residual.
        mean_sd = 0.1, "degC", measured "prototype 2";
        /// Weight of the fast band where a size is estimated: it rests on the dynamics, which the model knows least.
        fast_in_size = 0.1, "1", chosen "";
        /// Innovations are clipped at this, here and where a jump is looked for.
        clip = 8.0, "standard deviations", chosen "";
        /// A residual that is further than this from its mean counts as this far from it.
        jump = 1.0, "degC", measured "an alarm for a minute after a swap was put right (commit e55b598)";
        /// The bank since training is asked once in this many ticks.
        every = 30.0, "ticks", chosen "for the cost of a tick";
        /// Evidence (log Bayes factor) from which on a change is found.
        raise = 0.8, "1", chosen "commit 338b44e; prototype 2 had 4";
        /// A finding lasts while its evidence is above this share of that.
        lasting_raise = 0.4, "1", measured "with 0.7 three of fifteen slow faults more end too early (slow/* @ trainer)";
        /// It lasts while its size is above this share of the smallest that counts.
        lasting_size = 0.7, "1", chosen "";
        /// Smallest offset that counts.
        least_offset = 0.8, "degC", measured "prototype 2";
        /// Smallest loss of T1's gain that counts.
        least_gain = 0.08, "1", measured "prototype 2";
    }
}

tuning! {
    /// The present models, compared with those of the commissioning (docs/diagnosis.md, section 10).
    pub struct CommissionedTuning: commissioned {
        /// Smallest change of the static gain that is reported, a share.
        least = 0.15, "1", chosen "twice what one training differs from the next by where the mains step (preset harsh: 7 %)";
        /// 95 % of trainings of the same rig lie within this share of their mean.
        repeats = 0.06, "1", measured "12 starts each: presets paper 1.7 %, recorded 2.9 %, trainer 3.1 % standard deviation";
    }
}
