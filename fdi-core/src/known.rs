//! What need not be guessed: inputs of the rig beside the power that are measured, or announced by whoever changes them.

use crate::bounds::larger;
use crate::units::Percent;

/// A fan announced below this stands still, %. The models know no less air: what goes with its inverse would have no end.
pub(crate) const STANDSTILL: f32 = 5.0;

/// The known inputs on a tick. All of them are optional. The likelihood diagnosis uses them; the supervisor's limits go by the power
/// that is asked for, whatever the supply reads, so that a divider which reads wrongly weakens none of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct KnownInputs {
    /// Supply voltage of the heater as last measured, share of the nominal one.
    pub supply: Option<f32>,
    /// Samples of the supply so far that could not be used.
    pub supply_lost: u32,
    /// Level of the fan as last announced; 100 % is the level at which the rig is learnt.
    pub fan: Option<Percent>,
    /// Power of a second heater beside T1's own, where there is one that warms T1 too.
    pub beside: Option<Percent>,
}

impl KnownInputs {
    /// What the heater makes of a power, in %: it goes with the square of the voltage.
    pub fn effective(&self, power: f32) -> f32 {
        self.supply.map_or(power, |share| power * share * share)
    }

    /// Level of the fan, share of that at which the rig is learnt; 1 where nothing was announced, that of hardly any air where it stands still.
    pub fn fan_share(&self) -> f32 {
        self.fan.map_or(1.0, |level| larger(STANDSTILL, level.0) / 100.0)
    }
}
