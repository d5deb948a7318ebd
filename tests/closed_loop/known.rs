//! What is measured or announced need not be guessed: a supply that moves, and a fan that its user sets.

use fdi_core::likelihood::{FaultClass, Readiness};
use fdi_core::units::Volt;
use fdi_core::{Command, Config, Instrument, Mode, TripReason};
use pt326_host::experiment::scenario::{Action, Scenario};
use pt326_host::experiment::{Record, Row, run, sample, with_prbs_phase};
use pt326_rig::fault::{Fault, Sensor, Verb};
use pt326_rig::{Disturbance, Rig};

const ONSET: f64 = 420.03;
/// 12 V read through a divider with 16.5 V at full scale.
const NOMINAL_CODE: f64 = 4095.0 * 12.0 / 16.5;

fn measured() -> Config {
    let mut config = Config::default();
    config.supply.nominal_voltage = Volt(12.0);
    config
}

/// On a rig whose supply can be measured.
fn scenario(duration: f64) -> Scenario {
    let disturbance = Disturbance::Lively;
    let mut scenario = Scenario { duration, disturbance, faults: Vec::new(), ..Scenario::default() };
    scenario.rig.mains.measured_code = NOMINAL_CODE;
    scenario
}

fn alarms(record: &Record) -> usize {
    let on = |row: &Row| row.report.likelihood.alarm;
    record.rows.windows(2).filter(|w| !on(&w[0]) && on(&w[1])).count()
}

fn is_armed(record: &Record) -> bool {
    record.rows.last().is_some_and(|row| row.report.likelihood.readiness == Readiness::Armed)
}

/// Whether a fault of this class was told.
fn told(record: &Record, class: FaultClass) -> bool {
    record.rows.iter().any(|row| row.report.likelihood.finding.is_some_and(|f| f.class == class))
}

#[test]
fn a_supply_that_sags_is_a_fault_of_the_heater_unless_it_is_measured() {
    for seed in [11, 12, 13] {
        let mut sag = scenario(500.0);
        sag.faults = vec![Fault::new(Verb::SupplyVoltage, None, Some(0.9), ONSET, 40.0)];
        let guessed = run(&Config::default(), &sag, seed).unwrap();
        assert!(told(&guessed, FaultClass::HeaterPower), "seed {seed}");
        let known = run(&measured(), &sag, seed).unwrap();
        assert!(is_armed(&known) && alarms(&known) == 0, "seed {seed}");
    }
}

#[test]
fn steps_of_the_mains_alarm_only_where_they_are_not_measured() {
    let mut restless = scenario(1500.0);
    (restless.rig.mains.steps, restless.rig.mains.step_size) = (60.0, 2.0);
    let (mut guessed, mut known) = (0, 0);
    for seed in [11, 12] {
        guessed += alarms(&run(&Config::default(), &restless, seed).unwrap());
        let record = run(&measured(), &restless, seed).unwrap();
        assert!(is_armed(&record), "seed {seed}");
        known += alarms(&record);
    }
    assert!(guessed > 0 && known == 0, "{guessed}, {known}");
}

/// Measured, a heater that gives less than its supply explains is still found.
#[test]
fn a_measured_supply_hides_no_fault_of_the_heater() {
    let mut weak = scenario(480.0);
    weak.rig.mains.steps = 60.0;
    weak.faults = vec![Fault::new(Verb::HeaterPower, None, Some(0.7), ONSET, 40.0)];
    let record = run(&measured(), &weak, 11).unwrap();
    assert!(told(&record, FaultClass::HeaterPower));
}

/// The worst that the input can say is half the voltage, a quarter of the power. That must not make a power without an
/// answer look small, be it wrong from the start or from the moment on.
#[test]
fn a_supply_that_reads_too_low_hides_no_heat_without_effect() {
    let out = |sensor| Fault::new(Verb::Detach, Some(sensor), Some(1.0), ONSET, 1e5);
    let config = with_prbs_phase(&measured(), 11);
    for (before, after) in [(1.0, 1.0), (0.51, 0.51), (1.0, 0.51)] {
        let rig = scenario(1.0).rig;
        let mut rig = Rig::new(&rig, Disturbance::Lively, 0.11, 11, &[out(Sensor::T1), out(Sensor::T2)]);
        let mut instrument = Instrument::new(&config).unwrap();
        instrument.command(Command::Arm).unwrap();
        let trip = (0..4200).find_map(|k| {
            let time = f64::from(k) * 0.11;
            let mut raw = sample(&mut rig);
            raw.supply.0 *= if time < ONSET { before } else { after };
            let tick = instrument.control(raw);
            instrument.diagnose(&tick, tick.drive);
            rig.advance(f64::from(tick.drive.0));
            match tick.mode {
                Mode::Tripped(trip) => Some((time - ONSET, trip.reason)),
                _ => None,
            }
        });
        let (delay, reason) = trip.expect("it trips");
        assert!(
            delay < 10.0 && reason == TripReason::ExcessPower,
            "{before}, {after}: {delay} s, {reason:?}"
        );
    }
}

/// A supply that sags to 80 % has the loop ask for 1.56 times the power: less than what counts as too much.
#[test]
fn a_sag_that_is_measured_does_not_trip() {
    let mut sag = scenario(480.0);
    sag.faults = vec![Fault::new(Verb::SupplyVoltage, None, Some(0.8), ONSET, 1e5)];
    let record = run(&measured(), &sag, 11).unwrap();
    assert_eq!(record.rows.last().unwrap().tick.mode, Mode::Monitor);
}

/// What the user says of the fan is told to no thermistor: the air that there is must still be enough.
#[test]
fn a_fan_set_lower_does_not_trip_and_one_set_too_low_does() {
    let at = |fan| Action { at: ONSET, fan: Some(fan), ..Action::default() };
    for seed in [11, 12, 13] {
        let mode = |fan: f32| {
            let record = run(&measured(), &Scenario { actions: vec![at(fan)], ..scenario(480.0) }, seed);
            record.unwrap().rows.last().unwrap().tick.mode
        };
        assert_eq!((mode(80.0), mode(60.0)), (Mode::Monitor, Mode::Monitor), "seed {seed}");
        assert!(matches!(mode(0.0), Mode::Tripped(trip) if trip.reason == TripReason::AirFlowLost));
    }
}

/// Models of one flow are not made from two.
#[test]
fn nothing_is_trained_while_the_fan_is_announced_to_be_elsewhere() {
    let slow = Action { at: 100.0, fan: Some(90.0), ..Action::default() };
    let usual = Action { at: 500.0, fan: Some(100.0), relearn: true, ..Action::default() };
    let never = run(&Config::default(), &Scenario { actions: vec![slow], ..scenario(800.0) }, 11).unwrap();
    assert!(!is_armed(&never));
    let later =
        run(&Config::default(), &Scenario { actions: vec![slow, usual], ..scenario(1000.0) }, 11).unwrap();
    assert!(is_armed(&later));
}

/// A model that expects the heat of less air does not think that this is air enough.
#[test]
fn too_little_air_trips_whatever_the_fan_is_announced_at() {
    let damper = Fault::new(Verb::AirFlow, None, Some(0.6), ONSET + 40.0, 1e5);
    let slower = Action { at: ONSET, fan: Some(60.0), ..Action::default() };
    let tripped = |actions, faults| {
        let record = run(&Config::default(), &Scenario { actions, faults, ..scenario(500.0) }, 11).unwrap();
        matches!(record.rows.last().unwrap().tick.mode, Mode::Tripped(trip) if trip.reason == TripReason::AirFlowLost)
    };
    assert!(tripped(vec![slower], vec![damper]), "36 % of the air is left");
    assert!(!tripped(vec![slower], vec![]), "60 % is left");
}

/// The model follows the fan as it is announced.
#[test]
fn an_announced_change_of_the_fan_never_alarms() {
    for seed in [11, 12, 13] {
        for fan in [70.0, 90.0, 120.0] {
            let change = |at, fan| Action { at, fan: Some(fan), ..Action::default() };
            let actions = vec![change(ONSET, fan), change(ONSET + 60.0, 100.0)];
            let record = run(&Config::default(), &Scenario { actions, ..scenario(600.0) }, seed).unwrap();
            assert!(is_armed(&record) && alarms(&record) == 0, "{fan} %, seed {seed}");
        }
    }
}
