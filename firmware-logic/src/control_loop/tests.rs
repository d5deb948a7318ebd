//! What a flipped bit in the settings that run leads to, whichever of them it is.

use fdi_core::settings::{Setting, Value};
use fdi_core::{Celsius, Config};

use super::*;

/// An output that does what it is told to, while the break input is closed.
#[derive(Clone, Debug, Default)]
pub(super) struct Output {
    pub(super) power: f32,
    pub(super) contactor: bool,
    pub(super) enabled: bool,
    pub(super) open: bool,
}

impl Output {
    /// What reaches the heater, %.
    pub(super) fn given(&self) -> f32 {
        if self.enabled && self.contactor { self.power } else { 0.0 }
    }
}

impl Heater for Output {
    fn drive(&mut self, power: Percent) {
        self.power = power.0;
    }
    fn contactor(&mut self, closed: bool) {
        self.contactor = closed;
    }
    fn enable(&mut self) {
        self.enabled = !self.open;
    }
    fn disable(&mut self) {
        self.enabled = false;
    }
    fn is_enabled(&self) -> bool {
        self.enabled
    }
    fn break_is_open(&self) -> bool {
        self.open
    }
    fn cut_by(&self) -> Lockout {
        Lockout::BreakInput
    }
    fn test_break(&mut self) -> bool {
        self.enabled = false;
        !self.open
    }
}

const ROOM: RawSample =
    RawSample { t0: AdcCode(2160.0), t1: AdcCode(2160.0), t2: AdcCode(2160.0), supply: AdcCode(0.0) };

struct Bench {
    control: ControlLoop,
    output: Output,
}

impl Bench {
    fn heating(config: &Config) -> Self {
        let controller = Controller::new(config).expect("valid");
        let control = ControlLoop::new(controller, Celsius(35.0), Interlock::default());
        let mut bench = Self { control, output: Output::default() };
        assert_eq!(bench.command(Command::Arm), Ok(()));
        assert!(bench.output.enabled && bench.output.power > 0.0);
        bench
    }

    fn tick(&mut self, order: Option<Order>, feedback: Feedback) -> TickRecord {
        self.control.tick(ROOM, Arrival::default(), order, feedback, &mut self.output)
    }

    fn command(&mut self, command: Command) -> Result<(), Denial> {
        let record = self.tick(Some(Order::Command(command)), Feedback::default());
        record.outcome.expect("an order").result
    }

    fn is_off(&self) -> bool {
        self.output.power == 0.0 && !self.output.contactor && !self.output.enabled
    }
}

fn waived() -> Config {
    let mut config = Config::default();
    config.supervisor.check_before_arming = false;
    config.supply.nominal_voltage.0 = 12.0; // measured, so that its conversion is part of what runs
    config
}

/// A controller of which a setting has changed, if that setting is part of it.
fn changed(config: &Config, setting: &Setting) -> Option<Controller> {
    let intact = Controller::new(config).expect("valid");
    let others = match config.get(setting) {
        Value::Number(x) => [Value::Number(x * 0.98), Value::Number(x + 0.02)],
        Value::Whole(x) => [Value::Whole(x - 1), Value::Whole(x + 1)],
        Value::Switch(on) => [Value::Switch(!on); 2],
        choice @ Value::Choice { .. } => [choice; 2],
    };
    others.into_iter().find_map(|other| {
        let mut config = config.clone();
        assert!(config.set(setting, other));
        Controller::new(&config).ok().filter(|controller| *controller != intact)
    })
}

#[test]
fn a_setting_that_changes_by_itself_cuts_and_locks_out_until_a_reset() {
    let config = waived();
    for setting in Config::settings() {
        let Some(damaged) = changed(&config, setting) else {
            // The set-point is ordered, the rest is the other half's.
            let other_half = ["likelihood.", "diagnosis.", "identification."];
            let name = setting.name;
            assert!(name == "setpoint" || other_half.iter().any(|part| name.starts_with(part)), "{name}");
            continue;
        };
        let mut bench = Bench::heating(&config);
        bench.control.controller = damaged;
        let record = bench.tick(None, Feedback::default());
        assert_eq!((record.lockout, record.applied.0), (Some(Lockout::Settings), 0.0), "{}", setting.name);
        assert!(bench.is_off(), "{}", setting.name);
        let locked_out = Err(Denial::LockedOut(Lockout::Settings));
        for command in [Command::Acknowledge, Command::Arm, Command::Tune] {
            assert_eq!(bench.command(command), locked_out, "{}: {command:?}", setting.name);
        }
        assert_eq!(bench.command(Command::Stop), Ok(()));
    }
}

/// With a sample time of 5 s the next tick would be too late.
#[test]
fn a_look_between_two_ticks_sees_it_too() {
    let mut bench = Bench::heating(&waived());
    bench.control.look(ROOM, &mut bench.output);
    assert!(bench.output.power > 0.0 && bench.output.contactor);
    let mut config = waived();
    config.supervisor.over_temperature.0 = 76.0;
    bench.control.controller = Controller::new(&config).expect("valid");
    bench.control.look(ROOM, &mut bench.output);
    assert!(bench.output.power == 0.0 && !bench.output.contactor);
}

#[test]
fn new_settings_are_no_damage_and_damaged_ones_are_not_put_in_force() {
    let mut narrower = waived();
    narrower.supervisor.over_temperature.0 = 70.0;
    let retune = || Some(Order::Retune(Controller::new(&narrower).expect("valid")));
    let mut bench = Bench::heating(&waived());
    let record = bench.tick(retune(), Feedback::default());
    assert_eq!(record.outcome.expect("an order").result, Ok(()));
    assert_eq!(bench.tick(None, Feedback::default()).lockout, None);

    // What the other half keeps, and makes new settings of, is damaged.
    let damaged = Feedback { settings_damaged: true, ..Feedback::default() };
    let mut bench = Bench::heating(&waived());
    let record = bench.tick(retune(), damaged);
    assert_eq!(record.outcome.expect("an order").result, Err(Denial::LockedOut(Lockout::Settings)));
    assert!(record.lockout == Some(Lockout::Settings) && bench.is_off());
}
