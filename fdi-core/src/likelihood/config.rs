//! Settings of the likelihood diagnosis.

use crate::settings::settings;
use crate::units::Seconds;

settings! {
    /// Likelihood diagnosis (docs/diagnosis.md). Models and noise are learnt. What is not, orders, memories and margins, was
    /// tuned on the reference rig and suits heaters that answer within some seconds (section 12).
    pub struct LikelihoodConfig: Likelihood "likelihood." {
        /// Models are fitted for so long, of samples fit for learning.
        fit_time: Seconds = 108.0, 10.0..=1e5, was "parity.fit_time";
        /// Then their residuals are watched for so long, to learn the noise.
        check_time: Seconds = 70.0, 10.0..=1e5, was "parity.check_time";
        /// Allowance k of the fast charts (CUSUM), in standard deviations: smaller lasting shifts are ignored.
        fast_allowance: f32 = 1.5, 0.1..=10.0, was "parity.fast_slack";
        /// Decision interval h of the fast charts, in standard deviations.
        fast_interval: f32 = 7.0, 1.0..=100.0, was "parity.fast_limit";
        /// Allowance k of the slow chart on T1 -> T2, in standard deviations.
        slow_allowance: f32 = 0.5, 0.1..=10.0, was "parity.slow_slack";
        /// Decision interval h of the slow chart, in standard deviations.
        slow_interval: f32 = 20.0, 1.0..=1000.0, was "parity.slow_limit";
        /// Time constant with which the means of the residuals follow slow change, while nothing is wrong.
        mean_time: Seconds = 120.0, 10.0..=1e5, was "parity.mean_time";
        /// Share of a swing of the temperature that the models may get wrong.
        model_uncertainty: f32 = 0.02, 0.0..=1.0, was "parity.model_uncertainty";
        /// Share of the heater's power that may come and go (mains, air density) without an alarm.
        tolerated_sag: f32 = 0.045, 0.0..=0.5, was "parity.tolerated_sag";
        /// By how much the best explanation must beat the next before a fault is named: twice a log-likelihood ratio, the
        /// difference of two sums of squares of whitened residuals.
        margin: f32 = 9.0, 0.0..=1000.0, was "parity.margin";
        /// The same between heater power and air flow, which differ only in what T2 loses on the way.
        power_margin: f32 = 20.0, 0.0..=1000.0, was "parity.power_margin";
    }
}
