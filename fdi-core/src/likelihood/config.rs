//! Settings of the likelihood diagnosis.

use crate::error::{ConfigError, in_ranges};
use crate::units::Seconds;

/// Settings of the likelihood diagnosis. Nothing here belongs to a particular rig: models and noise are learnt.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct LikelihoodConfig {
    /// Models are fitted for so long, of samples fit for learning.
    pub fit_time: Seconds,
    /// Then their residuals are watched for so long, to learn the noise.
    pub check_time: Seconds,
    /// Slack of the fast charts, in standard deviations: smaller lasting shifts are ignored.
    pub fast_slack: f32,
    /// Limit of the fast charts, in standard deviations.
    pub fast_limit: f32,
    /// Slack of the slow chart on T1 -> T2.
    pub slow_slack: f32,
    /// Limit of the slow chart.
    pub slow_limit: f32,
    /// Time constant with which the means of the residuals follow slow change, while nothing is wrong.
    pub mean_time: Seconds,
    /// Share of a swing of the temperature that the models may get wrong.
    pub model_uncertainty: f32,
    /// Share of the heater's power that may come and go (mains, air density) without an alarm.
    pub tolerated_sag: f32,
    /// How much better the best explanation must be than the next before a fault is named: difference of two sums of
    /// squares of whitened residuals, twice the logarithm of a likelihood ratio.
    pub margin: f32,
    /// The same between heater power and air flow, which differ only in what T2 loses on the way.
    pub power_margin: f32,
}

impl Default for LikelihoodConfig {
    fn default() -> Self {
        Self {
            fit_time: Seconds(108.0),
            check_time: Seconds(70.0),
            fast_slack: 1.5,
            fast_limit: 7.0,
            slow_slack: 0.5,
            slow_limit: 20.0,
            mean_time: Seconds(120.0),
            model_uncertainty: 0.02,
            tolerated_sag: 0.045,
            margin: 9.0,
            power_margin: 20.0,
        }
    }
}

impl LikelihoodConfig {
    /// Checks every setting.
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        in_ranges! {
            "likelihood.fit_time": self.fit_time.0, 10.0, 1e5;
            "likelihood.check_time": self.check_time.0, 10.0, 1e5;
            "likelihood.fast_slack": self.fast_slack, 0.1, 10.0;
            "likelihood.fast_limit": self.fast_limit, 1.0, 100.0;
            "likelihood.slow_slack": self.slow_slack, 0.1, 10.0;
            "likelihood.slow_limit": self.slow_limit, 1.0, 1000.0;
            "likelihood.mean_time": self.mean_time.0, 10.0, 1e5;
            "likelihood.model_uncertainty": self.model_uncertainty, 0.0, 1.0;
            "likelihood.tolerated_sag": self.tolerated_sag, 0.0, 0.5;
            "likelihood.margin": self.margin, 0.0, 1000.0;
            "likelihood.power_margin": self.power_margin, 0.0, 1000.0;
        }
    }
}
