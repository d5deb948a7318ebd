//! Settings that are kept beside the diagnosis, and change by themselves.

use fdi_core::control::Controller;
use fdi_core::settings::{Kind, Value};
use fdi_core::{AdcCode, Command, RawSample};

use super::*;

/// Both halves, as far as settings go.
struct Bench {
    diagnosis: DiagnosisLoop,
    controller: Controller,
    tick: u32,
}

impl Bench {
    fn new() -> Self {
        let settings = Stored::default();
        let controller = Controller::new(&settings.config).expect("valid");
        let diagnosis = Diagnosis::new(&settings.config).expect("valid");
        Self { diagnosis: DiagnosisLoop::new(diagnosis, settings), controller, tick: 0 }
    }

    /// A tick on which an order has had this outcome.
    fn tick(&mut self, outcome: Option<Outcome>) {
        let room = AdcCode(2160.0);
        let raw = RawSample { t0: room, t1: room, t2: room, ..RawSample::default() };
        let mut state = self.controller.start(fdi_core::Celsius(35.0));
        let mut tick = self.controller.step(&mut state, raw);
        tick.index = self.tick;
        self.tick += 1;
        let record = TickRecord { outcome, ..TickRecord::new(raw, tick, fdi_core::Percent(0.0)) };
        self.diagnosis.step(record, |_| {});
    }

    fn second(&mut self) {
        (0..10).for_each(|_| self.tick(None));
    }

    fn is_told(&self) -> bool {
        self.diagnosis.feedback().settings_damaged
    }

    fn config(&mut self) -> &mut Config {
        &mut self.diagnosis.settings.config
    }
}

fn carried_out(order: OrderKind) -> Option<Outcome> {
    Some(Outcome { order, result: Ok(()) })
}

#[test]
fn a_setting_that_changes_by_itself_is_told_within_a_second() {
    for setting in Config::settings() {
        let mut bench = Bench::new();
        bench.second();
        assert!(!bench.is_told() && !bench.diagnosis.is_damaged());
        let value = match (bench.config().get(setting), setting.kind) {
            (Value::Number(x), _) => Value::Number(f32::from_bits(x.to_bits() ^ 1)),
            (Value::Whole(x), _) => Value::Whole(x ^ 1),
            (Value::Switch(on), _) => Value::Switch(!on),
            (Value::Choice { form: 0, .. }, Kind::Choice(_)) => Value::Choice { form: 1, numbers: [0.5; 2] },
            (Value::Choice { .. }, _) => Value::Choice { form: 0, numbers: [0.5; 2] },
        };
        assert!(bench.config().set(setting, value));
        assert!(bench.diagnosis.is_damaged(), "{}", setting.name);
        bench.second();
        assert!(bench.is_told(), "{}", setting.name);
    }
}

#[test]
fn settings_that_are_put_in_force_are_no_damage() {
    let mut bench = Bench::new();
    let mut config = bench.config().clone();
    config.supervisor.over_temperature.0 = 70.0;
    bench.diagnosis.propose(&config).expect("valid");
    bench.tick(carried_out(OrderKind::Command(Command::Stop)));
    bench.tick(carried_out(OrderKind::Settings));
    assert_eq!(*bench.config(), config);
    bench.second();
    assert!(!bench.is_told() && !bench.diagnosis.is_damaged());
}

/// They may have been made of what is kept: that they are in force now, and have been checked, mends nothing.
#[test]
fn damaged_settings_with_which_new_ones_were_made_stay_damaged() {
    let mut bench = Bench::new();
    bench.tick(None);
    bench.config().supervisor.over_temperature.0 = 90.0;
    let mut config = bench.config().clone();
    config.pid.kp = 2.0;
    bench.diagnosis.propose(&config).expect("valid");
    bench.tick(carried_out(OrderKind::Settings));
    assert!(bench.is_told() && bench.diagnosis.is_damaged());
    bench.second();
    assert!(bench.is_told(), "until a reset");
}
