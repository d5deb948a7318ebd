//! Whatever happens around the control loop, the heater's output must end up disabled, and stay so until acknowledged.

mod output;

use fdi_core::control::Controller;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::sense::thermistor::ThermistorConfig;
use fdi_core::supervisor::Blocker;
use fdi_core::{AdcCode, Command, Config, Feedback, Mode, Percent, RawSample, Refusal, TripReason};
use firmware_logic::cadence::Arrival;
use firmware_logic::control_loop::{ControlLoop, Denial, Order, OrderKind, TickRecord};
use firmware_logic::interlock::{Interlock, Lockout};
use firmware_logic::reset_cause::ResetCause;
use output::Output;

/// Settings that arm without a self-test: that has tests of its own.
fn waived() -> Config {
    let mut config = Config::default();
    config.supervisor.check_before_arming = false;
    config
}

struct Bench {
    control: ControlLoop,
    output: Output,
    codes: RawSample,
    noise: u32,
}

impl Bench {
    fn new(cause: ResetCause) -> Self {
        let config = waived();
        let controller = Controller::new(&config).expect("the default is valid");
        let interlock = Interlock::at_boot(cause, None);
        let ambient = ambient_code();
        Self {
            control: ControlLoop::new(controller, config.setpoint, interlock),
            output: Output::default(),
            codes: RawSample { t0: ambient, t1: ambient, t2: ambient, ..RawSample::default() },
            noise: 0,
        }
    }

    fn heating() -> Self {
        let mut bench = Self::new(ResetCause::PowerOn);
        assert_eq!(bench.order(Command::Arm).outcome.expect("an order").result, Ok(()));
        let record = bench.tick();
        assert!(record.tick.mode.is_heating() && bench.output.given() > 0.0, "it is cold: heat");
        assert_eq!(record.applied, record.tick.drive);
        bench
    }

    fn step(&mut self, order: Option<Order>) -> TickRecord {
        self.noise = (self.noise + 1) % 3; // a live sensor is never quite still
        let wiggle = |code: AdcCode| AdcCode(code.0 + self.noise as f32);
        let raw = RawSample {
            t0: self.codes.t0,
            t1: wiggle(self.codes.t1),
            t2: wiggle(self.codes.t2),
            ..RawSample::default()
        };
        self.control.tick(raw, Arrival::default(), order, Feedback::default(), &mut self.output)
    }

    fn tick(&mut self) -> TickRecord {
        self.step(None)
    }

    fn order(&mut self, command: Command) -> TickRecord {
        self.step(Some(Order::Command(command)))
    }
}

fn ambient_code() -> AdcCode {
    let config = ThermistorConfig::default();
    // 22.5 degC by the beta equation, R25 = pull-up = 10 k: code = 4095 r / (1 + r), r = R / R25.
    let r = (config.beta * (1.0 / 295.65 - 1.0 / 298.15)).exp();
    AdcCode((4095.0 * r / (1.0 + r)).round())
}

#[test]
fn starts_disabled_and_arms_only_on_command() {
    let mut bench = Bench::new(ResetCause::PowerOn);
    for _ in 0..50 {
        assert_eq!(bench.tick().applied, Percent(0.0));
        assert!(!bench.output.enabled);
    }
    let record = bench.order(Command::Arm);
    assert_eq!(record.outcome.expect("an order").result, Ok(()));
    assert!(bench.output.enabled && bench.output.given() > 0.0);
}

#[test]
fn an_open_break_input_cuts_at_once_latches_and_survives_being_closed() {
    let mut bench = Bench::heating();
    bench.output.open = true;
    bench.output.enabled = false; // what the chip does by itself
    let record = bench.tick();
    assert_eq!((record.lockout, record.applied), (Some(Lockout::BreakInput), Percent(0.0)));
    assert_eq!(record.tick.mode, Mode::Off);
    bench.output.open = false;
    for _ in 0..10 {
        bench.tick();
        assert!(!bench.output.enabled, "closing the interlock must not bring the heat back");
    }
    assert_eq!(
        bench.order(Command::Arm).outcome.expect("an order").result,
        Err(Denial::LockedOut(Lockout::BreakInput))
    );
    assert_eq!(bench.order(Command::Acknowledge).outcome.expect("an order").result, Ok(()));
    assert!(!bench.output.enabled, "acknowledging is not arming");
    assert_eq!(bench.order(Command::Arm).outcome.expect("an order").result, Ok(()));
    assert!(bench.output.enabled);
}

#[test]
fn does_not_arm_or_tune_with_the_break_input_open() {
    for command in [Command::Arm, Command::Tune] {
        let mut bench = Bench::new(ResetCause::PowerOn);
        bench.output.open = true;
        let record = bench.order(command);
        assert_eq!(record.outcome.expect("an order").result, Err(Denial::BreakOpen));
        assert_eq!((record.tick.mode, bench.output.enabled), (Mode::Off, false));
    }
}

/// What arming asks for, an experiment asks for; and it is cut as whatever heats is.
#[test]
fn an_experiment_is_cut_locked_out_and_stopped_as_regulation_is() {
    let mut bench = Bench::new(ResetCause::PowerOn);
    assert_eq!(bench.order(Command::Tune).outcome.expect("an order").result, Ok(()));
    (0..100).for_each(|_| {
        bench.tick();
    });
    assert!(bench.output.given() > 0.0, "at rest first, then it heats");
    bench.output.open = true;
    bench.output.enabled = false;
    let record = bench.tick();
    assert_eq!((record.lockout, record.tick.mode), (Some(Lockout::BreakInput), Mode::Off));
    bench.output.open = false;
    let locked_out = Err(Denial::LockedOut(Lockout::BreakInput));
    assert_eq!(bench.order(Command::Tune).outcome.expect("an order").result, locked_out);
    assert_eq!(bench.order(Command::Acknowledge).outcome.expect("an order").result, Ok(()));
    assert_eq!(bench.order(Command::Tune).outcome.expect("an order").result, Ok(()));
    (0..100).for_each(|_| {
        bench.tick();
    });
    bench.codes.t1 = AdcCode(4090.0);
    assert!(matches!(bench.tick().tick.mode, Mode::Tripped(_)));
    assert!(bench.output.is_off());
}

/// Between two ticks: the power goes at once, and the next tick trips by what was seen, though it is over by then.
#[test]
fn what_is_dangerous_by_itself_waits_for_no_tick() {
    let (ambient, hot) = (ambient_code(), AdcCode(500.0));
    let sample = |t1, t2| RawSample { t0: ambient, t1, t2, ..RawSample::default() };
    for (raw, reason) in [
        (sample(AdcCode(4095.0), ambient), TripReason::T1Open),
        (sample(AdcCode(0.0), ambient), TripReason::T1Short),
        (sample(hot, ambient), TripReason::T1OverTemperature),
        (sample(ambient, hot), TripReason::T2OverTemperature),
    ] {
        let mut bench = Bench::heating();
        bench.control.look(sample(ambient, AdcCode(f32::NAN)), &mut bench.output);
        assert!(bench.output.given() > 0.0, "{reason:?}: nothing dangerous yet");
        bench.control.look(raw, &mut bench.output);
        assert_eq!(bench.output.given(), 0.0, "{reason:?}");
        bench.control.look(sample(ambient, ambient), &mut bench.output);
        assert_eq!(bench.output.given(), 0.0, "{reason:?}: it comes not back by itself");
        let record = bench.tick();
        let Mode::Tripped(trip) = record.tick.mode else { panic!("{reason:?}: {:?}", record.tick.mode) };
        assert_eq!((trip.reason, record.raw), (reason, raw), "a replay sees what the board saw");
        assert!(!bench.output.enabled);
    }
}

#[test]
fn the_deadline_watchdog_is_told_from_the_break_input() {
    let mut bench = Bench::heating();
    bench.output.missed_deadline = true;
    bench.output.enabled = false;
    assert_eq!(bench.tick().lockout, Some(Lockout::MissedDeadline));
    assert_eq!(bench.output.given(), 0.0);
}

#[test]
fn what_the_loop_does_not_see_by_itself_locks_it_out_heating_or_not() {
    for mut bench in [Bench::new(ResetCause::PowerOn), Bench::heating()] {
        bench.control.lock_out(Lockout::WrongClock, &mut bench.output);
        assert!(bench.output.is_off(), "at once");
        let record = bench.tick();
        assert_eq!((record.lockout, record.tick.mode), (Some(Lockout::WrongClock), Mode::Off));
        let refused = bench.order(Command::Arm).outcome.expect("an order").result;
        assert_eq!(refused, Err(Denial::LockedOut(Lockout::WrongClock)));
        assert!(bench.output.is_off());
        assert_eq!(bench.order(Command::Acknowledge).outcome.expect("an order").result, Ok(()));
        assert_eq!(bench.order(Command::Arm).outcome.expect("an order").result, Ok(()));
    }
}

#[test]
fn a_fault_reset_needs_an_acknowledgement() {
    let mut bench = Bench::new(ResetCause::Watchdog);
    let held = Lockout::Reset(ResetCause::Watchdog);
    assert_eq!(bench.order(Command::Arm).outcome.expect("an order").result, Err(Denial::LockedOut(held)));
    assert!(!bench.output.enabled);
    assert_eq!(bench.order(Command::Acknowledge).outcome.expect("an order").result, Ok(()));
    assert_eq!(bench.order(Command::Arm).outcome.expect("an order").result, Ok(()));
}

#[test]
fn stop_works_in_every_mode() {
    let mut bench = Bench::heating();
    assert_eq!(bench.order(Command::Stop).tick.mode, Mode::Off);
    assert!(!bench.output.enabled);

    let mut held = Bench::new(ResetCause::Watchdog);
    assert_eq!(held.order(Command::Stop).tick.mode, Mode::Off);

    let mut tripped = Bench::heating();
    tripped.codes.t1 = AdcCode(4090.0);
    tripped.tick();
    assert!(matches!(tripped.order(Command::Stop).tick.mode, Mode::Tripped(_)), "a trip is not stopped away");
    assert!(!tripped.output.enabled);
}

#[test]
fn a_stop_that_has_cut_the_output_already_is_no_fault() {
    let mut bench = Bench::heating();
    bench.output.enabled = false; // the console cuts first and then says so
    let record = bench.order(Command::Stop);
    assert_eq!((record.tick.mode, record.lockout), (Mode::Off, None));
    assert_eq!(bench.order(Command::Arm).outcome.expect("an order").result, Ok(()));
}

#[test]
fn a_trip_cuts_in_the_same_tick_and_one_acknowledgement_serves() {
    for (code, reason) in [(4090.0, TripReason::T1Open), (5.0, TripReason::T1Short)] {
        let mut bench = Bench::heating();
        bench.codes.t1 = AdcCode(code);
        let record = bench.tick();
        assert!(
            matches!(record.tick.mode, Mode::Tripped(trip) if trip.reason == reason),
            "{:?}",
            record.tick.mode
        );
        assert_eq!((record.applied, bench.output.given()), (Percent(0.0), 0.0));
        bench.codes.t1 = ambient_code();
        (0..20).for_each(|_| {
            bench.tick();
        });
        assert_eq!(bench.order(Command::Acknowledge).outcome.expect("an order").result, Ok(()));
        assert_eq!(bench.tick().tick.mode, Mode::Off);
    }
}

#[test]
fn the_contactor_is_closed_by_arming_and_opened_by_every_way_out() {
    type Way = fn(&mut Bench);
    let ways_out: [(&str, Way); 5] = [
        ("stop", |bench| {
            bench.order(Command::Stop);
        }),
        ("trip", |bench| bench.codes.t1 = AdcCode(4090.0)),
        ("break input", |bench| (bench.output.open, bench.output.enabled) = (true, false)),
        ("missed deadline", |bench| (bench.output.missed_deadline, bench.output.enabled) = (true, false)),
        ("missed ticks", |bench| {
            for _ in 0..10 {
                bench.control.missed(Arrival::default(), &mut bench.output);
            }
        }),
    ];
    for (name, leave) in ways_out {
        let mut bench = Bench::new(ResetCause::PowerOn);
        bench.tick();
        assert!(!bench.output.contactor, "{name}: closed before arming");
        bench.order(Command::Arm);
        assert!(bench.output.contactor, "{name}: not closed by arming");
        leave(&mut bench);
        bench.tick();
        assert!(!bench.output.contactor, "{name}: still closed");
    }
}

#[test]
fn missed_ticks_keep_the_power_they_really_had_and_trip_when_too_many() {
    let mut bench = Bench::heating();
    let before = bench.tick();
    let first = bench.control.missed(Arrival::default(), &mut bench.output);
    assert!(first.missed && !before.missed);
    assert_eq!(first.applied, before.applied, "nobody wrote a new power meanwhile");
    assert_eq!(first.tick.index, before.tick.index + 1, "the core's time goes on");
    let modes: Vec<_> =
        (0..10).map(|_| bench.control.missed(Arrival::default(), &mut bench.output).tick.mode).collect();
    assert!(
        matches!(modes.last(), Some(Mode::Tripped(trip)) if trip.reason == TripReason::T1Lost),
        "{modes:?}"
    );
    assert!(!bench.output.enabled);

    let mut cut = Bench::heating();
    cut.output.enabled = false;
    assert_eq!(cut.control.missed(Arrival::default(), &mut cut.output).applied.0, 0.0);
}

#[test]
fn what_was_restored_need_not_wait_for_the_clock_of_learning() {
    let blocked = |restored| {
        let mut bench = Bench::new(ResetCause::PowerOn);
        if restored {
            bench.control.restored(&Baseline::default());
        }
        bench.order(Command::Arm).tick.blocked
    };
    assert_eq!((blocked(false), blocked(true)), (None, Some(Blocker::OutOfRegulation)));
}

#[test]
fn acknowledging_nothing_is_refused() {
    let mut bench = Bench::heating();
    let outcome = bench.order(Command::Acknowledge).outcome.expect("an order");
    assert!(matches!(outcome.result, Err(Denial::Refused(Refusal::NotInMode("settle")))), "{outcome:?}");
    assert!(bench.output.enabled, "a refused order changes nothing");
}

#[test]
fn new_settings_take_effect_without_a_restart() {
    let mut bench = Bench::heating();
    let config = Config {
        pid: fdi_core::control::pid::PidConfig { output_max: Percent(20.0), ..Default::default() },
        ..Config::default()
    };
    let controller = Controller::new(&config).expect("valid");
    let record = bench.step(Some(Order::Retune(controller)));
    assert_eq!(record.outcome.expect("an order").order, OrderKind::Settings);
    assert!(record.tick.mode.is_heating() && record.tick.drive.0 <= 20.0, "{:?}", record.tick.drive);
}

/// One acknowledgement serves both latches, and does not say ok while one of them stays.
#[test]
fn an_acknowledgement_says_why_a_trip_stays_though_it_has_released_the_lockout() {
    let mut bench = Bench::heating();
    let whole = bench.codes.t1;
    bench.codes.t1 = AdcCode(4095.0);
    assert!(matches!(bench.tick().tick.mode, Mode::Tripped(_)));
    bench.control.lock_out(Lockout::WrongClock, &mut bench.output);
    let result = |record: TickRecord| record.outcome.expect("an order").result;
    let persists = Err(Denial::Refused(Refusal::CausePersists(TripReason::T1Open)));
    assert_eq!(result(bench.order(Command::Acknowledge)), persists);
    assert!(matches!(bench.tick().tick.mode, Mode::Tripped(_)));
    bench.codes.t1 = whole;
    (0..20).for_each(|_| {
        bench.tick();
    });
    assert_eq!(result(bench.order(Command::Acknowledge)), Ok(()));
    assert_eq!(bench.tick().tick.mode, Mode::Off);
}

/// What was cut while no tick came was not applied.
#[test]
fn power_that_was_cut_before_a_missed_tick_is_not_counted_as_applied() {
    let mut bench = Bench::heating();
    let record = bench.control.missed(Arrival::default(), &mut bench.output);
    assert!(record.applied.0 > 0.0 && record.applied.0 == bench.output.given());
    bench.output.enabled = false;
    assert_eq!(bench.control.missed(Arrival::default(), &mut bench.output).applied, Percent(0.0));
}
