//! A cell: runs that differ in their seeds only.

use fdi_core::likelihood::FaultClass;
use fdi_core::{Celsius, Config};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::definition::{Expect, MayTrip};
use crate::experiment::as_written;
use crate::experiment::scenario::Scenario;
use pt326_rig::fault::Fault;

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
    /// Names that are right.
    pub right: Vec<FaultClass>,
    /// Number of runs.
    pub runs: u64,
    /// Seed of the first run; the others follow.
    pub first_seed: u64,
    /// Which trips are right.
    pub may_trip: MayTrip,
    /// The room of each run is drawn from here, degC; else that of the rig.
    pub ambient: Option<[f64; 2]>,
    /// The set-point of each run is drawn from here, degC; else that of the settings.
    pub setpoint: Option<[f64; 2]>,
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

    /// Ts in s.
    pub fn sample_time(&self) -> f64 {
        as_written(self.config.sample_time.0)
    }

    /// Name with the values of the sweep.
    pub fn label(&self) -> String {
        if self.setting.is_empty() { self.name.clone() } else { format!("{} [{}]", self.name, self.setting) }
    }

    /// The fault that is scored.
    pub fn fault(&self) -> Option<&Fault> {
        self.scenario.faults.first().filter(|_| self.expect == Expect::Fault)
    }

    /// What a run is made of: all that happens, later by a random time, and what else is drawn.
    pub fn draw(&self, seed: u64) -> (Config, Scenario) {
        // A stream of its own: the rig draws its noise from the seed itself.
        let mut generator = Xoshiro256PlusPlus::seed_from_u64(!seed);
        let shift = if self.phase > 0.0 { generator.random_range(0.0..self.phase) } else { 0.0 };
        let shift = (shift * 1e6).round() / 1e6;
        let mut scenario = self.scenario.clone();
        scenario.duration += shift;
        scenario.faults.iter_mut().for_each(|fault| fault.at += shift);
        scenario.actions.iter_mut().for_each(|action| action.at += shift);
        let mut draw = |[low, high]: [f64; 2]| (generator.random_range(low..=high) * 10.0).round() / 10.0;
        if let Some(ambient) = self.ambient {
            scenario.rig.ambient = draw(ambient);
        }
        let mut config = self.config.clone();
        if let Some(setpoint) = self.setpoint {
            config.setpoint = Celsius(draw(setpoint) as f32);
        }
        (config, scenario)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::definition::Campaign;

    fn cell(more: &str) -> Cell {
        let text = format!(
            "[[cell]]\nname = \"c\"\nruns = 1\nphase = 60.0\nduration = 500.0\n{more}\n\
             fault = [{{ do = \"open\", sensor = \"t1\", at = 400.0, for = 9.0 }}]"
        );
        let campaign: Campaign = toml::from_str(&text).unwrap();
        campaign.expand(&Config::default()).unwrap().remove(0)
    }

    #[test]
    fn ambient_and_set_point_are_drawn_for_each_run_and_the_phase_stays() {
        let (plain, drawn) = (cell(""), cell("ambient = [5.0, 30.0]\nsetpoint = [25.0, 65.0]"));
        let mut rooms = Vec::new();
        for seed in 1..200 {
            let (config, scenario) = drawn.draw(seed);
            assert!(
                (5.0..=30.0).contains(&scenario.rig.ambient) && (25.0..=65.0).contains(&config.setpoint.0)
            );
            assert_eq!(scenario.faults, plain.draw(seed).1.faults, "seeds of old cells must not move");
            assert_eq!(drawn.draw(seed), (config, scenario.clone()));
            rooms.push(scenario.rig.ambient);
        }
        rooms.sort_by(f64::total_cmp);
        assert!(rooms[0] < 7.0 && rooms[198] > 28.0, "{rooms:?}");
        assert_eq!(plain.draw(1).0, plain.config);
    }
}
