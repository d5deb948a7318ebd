//! Settings of the likelihood diagnosis.

use crate::settings::settings;
use crate::units::Seconds;

settings! {
    /// Likelihood diagnosis (docs/diagnosis.md). Nothing here belongs to a particular rig: models and noise are learnt.
    pub struct LikelihoodConfig: Likelihood "likelihood." {
        /// Models are fitted for so long, of samples fit for learning.
        fit_time: Seconds = 108.0, 10.0..=1e5, was "parity.fit_time";
        /// Then their residuals are watched for so long, to learn the noise.
        check_time: Seconds = 70.0, 10.0..=1e5, was "parity.check_time";
        /// Slack of the fast charts, in standard deviations: smaller lasting shifts are ignored.
        fast_slack: f32 = 1.5, 0.1..=10.0, was "parity.fast_slack";
        /// Limit of the fast charts, in standard deviations.
        fast_limit: f32 = 7.0, 1.0..=100.0, was "parity.fast_limit";
        /// Slack of the slow chart on T1 -> T2, in standard deviations.
        slow_slack: f32 = 0.5, 0.1..=10.0, was "parity.slow_slack";
        /// Limit of the slow chart, in standard deviations.
        slow_limit: f32 = 20.0, 1.0..=1000.0, was "parity.slow_limit";
        /// Time constant with which the means of the residuals follow slow change, while nothing is wrong.
        mean_time: Seconds = 120.0, 10.0..=1e5, was "parity.mean_time";
        /// Share of a swing of the temperature that the models may get wrong.
        model_uncertainty: f32 = 0.02, 0.0..=1.0, was "parity.model_uncertainty";
        /// Share of the heater's power that may come and go (mains, air density) without an alarm.
        tolerated_sag: f32 = 0.045, 0.0..=0.5, was "parity.tolerated_sag";
        /// How much better the best explanation must be than the next before a fault is named: difference of two sums of
        /// squares of whitened residuals, twice the logarithm of a likelihood ratio.
        margin: f32 = 9.0, 0.0..=1000.0, was "parity.margin";
        /// The same between heater power and air flow, which differ only in what T2 loses on the way.
        power_margin: f32 = 20.0, 0.0..=1000.0, was "parity.power_margin";
    }
}
