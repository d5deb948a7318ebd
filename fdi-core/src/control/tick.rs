//! What the first half of a tick hands on.

use crate::bounds::bounded;
use crate::known::KnownInputs;
use crate::observation::{Observation, Shelving};
use crate::sense::Sample;
use crate::supervisor::{Blocker, Mode};
use crate::tune::Standing;
use crate::units::{Celsius, Percent};

/// All that the first half of a tick decided; the input of the second half.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tick {
    /// Number of the tick since the instrument was built.
    pub index: u32,
    /// What the thermistors read.
    pub sample: Sample,
    /// What is regulated in place of T1, where T1 is known to be wrong: see [`crate::SupervisorConfig::go_on_without_t1`].
    pub virtual_t1: Option<Celsius>,
    /// Temperature wanted at T1.
    pub setpoint: Celsius,
    /// Output of the PID.
    pub pid: Percent,
    /// Excitation added to it; what is really excited is `drive - pid`.
    pub prbs: Percent,
    /// What the heater is to be driven with until the next tick, saturated; 0 whenever heating is not allowed.
    pub drive: Percent,
    /// Mode of the supervisor.
    pub mode: Mode,
    /// How far the experiment of [`Mode::Tune`] has come; its end is told on the first tick without it.
    pub tuning: Option<Standing>,
    /// Whether this sample belongs to the baseline.
    pub learn: bool,
    /// Why it does not, while learning is due.
    pub blocked: Option<Blocker>,
    /// What was learnt before is to be forgotten: [`crate::Command::Relearn`] was carried out.
    pub forget: bool,
    /// What the diagnosis tells now is to be advice: [`crate::Command::Acknowledge`] or [`crate::Command::Shelve`] was carried out.
    pub shelve: Option<Shelving>,
    /// What is known of the rig's other inputs.
    pub known: KnownInputs,
}

impl Tick {
    /// What the diagnosis sees of it. `applied` is what really drives the heater from this tick to the next; what is no number
    /// counts as the drive that was asked for.
    pub fn observation(&self, applied: Percent) -> Observation {
        Observation {
            index: self.index,
            sample: self.sample,
            power: if applied.0.is_finite() { Percent(bounded(applied.0, 0.0, 100.0)) } else { self.drive },
            known: self.known,
            phase: self.mode.phase(),
            excited: self.prbs.0 != 0.0,
            learn: self.learn,
            forget: self.forget,
            shelve: self.shelve,
        }
    }
}
