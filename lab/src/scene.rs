//! A scene: the rig, its seed, and all that was done to it and when. It says everything of a session, so it is what a link holds, and what
//! a session is run anew from.

use fdi_core::Config;
use pt326_rig::fault::Fault;
use pt326_rig::{Disturbance, RigConfig};
use serde::{Deserialize, Serialize};

use crate::preset;

/// Rig and user of a session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scene {
    /// Seed of the rig's noise and of the phase of the excitation.
    pub seed: u64,
    /// Which rig; see [`RigConfig::preset`].
    pub preset: String,
    /// How much the surroundings move.
    pub disturbance: Disturbance,
    /// What was done, and before which tick, in that order.
    pub orders: Vec<(u32, Order)>,
}

impl Default for Scene {
    /// The paper's rig, armed at once.
    fn default() -> Self {
        Self {
            seed: 1,
            preset: "paper".into(),
            disturbance: Disturbance::default(),
            orders: vec![(0, Order::Arm)],
        }
    }
}

/// Something that the user does to the instrument or to the rig.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "order", rename_all = "lowercase", deny_unknown_fields)]
pub enum Order {
    /// Begin to regulate.
    Arm,
    /// Begin the experiment from which PID settings are told.
    Tune,
    /// Heater off.
    Stop,
    /// Leave a trip whose cause has gone, or know of an alarm.
    Acknowledge,
    /// What is named now is advice for a while.
    Shelve {
        /// How long, s; 0 ends it.
        seconds: f32,
    },
    /// Forget what is normal and learn it anew.
    Relearn,
    /// What is named now is normal: the same, but a board refuses it where nothing is named that may be normal.
    Accept,
    /// New set-point.
    Setpoint {
        /// degC.
        celsius: f32,
    },
    /// Excitation on or off.
    Excite {
        /// On.
        on: bool,
    },
    /// Level of the fan, announced.
    Fan {
        /// % of the nominal level.
        percent: f32,
    },
    /// A setting of the instrument; its name is that of `pt326 config`.
    Set {
        /// Such as `pid.kp`.
        name: String,
        /// Its value.
        value: f32,
    },
    /// Something happens to the rig; its `at` counts from now.
    Break {
        /// What.
        fault: Fault,
    },
    /// All that happens to the rig ends.
    Mend,
    /// A line for the console of a board.
    Console {
        /// Such as `calibrate t1 25.0`.
        line: String,
    },
}

impl Scene {
    /// The rig that it is about.
    ///
    /// # Errors
    /// A preset that there is not.
    pub fn rig(&self) -> anyhow::Result<RigConfig> {
        RigConfig::preset(&self.preset)
    }

    /// The settings of the instrument at the start: those of the preset.
    ///
    /// # Errors
    /// Those of [`preset::config`].
    pub fn config(&self) -> anyhow::Result<Config> {
        Ok(preset::with_prbs_phase(&preset::config(&self.preset)?, self.seed))
    }
}
