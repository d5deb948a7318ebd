//! A cell: runs that differ in their seeds only.

use fdi_core::Config;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::definition::Expect;
use crate::fault::Fault;
use crate::scenario::Scenario;

/// A cell, ready to run.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Name with size and plant.
    pub name: String,
    /// Name of the plant; empty: the reference rig.
    pub plant: String,
    /// Values of the sweep, as text; empty without one.
    pub setting: String,
    /// What should come of it.
    pub expect: Expect,
    /// Number of runs.
    pub runs: u64,
    /// Seed of the first run; the others follow.
    pub first_seed: u64,
    /// Largest shift of all that happens, s.
    pub phase: f64,
    /// The run, not shifted.
    pub scenario: Scenario,
    /// Settings of the instrument.
    pub config: Config,
}

impl Cell {
    /// The seed of a run.
    pub fn seed(&self, run: u64) -> u64 {
        self.first_seed.wrapping_add(run)
    }

    /// Name with the values of the sweep.
    pub fn label(&self) -> String {
        if self.setting.is_empty() { self.name.clone() } else { format!("{} [{}]", self.name, self.setting) }
    }

    /// The fault that is scored.
    pub fn fault(&self) -> Option<&Fault> {
        self.scenario.faults.first().filter(|_| self.expect == Expect::Fault)
    }

    /// The scenario of a run: all that happens, later by a random time.
    pub fn scenario(&self, seed: u64) -> Scenario {
        // A stream of its own: the rig draws its noise from the seed itself.
        let mut generator = Xoshiro256PlusPlus::seed_from_u64(!seed);
        let shift = if self.phase > 0.0 { generator.random_range(0.0..self.phase) } else { 0.0 };
        let shift = (shift * 1e6).round() / 1e6;
        let mut scenario = self.scenario.clone();
        scenario.duration += shift;
        scenario.faults.iter_mut().for_each(|fault| fault.at += shift);
        scenario.actions.iter_mut().for_each(|action| action.at += shift);
        scenario
    }
}
