//! Training: priors, bounds, the filter, the noise model, the gate.

use super::tuning;

tuning! {
    /// What is known of a rig before it is trained: means and standard deviations of the parameters (docs/diagnosis.md, section 1).
    pub struct PriorTuning: prior {
        /// Standard deviation of ln of what is hardly known: the gain, whose mean is the usual gain, the wall's time constant, and the lag of a heater beside, whose mean is the heater's lag.
        wide = 0.7, "1", chosen "wide: a factor of 2";
        /// The heater's time constant as a share of the answer time.
        heater = 0.22, "1", derived "0.45 s of 2 s on the reference rig";
        /// Standard deviation of its ln.
        heater_sd = 0.8, "1", chosen "wide: a factor of 2.2";
        /// The dead time of T1.
        delay1 = 0.9, "ticks", derived "0.1 s on the reference rig";
        /// T1's lag, ln.
        lag1 = -0.1, "ln ticks", chosen "about a tick";
        /// Share of T1's rise that comes with the wall.
        wall1 = 0.03, "1", chosen "";
        /// Share of T1's rise that reaches T2.
        reaches = 0.9, "1", derived "0.92 on the reference rig";
        /// Standard deviation of that share, and of that of a heater beside.
        reaches_sd = 0.2, "1", chosen "";
        /// Transport from T1 to T2.
        delay2 = 1.1, "ticks", chosen "0.1 s on the reference rig is 0.9";
        /// Standard deviation of both dead times.
        delay_sd = 1.4, "ticks", chosen "";
        /// T2's lag, ln.
        lag2 = 1.3, "ln ticks", derived "0.4 s on the reference rig";
        /// Standard deviation of ln of both lags.
        lag_sd = 1.0, "1", chosen "wide: a factor of 2.7";
        /// Share of T2's rise that comes with the wall on top of T1's.
        wall2 = 0.02, "1", chosen "";
        /// Standard deviation of both shares of the wall.
        wall_sd = 0.06, "1", chosen "";
        /// The wall's time constant, answer times.
        wall_time = 15.0, "answer times", chosen "";
        /// Standard deviation of what T1 and T2 read above T0 without power, if that was not read on a cold rig; its mean is 0.
        offset_sd = 1.5, "degC", chosen "tolerance of thermistors";
        /// The same without T0: then the offset is the ambient temperature.
        intercept_sd = 30.0, "degC", chosen "wide: any room";
        /// Standard deviation of the curvature, whose mean is 0.
        curvature_sd = 0.015, "1", chosen "";
        /// Static gain of a heater beside T1's own, as a share of that.
        second_heater = 0.15, "1", chosen "about the TCLab's";
    }
}

tuning! {
    /// Bounds of what is learnt: what must not run away.
    pub struct RangeTuning: range {
        /// Nothing that is learnt is further than this from the mean of its prior.
        sds = 10.0, "standard deviations", chosen "a guard: nothing that was seen came near";
        /// Least share of T1's rise that reaches T2.
        least_reaches = 0.05, "1", chosen "";
        /// The wall's time constant is no further than this from the mean of its prior: within a factor of 4.
        wall_sds = 2.0, "standard deviations", measured "a step of the mains in training was fitted as a wall of 1600 s, bounded to 4 to 120 s (prototype 2)";
        /// Nothing is trained while the fan is announced, or measured, to be further from its usual level than this share.
        fan = 0.05, "1", chosen "a fan that is measured is not quite still";
        /// Longest dead time of T1 and T2 together, as a share of what the transport remembers: less air takes longer.
        longest_delay = 0.7, "1", chosen "less flow by a quarter to a third stays within the memory";
    }
}

tuning! {
    /// The cold rig, which shows by how much thermistors differ.
    pub struct ColdTuning: cold {
        /// A rig whose rises are below this is cold.
        below = 3.0, "degC", chosen "";
        /// Samples over which a trend is looked for.
        memory = 100.0, "ticks", chosen "";
        /// Samples over which the offset is read.
        recent = 20.0, "ticks", chosen "";
    }
}

tuning! {
    /// The extended Kalman filter that trains.
    pub struct FilterTuning: filter {
        /// T1 and T2 count as answering when their rise has reached this.
        answers = 0.5, "degC", chosen "";
        /// When T2 answers, the transport from T1 to T2 is at least this share of the time since T1 answered.
        later = 0.5, "1", chosen "";
        /// Covariance inflation: the variance of a residual is multiplied by this.
        inflation = 2.25, "1", chosen "";
        /// At first the model is taken to err by this share of the rise.
        first_error = 0.1, "1", chosen "";
        /// This error decays with this time constant.
        first_answers = 6.0, "answer times", chosen "";
        /// No tick moves a parameter by more than this share of its prior's standard deviation.
        largest_step = 0.3, "1", chosen "";
        /// An innovation is clipped here.
        clip = 4.0, "standard deviations", chosen "";
        /// Least variance with which learning begins, as a share of the prior's: in the first heat the model was still wrong.
        reopened = 0.1, "1", chosen "";
        /// From this power on, the gain of a rig that is already warm is read from the first tick.
        warm_power = 1.0, "%", chosen "with less, what is left of an earlier heat would be taken for the power's";
        /// Correlation of a residual with the one before, until it is known.
        rho = 0.6, "1", chosen "";
        /// Standard deviation of a residual until it is known.
        sigma = 0.1, "degC", chosen "";
        /// Largest correlation of a residual with the one before.
        largest_rho = 0.95, "1", chosen "";
        /// Memory of the residuals' mean and covariances.
        noise_memory = 200.0, "ticks", chosen "";
    }
}

tuning! {
    /// The noise model of the residuals, and the gate behind training (docs/diagnosis.md, section 3).
    pub struct WhiteningTuning: whitening {
        /// Factor on the variance in the autocovariance: it adds a little white noise.
        ridge = 1.0001, "1", chosen "keeps the regression regular";
        /// Least standard deviation of the unpredictable part of a residual (sigma).
        least_sigma = 0.02, "degC", derived "steps of the converter, 0.025 degC at 35 degC, are not white";
        /// Largest share of a temperature's variance that the model may leave unexplained.
        largest_unexplained = 0.6, "1", chosen "";
        /// A residual below this share of the rise is small enough in any case, because a temperature that the excitation hardly moves has little variance itself.
        small = 0.015, "1", chosen "without it two faults of 1,189 more were missed (physics that no model has, seeds from 72000)";
    }
}
