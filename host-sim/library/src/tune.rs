//! PID settings for a simulated rig: the experiment of the console's `tune start`, and what each rule makes of it.

use std::fmt;

use anyhow::bail;
use fdi_core::control::pid::PidConfig;
use fdi_core::tune::{Lag, Standing};
use fdi_core::{Command, Config, Instrument, Mode};
use firmware_logic::tuning::{InForce, Proposal, Rule, Tuner, TuningText};
use pt326_rig::Rig;

use crate::experiment::scenario::Scenario;
use crate::experiment::{as_written, sample, tick_time};

/// An experiment that came to a result.
#[derive(Clone, Debug)]
pub struct Tuning {
    /// The rig as a lag with dead time.
    pub lag: Lag,
    /// What each rule proposes; none where the loop would not settle in 20 time constants.
    pub proposals: Vec<(Rule, Option<Proposal>)>,
    /// What was in force.
    pub before: PidConfig,
    /// The experiment, tick by tick.
    pub ticks: Vec<Moment>,
}

/// A tick of the experiment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// s.
    pub t: f64,
    /// What T1 read, degC; NaN where it read nothing.
    pub t1: f32,
    /// What the heater got from this tick to the next, %.
    pub power: f32,
}

/// Carries the experiment out on the rig of a scenario, cold, without what else the scenario lets happen.
///
/// # Errors
/// A setting is out of bounds; how the experiment ended where it came to no result.
pub fn tune(config: &Config, scenario: &Scenario, seed: u64) -> anyhow::Result<Tuning> {
    let sample_time = as_written(config.sample_time.0);
    let mut rig = Rig::new(&scenario.rig, scenario.disturbance, sample_time, seed, &[]);
    let mut instrument = Instrument::new(config)?;
    if let Err(refusal) = instrument.command(Command::Tune) {
        bail!("{refusal}");
    }
    let mut ticks = Vec::new();
    loop {
        let tick = instrument.control(sample(&mut rig));
        let t1 = tick.sample.t1.read().unwrap_or(f32::NAN);
        ticks.push(Moment { t: tick_time(tick.index, sample_time), t1, power: tick.drive.0 });
        match (tick.tuning, tick.mode) {
            (Some(Standing::Over(Ok(lag))), _) => {
                let proposals = proposals(&lag, config);
                return Ok(Tuning { lag, proposals, before: config.pid, ticks });
            }
            (_, Mode::Tripped(trip)) => {
                bail!("tune: ended without a result, it tripped: {}", trip.reason.words())
            }
            (Some(over @ Standing::Over(Err(_))), _) => bail!("{}", TuningText(&over)),
            _ => rig.advance(f64::from(tick.drive.0)),
        }
    }
}

fn proposals(lag: &Lag, config: &Config) -> Vec<(Rule, Option<Proposal>)> {
    let mut tuner = Tuner::default();
    while !tuner.search(lag, config.sample_time) {}
    Rule::ALL.map(|rule| (rule, tuner.proposal(rule, lag, config.sample_time))).into()
}

/// As the console says it.
impl fmt::Display for Tuning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", TuningText(&Standing::Over(Ok(self.lag))))?;
        for (rule, proposal) in &self.proposals {
            match proposal {
                Some(proposal) => writeln!(f, "{proposal}")?,
                None => writeln!(f, "{}: too slow to settle in 20 time constants", rule.name())?,
            }
        }
        writeln!(f, "{}", InForce(&self.before))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pt326_rig::RigConfig;

    fn tuned(gain: f64) -> anyhow::Result<Tuning> {
        let rig = RigConfig { gain, ..RigConfig::default() };
        tune(&Config::default(), &Scenario { rig, ..Scenario::default() }, 1)
    }

    #[test]
    fn a_rig_is_found_and_every_rule_proposes() {
        let tuning = tuned(0.3).unwrap();
        assert!((tuning.lag.gain - 0.3).abs() < 0.02, "{tuning}");
        assert!(tuning.proposals.iter().all(|(_, proposal)| proposal.is_some()), "{tuning}");
        let said = tuning.to_string();
        assert!(said.contains("quick: kp") && said.contains("in force: kp 2.4000"), "{said}");
        let last = tuning.ticks.last().unwrap();
        assert!(last.t > 10.0 && last.power == 0.0, "{last:?}: the heater is off at the end");
    }

    #[test]
    fn a_heater_that_does_not_heat_trips_and_says_why() {
        let error = tuned(0.01).unwrap_err().to_string();
        assert_eq!(
            error,
            "tune: ended without a result, it tripped: much power, and T1 has not risen: T1 out of the tube, or nothing heats"
        );
    }
}
