//! What the second half of a tick tells the first half of the next.

use crate::units::Percent;

/// What the diagnosis found that control and supervision act on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Feedback {
    /// Samples that the baseline has.
    pub learned: u32,
    /// The virtual T1: its rise over T0 on the next tick by T2 and the models, degC. None unless the likelihood diagnosis watches
    /// and T2 is good.
    pub virtual_rise: Option<f32>,
    /// T1 reads wrong, by name: offset, clogged, stuck, open, shorted or lost.
    pub t1_faulty: bool,
    /// T1 does not answer to the heater as T2 does, by what needs no models and no settings.
    pub t1_contradicted: bool,
    /// The heater gives another power than the one asked for, by name. Then the static gain says nothing of the air flow.
    pub heater_faulty: bool,
    /// Air flow by the static gain, % of normal, where known.
    pub air_flow: Option<Percent>,
    /// The rig heats although no heat is asked for.
    pub heater_stuck_on: bool,
    /// The settings that the second half keeps are no longer those that were checked. Nothing here looks for that: a board's loop does.
    pub settings_damaged: bool,
}
