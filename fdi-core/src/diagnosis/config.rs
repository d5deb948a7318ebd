//! Settings of the paper's diagnosis.

use super::signature::{self, PAPER_DETECTION, PAPER_ISOLATION, Rows};
use crate::error::ConfigError;
use crate::settings::{check, settings};
use crate::units::Seconds;

settings! {
    /// Residuals, their thresholds, and the signatures.
    pub struct DiagnosisConfig: Diagnosis "diagnosis." {
        /// Cut-off of the residuals' low-pass filter.
        filter_cutoff: f32 = 0.6, 1e-3..=100.0, in "rad/s";
        /// Thresholds lie this many standard deviations from the mean.
        sigma_factor: f32 = 3.0, 0.1..=100.0;
        /// Symptoms older than this at the detection do not date the fault's onset.
        onset_window: Seconds = 5.0, 0.0..=3600.0;
        /// A fault counts as ended when fdv has been zero for this time. A name is given when its row has matched for this time.
        clear_time: Seconds = 2.0, 0.0..=3600.0;
    } and {
        /// Fault detection table: fdv is the number of its last row that matches.
        detection: Rows = PAPER_DETECTION.iter().copied().collect();
        /// Fault isolation table: fiv is the number of the row that matches. No two may match at once.
        isolation: Rows = PAPER_ISOLATION.iter().copied().collect();
    }
}

impl DiagnosisConfig {
    /// Checks every setting and both tables.
    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        check(Self::SETTINGS[0], self)?;
        signature::validate("diagnosis.detection", &self.detection, false)?;
        signature::validate("diagnosis.isolation", &self.isolation, true)
    }
}
