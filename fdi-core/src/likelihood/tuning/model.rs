//! The model of the rig, and how long everything takes.

use super::tuning;

tuning! {
    /// The model of the rig (docs/diagnosis.md, section 1).
    pub struct ModelTuning: model {
        /// The heat that passes from a surface to the air goes with the air flow to this power.
        film_exponent = 0.8, "1", derived "forced convection, docs/theory.md, section 1";
        /// Share of T1's dead time that does not depend on the air flow: sampling and conversion.
        fixed_delay = 0.25, "1", measured "residuals of a prototype; without it the flow errs by a quarter (docs/diagnosis.md, section 16)";
        /// The power at which the gain is K.
        centre = 30.0, "%", chosen "about the power of the reference rig";
        /// The step of the power for which the curvature counts.
        step = 20.0, "%", chosen "a unit";
        /// The air flow with which the regressor of less flow is computed (a secant).
        less_flow = 0.77, "1", chosen "1/f - 1 is 0.3, the standard deviation of the hypothesis";
        /// The air flow with which the regressor of more flow is computed (a secant).
        more_flow = 1.3, "1", chosen "1/0.77";
        /// A change of the power shows this much later than the dead time says.
        shows_after = 1.5, "ticks", chosen "a tick until the next sample, and half a tick in the mean";
        /// The slope of T0 is taken over this time, for the nuisance "inlet at T1".
        inlet_slope = 5.0, "ticks", chosen "";
    }
}

impl ModelTuning {
    /// Changes of `1/f - 1` over which the regressors of less and of more flow are secants.
    #[inline(always)]
    pub(in crate::likelihood) fn secants(&self) -> [f32; 2] {
        [1.0 / self.less_flow - 1.0, 1.0 / self.more_flow - 1.0]
    }
}

tuning! {
    /// Times of the method on the reference rig; on other rigs they scale with the residence time (docs/diagnosis.md, section 12).
    pub struct TimeTuning: times {
        /// Residence time of the reference rig: how long heat is on its way to T2.
        reference = 1.1, "s", measured "what training learns on the reference rig";
        /// Least time scale of a rig.
        least_scale = 0.5, "1", chosen "";
        /// Largest time scale of a rig.
        largest_scale = 100.0, "1", chosen "";
        /// Memory of a swing of the temperature.
        swing = 2.0, "s", chosen "";
        /// Memory of T0's mean, for the nuisance "inlet at T2": air that enters has passed T1 and T2 after this time.
        inlet = 1.0, "s", chosen "";
        /// Memory with which the usual walk of power, flow and offsets is learnt.
        walk = 7200.0, "s", chosen "";
        /// Memory with which an alarm forgets old samples.
        forgetting = 10.0, "s", measured "without forgetting a sag gives wrong names (docs/diagnosis.md, section 16)";
        /// Memory of the window that decides whether a fault is over.
        window = 0.7, "s", chosen "";
        /// Lag of the regressors "short lag" and "short loss" of T1.
        short_lag = 0.35, "s", chosen "about that of the paper's MFS1, 0.4 s";
        /// Lag of the regressors "long lag" and "long loss" of T1.
        long_lag = 1.0, "s", chosen "";
        /// Lag with which the air flow follows the fan.
        fan_lag = 0.2, "s", measured "prototype; no lag is safe, hence the pair of flow and power (docs/diagnosis.md, section 16)";
        /// Memory of the fast band of the bank since training.
        minute = 60.0, "s", chosen "";
        /// Changes that are slower than this belong to the slow band of the bank since training.
        split = 5.0, "s", measured "two bands, prototype (docs/diagnosis.md, section 9)";
        /// Memory of the means that make up the slow band.
        mean = 25.0, "s", chosen "";
        /// After training the fast band learns for this time by what the model is wrong.
        model_errors = 90.0, "s", measured "without it flow was named falsely in 3 of 25 runs on trainer, 14 on harsh (docs/diagnosis.md, section 9)";
    }
}
