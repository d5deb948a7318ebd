//! The self-test of a board, on the rig of a case.

use fdi_core::Config;
use fdi_core::control::Controller;
use firmware_logic::self_test::{Output, Proof, SelfTest};
use pt326_rig::Rig;

use crate::experiment::scenario::Scenario;
use crate::experiment::{as_written, sample};

/// The gain that the self-test measures where it passes, degC per %. The interlock cuts; what is broken from the start on is broken.
///
/// # Errors
/// Settings that no controller takes.
pub(super) fn passes(config: &Config, scenario: &Scenario, seed: u64) -> anyhow::Result<Option<f32>> {
    let controller = Controller::new(config)?;
    let mut state = controller.start(config.setpoint);
    let mut test = SelfTest::new(Proof::Cuts { seen: true }, &controller.plant());
    let broken: Vec<_> =
        scenario.faults.iter().filter(|fault| fault.at <= 0.0 && fault.over.is_none()).cloned().collect();
    let mut rig =
        Rig::new(&scenario.rig, scenario.disturbance, as_written(config.sample_time.0), seed, &broken);
    while test.ending().is_none() {
        let raw = sample(&mut rig);
        let tick = controller.step(&mut state, raw);
        let given = match test.step(&tick.sample, &raw, controller.hazard(&state)) {
            Output::On { power, contactor: true } => power.0,
            _ => 0.0,
        };
        rig.advance(f64::from(given));
    }
    Ok(test.measured_gain())
}
