//! The simulation as the board must see it: the same core and rig, but a power that comes in the steps of the PWM, and
//! ticks at rest before the order to arm.

use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::{AdcCode, Command, Config, Instrument, Percent, RawSample, Report, Tick};
use firmware_logic::duty;
use pt326_host::experiment::scenario::Scenario;
use pt326_host::experiment::{self, Backend, Record};

use crate::wiring::AT_REST;

/// Steps of the heater's PWM: 100 MHz over 20 kHz.
const STEPS: u16 = 5000;

/// The core on the host, driving a PWM.
struct Twin {
    instrument: Instrument,
    /// What the core asked for, which the PWM only comes near to.
    tick: Option<Tick>,
}

impl Backend for Twin {
    /// The tick with the power that the rig gets.
    fn control(&mut self, raw: RawSample) -> Tick {
        let tick = self.instrument.control(raw);
        self.tick = Some(tick);
        let steps = duty::compare(tick.drive, STEPS);
        Tick { drive: Percent(f32::from(steps) * 100.0 / f32::from(STEPS)), ..tick }
    }

    /// The diagnosis gets what the core asked for, as on the board.
    fn diagnose(&mut self, tick: &Tick) -> Report {
        let asked = self.tick.unwrap_or(*tick);
        self.instrument.diagnose(&asked, asked.drive)
    }

    fn command(&mut self, command: Command) -> Result<(), String> {
        Backend::command(&mut self.instrument, command)
    }

    fn baseline(&self) -> Option<Baseline> {
        Backend::baseline(&self.instrument)
    }
}

/// Runs a scenario as the board does that was armed at its tick `idle_ticks`; the power of its rows is that of the PWM.
///
/// # Errors
/// The configuration is out of bounds.
pub fn run(scenario: &Scenario, seed: u64, idle_ticks: usize) -> anyhow::Result<Record> {
    let config = experiment::with_prbs_phase(&Config::default(), seed);
    let mut twin = Twin { instrument: Instrument::new(&config)?, tick: None };
    let code = AdcCode(AT_REST.into());
    for _ in 0..idle_ticks {
        let tick = twin.control(RawSample { t0: code, t1: code, t2: code, ..RawSample::default() });
        twin.diagnose(&tick);
    }
    Ok(experiment::run_on(&mut twin, &config, scenario, seed))
}
