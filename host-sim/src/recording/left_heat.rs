//! A heater that gave the same power whatever was asked for leaves heat behind which no model knows of: behind it, how the rig begins is looked for
//! anew. Otherwise what is left of that heat would be called an error of a thermistor, for as long as it lasts.

use fdi_core::likelihood::{FaultClass, LikelihoodReport};

/// Whether the alarm that stands was such a heater's.
#[derive(Clone, Copy, Debug, Default)]
pub struct LeftHeat(bool);

impl LeftHeat {
    /// A tick; whether such an alarm has ended on it.
    pub fn ends(&mut self, report: &LikelihoodReport) -> bool {
        // Of this fault alone of the heater no size is told.
        let finding = report.finding.as_ref();
        self.0 |=
            finding.is_some_and(|found| found.class == FaultClass::HeaterPower && found.magnitude.is_none());
        !report.alarm && std::mem::take(&mut self.0)
    }
}
