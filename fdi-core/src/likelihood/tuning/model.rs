//! The model of the rig, and how long everything takes.

use super::tuning;

tuning! {
    /// The model of the rig (docs/diagnosis.md, section 1).
    pub struct ModelTuning: model {
        /// The heat that passes from a surface to the air goes with the air flow to this power.
        film_exponent = 0.8, "1", derived "forced convection, docs/theory.md, section 1";
        /// Share of T1's dead time that does not depend on the air flow: sampling and conversion.
        fixed_delay = 0.25, "1", measured "residuals of a prototype; without it the flow errs by a quarter (docs/evidence/diagnosis-results.md)";
        /// The power at which the gain is K.
        centre = 30.0, "%", chosen "about the power of the reference rig";
        /// The step of the power for which the curvature counts.
        step = 20.0, "%", chosen "a unit";
        /// A change of the power shows this much later than the dead time says.
        shows_after = 1.5, "ticks", chosen "a tick until the next sample, and half a tick in the mean";
        /// The slope of T0 is taken over this time, for the nuisance "inlet at T1".
        inlet_slope = 5.0, "ticks", chosen "";
    }
}

tuning! {
    /// Times of the method on the reference rig; on other rigs they scale with the residence time (docs/diagnosis.md, section 12).
    pub struct TimeTuning: times {
        /// Residence time of the reference rig: how long heat is on its way to T2. It is the memory of T0's mean, for the nuisance "inlet at T2", and the lag of the regressors "long lag" and "long loss" of T1. After the end of an alarm there are no charts for this time; in slow surroundings it is assumed for this time that a fault has ended.
        reference = 1.1, "s", measured "what training learns on the reference rig";
        /// Largest time scale of a rig, and the inverse of the least one.
        largest_scale = 100.0, "1", chosen "";
        /// Memory of a swing of the temperature.
        swing = 2.0, "s", chosen "";
        /// Memory with which the usual walk of power, flow and offsets is learnt.
        walk = 7200.0, "s", chosen "";
        /// Memory with which an alarm forgets old samples. A change that only nuisances explain for this long is taken over by the tracker, and after an announced change of the fan nothing is judged for this time.
        forgetting = 10.0, "s", measured "without forgetting a sag gives wrong names (docs/evidence/diagnosis-results.md)";
        /// Lag of the regressors "short lag" and "short loss" of T1.
        short_lag = 0.35, "s", chosen "about that of the paper's MFS1, 0.4 s";
        /// Lag with which the air flow follows the fan.
        fan_lag = 0.2, "s", measured "prototype; no lag is safe, hence the pair of flow and power (docs/evidence/diagnosis-results.md)";
        /// Memory of the fast band of the bank since training. After training this band learns for as long by what the model is wrong.
        minute = 60.0, "s", measured "without learning, flow was named falsely in 3 of 25 runs on trainer, 14 on harsh (docs/diagnosis.md, section 9)";
        /// Changes that are slower than this belong to the slow band of the bank since training.
        split = 5.0, "s", measured "two bands, prototype (docs/diagnosis.md, section 9)";
        /// Memory of the means that make up the slow band. The bank since training is first asked this long after its reference was learnt.
        mean = 25.0, "s", chosen "";
    }
}
