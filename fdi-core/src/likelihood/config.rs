//! Settings of the likelihood diagnosis.

use super::taught::Responses;
use crate::settings::settings;
use crate::units::Seconds;

settings! {
    /// Likelihood diagnosis (docs/diagnosis.md). Model and noise are learnt, and its times follow from the model (section 12). What is not learnt,
    /// priors and limits, was tuned on the reference rig.
    pub struct LikelihoodConfig: Likelihood "likelihood." {
        /// The model is fitted to samples of this time that are fit for learning. Samples from before, while the rig warms up, serve as well.
        fit_time: Seconds = 108.0, 10.0..=1e5, was "parity.fit_time", limit above;
        /// After the fit the residuals are watched for this time, to learn the noise.
        check_time: Seconds = 70.0, 10.0..=1e5, was "parity.check_time", limit above;
        /// Allowance k of the fast charts (CUSUM), in standard deviations: smaller lasting shifts are ignored.
        fast_allowance: f32 = 1.5, 0.1..=10.0, was "parity.fast_slack", limit above;
        /// Decision interval h of the fast charts, in standard deviations.
        fast_interval: f32 = 7.0, 1.0..=100.0, was "parity.fast_limit", limit above;
        /// Allowance k of the slow chart, which watches how T2 differs from T1, in standard deviations.
        slow_allowance: f32 = 0.5, 0.1..=10.0, was "parity.slow_slack", limit above;
        /// Decision interval h of the slow chart, in standard deviations.
        slow_interval: f32 = 20.0, 1.0..=1000.0, was "parity.slow_limit", limit above;
        /// Share of a swing of the temperature, and of its distance from where it was trained, that the model may get wrong.
        model_uncertainty: f32 = 0.02, 0.0..=1.0, was "parity.model_uncertainty", limit above;
        /// Probability from which on a fault is named.
        naming: f32 = 0.95, 0.5..=0.98, limit above;
        /// The smallest change of the heater's power that is a fault, a share, because the mains vary. If they are seen to vary by more,
        /// the limit is higher.
        least_power: f32 = 0.085, 0.0..=0.5, limit above;
    } and {
        /// Faults of the user's own, by what they change.
        taught: Responses = Responses::new();
    }
}
