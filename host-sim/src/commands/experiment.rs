//! What describes an experiment, on the command line of `run`, `repeat` and `console`.

use std::path::PathBuf;

use clap::Args;
use fdi_core::Config;
use pt326_rig::Disturbance;

use pt326_host::experiment::scenario::{self, Scenario};
use pt326_host::experiment::{self, FaultSize};
use pt326_host::settings;

/// What describes an experiment.
#[derive(Clone, Debug, Default, Args)]
pub struct ExperimentArgs {
    /// How much the surroundings vary: none, calm (the room drifts), lively (room, air flow and mains vary). Default: the
    /// scenario's, calm.
    #[arg(long)]
    pub disturbance: Option<Disturbance>,
    /// Size of the faults: small, nominal, large, or a factor on the nominal departure (negative: the other way).
    #[arg(long, default_value = "nominal", allow_negative_numbers = true)]
    pub fault_size: FaultSize,
    /// The rig of this name: paper (the reference rig); trainer and harsh (with the walls, mains and draughts of a real rig, moderate or strong);
    /// recorded (fitted to a real PT-326); oven, hotend, tclab (other plants, with their settings, see `pt326 config --preset`; the
    /// experiment has as many samples). In a scenario, the key `preset` in the section of the rig chooses the rig, and other
    /// keys change it.
    #[arg(long, value_name = "NAME", conflicts_with = "scenario")]
    pub preset: Option<String>,
    /// Settings of the instrument, TOML; see `pt326 config`.
    #[arg(long, value_name = "FILE.toml")]
    pub config: Option<PathBuf>,
    /// Rig and faults, TOML; see `pt326 scenario`.
    #[arg(long, value_name = "FILE.toml")]
    pub scenario: Option<PathBuf>,
}

impl ExperimentArgs {
    /// Reads and checks what the arguments name.
    ///
    /// # Errors
    /// The file, line, key or value that is wrong.
    pub fn load(&self) -> anyhow::Result<(Config, Scenario)> {
        let name = self.preset.as_deref();
        let table = name.map(settings::preset).transpose()?.unwrap_or_default();
        let config = settings::read_over(table, self.config.as_deref())?;
        let scenario = scenario::read_scenario(self.scenario.as_deref())?;
        let scenario = experiment::on_rig(scenario, &config, name, self.disturbance, self.fault_size)?;
        Ok((config, scenario))
    }

    /// The same for a rig that somebody works with: it has faults of a scenario that is named, and else none. The paper's would come while a rig
    /// that was checked first still learns.
    ///
    /// # Errors
    /// The same.
    pub fn load_by_hand(&self) -> anyhow::Result<(Config, Scenario)> {
        let (config, mut scenario) = self.load()?;
        if self.scenario.is_none() {
            scenario.faults.clear();
        }
        Ok((config, scenario))
    }
}
