//! What the likelihood diagnosis says of the rig: every class named, nothing said of what is no fault, a virtual T1 regulated where T1 is faulty.

use std::mem::size_of;

use fdi_core::likelihood::{FaultClass, LikelihoodState, Readiness, RejectReason};
use fdi_core::{Config, Instrument, Mode, TripReason};
use pt326_host::experiment::scenario::{Action, Scenario};
use pt326_host::experiment::{FaultSize, Record, Row, on_rig, run, run_on};
use pt326_host::record::summary::Summary;
use pt326_lab::preset::with_prbs_phase;
use pt326_rig::fault::{Fault, Sensor, Verb};
use pt326_rig::{Disturbance, RigConfig};

const ONSET: f64 = 400.03;

fn fault(verb: Verb, sensor: Option<Sensor>, size: f64, lag: Option<f64>, duration: f64) -> Fault {
    Fault { lag, ..Fault::new(verb, sensor, Some(size), ONSET, duration) }
}

fn scenario(faults: Vec<Fault>, duration: f64) -> Scenario {
    Scenario { duration, disturbance: Disturbance::Lively, faults, ..Scenario::default() }
}

/// Time since the onset of rows after it.
fn since_onset(record: &Record) -> impl Iterator<Item = (f64, &Row)> {
    record.rows.iter().map(|row| (record.time(row.tick.index) - ONSET, row)).filter(|(t, _)| *t >= 0.0)
}

fn alarms(record: &Record) -> Vec<f64> {
    let on = |row: &Row| row.report.likelihood.alarm;
    record.rows.windows(2).filter(|w| !on(&w[0]) && on(&w[1])).map(|w| record.time(w[1].tick.index)).collect()
}

fn is(row: &Row, class: FaultClass) -> bool {
    row.report.likelihood.finding.is_some_and(|finding| finding.class == class)
}

#[test]
fn every_class_is_named_with_its_size() {
    use Sensor::{T0, T1, T2};
    use fdi_core::likelihood::Channel;
    // What is done, what it must be called, how long that may take, and the magnitude with the error allowed.
    let cases = [
        (fault(Verb::Offset, Some(T2), 1.5, None, 25.0), FaultClass::T2Offset, 1.0, Some((1.5, 0.2))),
        (fault(Verb::Offset, Some(T2), -1.5, None, 25.0), FaultClass::T2Offset, 1.0, Some((-1.5, 0.2))),
        (fault(Verb::Offset, Some(T1), 1.5, None, 25.0), FaultClass::T1Offset, 1.0, Some((1.5, 0.3))),
        (fault(Verb::Offset, Some(T1), -1.5, None, 25.0), FaultClass::T1Offset, 16.0, Some((-1.5, 0.3))),
        (fault(Verb::Offset, Some(T0), 1.5, None, 25.0), FaultClass::T0Fault, 1.0, Some((1.5, 0.3))),
        (fault(Verb::Clog, Some(T1), 0.85, Some(0.4), 25.0), FaultClass::T1Clogged, 2.5, Some((-15.0, 2.0))),
        (fault(Verb::Clog, Some(T1), 1.0, Some(0.8), 25.0), FaultClass::T1Clogged, 9.0, None),
        (fault(Verb::AirFlow, None, 1.26, None, 25.0), FaultClass::AirFlow, 5.0, Some((26.0, 4.0))),
        (fault(Verb::AirFlow, None, 0.8, None, 25.0), FaultClass::AirFlow, 5.0, Some((-20.0, 4.0))),
        (fault(Verb::HeaterPower, None, 0.7, None, 25.0), FaultClass::HeaterPower, 12.0, Some((-30.0, 3.0))),
        (fault(Verb::Drift, Some(T2), 3.0, None, 60.0), FaultClass::Drift, 25.0, Some((3.0, 1.0))),
        (fault(Verb::Stuck, Some(T2), 0.0, None, 25.0), FaultClass::Stuck(Channel::T2), 4.0, None),
        (fault(Verb::Open, Some(T2), 0.0, None, 25.0), FaultClass::Open(Channel::T2), 0.4, None),
        (fault(Verb::Short, Some(T0), 0.0, None, 25.0), FaultClass::Short(Channel::T0), 0.4, None),
        (fault(Verb::Open, Some(T1), 0.0, None, 25.0), FaultClass::Open(Channel::T1), 0.4, None),
    ];
    for (fault, class, latest, magnitude) in cases {
        for seed in [11, 12, 13] {
            let record = run(&Config::default(), &scenario(vec![fault.clone()], 470.0), seed).unwrap();
            let told = since_onset(&record).find(|(_, row)| is(row, class));
            let (delay, _) = told.unwrap_or_else(|| panic!("{} is never named, seed {seed}", fault.label()));
            assert!(delay <= latest, "{}: named after {delay} s, seed {seed}", fault.label());
            // The two look alike at first: that it is one of them is said as soon as anything is.
            if matches!(class, FaultClass::AirFlow | FaultClass::HeaterPower) {
                let alike = since_onset(&record).find(|(_, row)| is(row, FaultClass::AirFlowOrHeaterPower));
                let (delay, _) = alike.unwrap_or_else(|| panic!("{}: the pair, seed {seed}", fault.label()));
                assert!(delay <= 1.5, "{}: the pair after {delay} s, seed {seed}", fault.label());
            }
            // A T1 that only lags shows only when something moves: its alarm may come and go.
            let during = since_onset(&record).take_while(|(t, _)| *t < fault.duration);
            let finding =
                during.filter_map(|(_, row)| row.report.likelihood.finding).last().expect("named above");
            assert_eq!(finding.class, class, "{}, seed {seed}", fault.label());
            if let Some((truth, error)) = magnitude {
                let magnitude =
                    finding.magnitude.unwrap_or_else(|| panic!("{}: no size, seed {seed}", fault.label()));
                let value = magnitude.value;
                assert!((value - truth).abs() <= error, "{}: {value}, seed {seed}", fault.label());
            }
        }
    }
}

/// Long after its onset, little but its size tells a small error of T0: it keeps the name that it had, on the last tick before it is mended, too.
#[test]
fn an_error_of_t0_keeps_its_name_to_its_end() {
    for seed in 11..19 {
        let wrong = fault(Verb::Offset, Some(Sensor::T0), 1.5, None, 25.0);
        let record = run(&Config::default(), &scenario(vec![wrong], 430.0), seed).unwrap();
        let (_, last) = since_onset(&record).take_while(|(t, _)| *t < 24.9).last().expect("ticks");
        let finding = last.report.likelihood.finding;
        assert!(is(last, FaultClass::T0Fault), "seed {seed}: {finding:?}");
    }
}

/// Whether it is all as trained again is asked of each alarm: an error below the smallest that counts since training is none the less there.
#[test]
fn the_alarm_of_a_small_error_stands_as_long_as_the_error() {
    for seed in [11, 12] {
        let small = fault(Verb::Offset, Some(Sensor::T1), 0.5, None, 60.0);
        let record = run(&Config::default(), &scenario(vec![small], 480.0), seed).unwrap();
        let on = |from: f64, to: f64| {
            let within = since_onset(&record).filter(move |(t, _)| (from..to).contains(t));
            let alarm: Vec<bool> = within.map(|(_, row)| row.report.likelihood.alarm).collect();
            alarm
        };
        assert!(on(15.0, 60.0).iter().all(|alarm| *alarm), "seed {seed}: {:?}", alarms(&record));
        assert!(!on(70.0, 79.0).contains(&true), "seed {seed}: {:?}", alarms(&record));
    }
}

/// What came and went twice is a loose contact, and its alarm stands until it has held for the window; what came once is an error that was mended.
#[test]
fn an_error_that_came_and_went_twice_is_one_alarm_of_a_loose_contact() {
    for (sensor, class) in [(Sensor::T1, FaultClass::T1Loose), (Sensor::T2, FaultClass::T2Loose)] {
        let at = |since| Fault { at: ONSET + since, ..fault(Verb::Offset, Some(sensor), 1.0, None, 20.0) };
        let record =
            run(&Config::default(), &scenario([0.0, 60.0, 120.0].map(at).to_vec(), 850.0), 11).unwrap();
        assert_eq!(alarms(&record).len(), 2, "{sensor:?}: {:?}", alarms(&record));
        let (since, row) = since_onset(&record).find(|(_, row)| is(row, class)).expect("it is named");
        assert!((80.0..83.0).contains(&since), "{sensor:?}: {since} s");
        let onset = row.report.likelihood.finding.map(|finding| record.time(finding.onset) - ONSET);
        assert!(onset.is_some_and(|onset| onset < 2.0), "{sensor:?}: since the first, {onset:?}");
        let stands = since_onset(&record).filter(|(_, row)| row.report.likelihood.alarm).last();
        assert!(stands.is_some_and(|(t, _)| (400.0..415.0).contains(&t)), "{sensor:?}: {stands:?}");
    }
}

/// The record of a fault on the rig of a preset.
fn on(preset: &str, fault: Fault, duration: f64, seed: u64) -> Record {
    let config = with_prbs_phase(&Config::default(), seed);
    let scenario = Scenario { duration, faults: vec![fault], ..Scenario::default() };
    let scenario = on_rig(scenario, &config, Some(preset), None, FaultSize::default()).expect("a preset");
    run(&config, &scenario, seed).expect("a scenario")
}

#[test]
fn a_throttle_that_is_half_closed_is_less_air() {
    for (preset, size) in [("recorded", 0.6), ("trainer", 0.5), ("harsh", 0.5)] {
        for seed in [11, 12, 13] {
            let record = on(preset, fault(Verb::AirFlow, None, size, None, 40.0), 440.0, seed);
            let late = since_onset(&record).filter(|(t, _)| (20.0..40.0).contains(t));
            for (t, row) in late {
                let finding = row.report.likelihood.finding;
                assert!(is(row, FaultClass::AirFlow), "{preset}, seed {seed}, {t} s: {finding:?}");
            }
        }
    }
}

/// A T2 below dirt follows the air late, and sees 15 % less: nothing of the bank, but it does not stand still.
#[test]
fn a_late_t2_does_not_stand_still() {
    for seed in [11, 12, 13] {
        let record = on("recorded", fault(Verb::Clog, Some(Sensor::T2), 0.85, Some(1.2), 60.0), 460.0, seed);
        let late: Vec<_> = since_onset(&record).filter(|(t, _)| (20.0..60.0).contains(t)).collect();
        let share = |of: &dyn Fn(&Row) -> bool| {
            late.iter().filter(|(_, row)| of(row)).count() as f64 / late.len() as f64
        };
        let stuck = share(&|row| is(row, FaultClass::Stuck(fdi_core::likelihood::Channel::T2)));
        let alarm = share(&|row| row.report.likelihood.alarm);
        assert!(stuck == 0.0 && alarm > 0.9, "seed {seed}: {stuck} {alarm}, {:?}", alarms(&record));
    }
}

/// What has changed since the baseline was saved keeps neither the models from being learnt nor the signatures from telling of it.
#[test]
fn a_rig_that_has_changed_since_its_baseline_is_watched() {
    let config = Config::default();
    let baseline = run(&config, &scenario(vec![], 400.0), 51).unwrap().baseline.expect("learnt");
    for (verb, sensor, size) in [
        (Verb::HeaterPower, None, 0.92),
        (Verb::Offset, Some(Sensor::T2), 0.5),
        (Verb::AirFlow, None, 1.05),
        (Verb::Clog, Some(Sensor::T1), 0.95),
    ] {
        let mut instrument = Instrument::new(&config).unwrap();
        instrument.restore(&baseline).unwrap();
        let changed = Fault { at: 0.0, ..fault(verb, sensor, size, None, 1e6) };
        let wrong = Fault { at: 600.0, ..fault(Verb::Offset, Some(Sensor::T1), 1.5, None, 60.0) };
        let record = run_on(&mut instrument, &config, &scenario(vec![changed, wrong], 620.0), 51);
        let before = &record.rows[record.rows.len() - 220];
        assert_eq!(before.report.likelihood.readiness, Readiness::Armed, "{verb:?} {sensor:?} after 595 s");
        let alarms = alarms(&record);
        assert!(alarms.iter().any(|t| (600.0..602.0).contains(t)), "{verb:?} {sensor:?}: {alarms:?}");
    }
}

#[test]
fn two_faults_at_once_are_unknown() {
    let both = vec![
        fault(Verb::Offset, Some(Sensor::T2), 1.5, None, 25.0),
        fault(Verb::AirFlow, None, 1.26, None, 25.0),
    ];
    let record = run(&Config::default(), &scenario(both, 430.0), 5).unwrap();
    let after_4s = since_onset(&record).filter(|(t, _)| (4.0..25.0).contains(t));
    for (t, row) in after_4s {
        let class = row.report.likelihood.finding.map(|finding| finding.class);
        assert_eq!(class, Some(FaultClass::Unknown), "{t} s after the onset");
    }
}

#[test]
fn what_is_no_fault_raises_no_alarm() {
    let action = |at: f64| Action { at, ..Action::default() };
    let steps = [(400.0, 45.0), (430.0, 24.0), (460.0, 60.0), (490.0, 35.0)]
        .map(|(at, t)| Action { setpoint: Some(t), ..action(at) })
        .to_vec();
    let no_excitation =
        [(400.0, false), (450.0, true)].map(|(at, on)| Action { excite: Some(on), ..action(at) });
    let all =
        |verb, size| [Sensor::T0, Sensor::T1, Sensor::T2].map(|s| fault(verb, Some(s), size, None, 60.0));
    let cases: [(&str, Vec<Fault>, Vec<Action>); 9] = [
        ("nothing", vec![], vec![]),
        ("set-point steps", vec![], steps),
        ("no excitation", vec![], no_excitation.to_vec()),
        ("5 % missing", all(Verb::Missing, 0.05).to_vec(), vec![]),
        ("spikes of 3 degC", all(Verb::Spike, 3.0).to_vec(), vec![]),
        ("spikes of 10 degC", all(Verb::Spike, -10.0).to_vec(), vec![]),
        ("a room that warms", vec![fault(Verb::AmbientDrift, None, 2.0, None, 60.0)], vec![]),
        ("a window opened", vec![fault(Verb::Ambient, None, -2.0, None, 60.0)], vec![]),
        ("a sag of the mains", vec![fault(Verb::HeaterPower, None, 0.97, None, 30.0)], vec![]),
    ];
    for (name, faults, actions) in cases {
        for seed in [21, 22, 23] {
            let scenario = Scenario { actions: actions.clone(), ..scenario(faults.clone(), 520.0) };
            let record = run(&Config::default(), &scenario, seed).unwrap();
            assert_eq!(alarms(&record), [0.0; 0], "{name}, seed {seed}");
            let last = record.rows.last().unwrap();
            assert_eq!(
                last.report.likelihood.readiness,
                Readiness::Armed,
                "{name}: silence of a watch that is not kept"
            );
        }
    }
}

#[test]
fn a_damper_moved_after_an_announcement_is_learnt_anew() {
    let damper = fault(Verb::AirFlow, None, 1.26, None, 1000.0);
    let actions = vec![Action { at: 399.0, relearn: true, ..Action::default() }];
    let record = run(&Config::default(), &Scenario { actions, ..scenario(vec![damper], 700.0) }, 3).unwrap();
    assert_eq!(alarms(&record), [0.0; 0]);
    assert_eq!(record.rows.last().unwrap().report.likelihood.readiness, Readiness::Armed);
}

#[test]
fn a_second_fault_is_found_after_the_first_has_gone() {
    let first = fault(Verb::AirFlow, None, 1.26, None, 10.0);
    let second = Fault { at: ONSET + 20.0, ..fault(Verb::Offset, Some(Sensor::T2), 1.5, None, 10.0) };
    let record = run(&Config::default(), &scenario(vec![first, second], 450.0), 9).unwrap();
    let alarms = alarms(&record);
    assert_eq!(alarms.len(), 2, "{alarms:?}");
    assert!((ONSET..ONSET + 1.0).contains(&alarms[0]) && (ONSET + 20.0..ONSET + 20.5).contains(&alarms[1]));
}

#[test]
fn models_that_explain_too_little_are_refused() {
    let rig = RigConfig { turbulence: 1.2, ..RigConfig::default() };
    let record = run(&Config::default(), &Scenario { rig, ..scenario(vec![], 700.0) }, 2).unwrap();
    let readiness = |row: &Row| row.report.likelihood.readiness;
    assert!(record.rows.iter().any(|row| readiness(row) == Readiness::Refused(RejectReason::PoorFit)));
    assert!(record.rows.iter().all(|row| readiness(row) != Readiness::Armed));
    assert_eq!(alarms(&record), [0.0; 0]);
}

fn going_on() -> Config {
    let mut config = Config::default();
    config.supervisor.go_on_without_t1 = true;
    config
}

/// T1 reads 1.5 degC too high: the air would be as much too cold.
#[test]
fn a_t1_that_reads_wrong_gives_way_to_the_virtual_t1_without_a_bump() {
    let offset = 1.5;
    let scenario = scenario(vec![fault(Verb::Offset, Some(Sensor::T1), offset, None, 60.0)], 520.0);
    let record = run(&going_on(), &scenario, 31).unwrap();
    let mean_error = |from: f64, to: f64, offset: f64| {
        let errors: Vec<f64> = since_onset(&record)
            .filter(|(t, _)| (from..to).contains(t))
            .map(|(_, row)| f64::from(row.tick.sample.t1.celsius.0) - offset - record.setpoint)
            .collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    };
    assert!(mean_error(5.0, 60.0, offset).abs() < 0.25, "{} degC off", mean_error(5.0, 60.0, offset));
    assert!(mean_error(70.0, 110.0, 0.0).abs() < 0.1, "back on T1");
    let is_virtual = |row: &Row| row.tick.virtual_t1.is_some();
    let switches: Vec<_> =
        record.rows.windows(2).filter(|w| is_virtual(&w[0]) != is_virtual(&w[1])).collect();
    assert_eq!(switches.len(), 2, "once there and once back");
    for w in switches {
        let bump = w[1].tick.pid.0 - w[0].tick.pid.0;
        assert!(bump.abs() < 4.0, "a step of {bump} % at {} s", record.time(w[1].tick.index));
    }
    let told = Summary::new(&record).without_t1.expect("the virtual T1 was regulated");
    assert!((55.0..65.0).contains(&told.duration_s) && told.error_mean_c.abs() < 0.2, "{told:?}");
    let without = run(&Config::default(), &scenario, 31).unwrap();
    assert_eq!(Summary::new(&without).without_t1, None);
    assert!(without.rows.iter().all(|row| !is_virtual(row)), "only where it is asked for");
}

#[test]
fn a_broken_t1_trips_or_gives_way_to_the_virtual_t1() {
    let scenario = scenario(vec![fault(Verb::Open, Some(Sensor::T1), 0.0, None, 60.0)], 480.0);
    let record = run(&going_on(), &scenario, 32).unwrap();
    assert!(record.rows.iter().all(|row| !matches!(row.tick.mode, Mode::Tripped(_))));
    let virtual_t1 = |row: &Row| row.tick.virtual_t1.map(|t| t.0);
    let during: Vec<f32> =
        since_onset(&record).filter(|(t, _)| *t < 59.0).filter_map(|(_, row)| virtual_t1(row)).collect();
    assert!(
        during.len() > 500 && during[30..].iter().all(|t| (t - 35.0).abs() < 2.5),
        "regulated all the while"
    );
    let tripped = run(&Config::default(), &scenario, 32).unwrap();
    assert!(
        matches!(tripped.rows.last().unwrap().tick.mode, Mode::Tripped(trip) if trip.reason == TripReason::T1Open)
    );
}

/// Without T1 and without T2 nothing is left to regulate by.
#[test]
fn a_virtual_t1_that_is_lost_trips() {
    let t1 = fault(Verb::Open, Some(Sensor::T1), 0.0, None, 60.0);
    let t2 = Fault { at: ONSET + 10.0, ..fault(Verb::Open, Some(Sensor::T2), 0.0, None, 50.0) };
    let record = run(&going_on(), &scenario(vec![t1, t2], 440.0), 33).unwrap();
    let (t, row) = since_onset(&record).find(|(_, row)| !row.tick.mode.is_heating()).expect("a trip");
    assert!(matches!(row.tick.mode, Mode::Tripped(trip) if trip.reason == TripReason::T1Lost));
    assert!((10.0..11.0).contains(&t), "{t} s");
}

/// T1 is gone, and T2 reads far too low: regulating by it would overheat the rig.
#[test]
fn a_virtual_t1_that_the_models_contradict_trips() {
    let t1 = fault(Verb::Open, Some(Sensor::T1), 0.0, None, 60.0);
    let t2 = Fault { at: ONSET + 10.0, ..fault(Verb::Offset, Some(Sensor::T2), -10.0, None, 50.0) };
    let record = run(&going_on(), &scenario(vec![t1, t2], 440.0), 34).unwrap();
    let (t, row) = since_onset(&record).find(|(_, row)| !row.tick.mode.is_heating()).expect("a trip");
    let Mode::Tripped(trip) = row.tick.mode else { panic!("{:?}", row.tick.mode) };
    assert!([TripReason::T1Lost, TripReason::ExcessPower].contains(&trip.reason), "{trip:?}");
    assert!((10.0..14.0).contains(&t), "{t} s");
}

#[test]
fn a_t1_without_samples_gives_way_to_the_virtual_t1() {
    let faults = vec![fault(Verb::Missing, Some(Sensor::T1), 1.0, None, 30.0)];
    let record = run(&going_on(), &scenario(faults, 440.0), 35).unwrap();
    assert!(record.rows.iter().all(|row| !matches!(row.tick.mode, Mode::Tripped(_))));
    let ticks = since_onset(&record).filter(|(_, row)| row.tick.virtual_t1.is_some()).count();
    assert!((260..280).contains(&ticks), "{ticks} ticks of 30 s");
}

/// With a restored baseline, training takes place while monitoring, but not while something is wrong.
#[test]
fn a_fault_during_training_is_not_learnt() {
    let config = Config::default();
    let baseline = run(&config, &scenario(vec![], 400.0), 51).unwrap().baseline.expect("learnt");
    let mut instrument = Instrument::new(&config).unwrap();
    instrument.restore(&baseline).unwrap();
    let fault = Fault { at: 60.0, ..fault(Verb::Offset, Some(Sensor::T2), 3.0, None, 100.0) };
    let record = run_on(&mut instrument, &config, &scenario(vec![fault], 420.0), 51);
    let readiness = |row: &Row| row.report.likelihood.readiness;
    let armed =
        record.rows.iter().position(|row| readiness(row) == Readiness::Armed).expect("armed in the end");
    let after = record.time(armed as u32);
    assert!((270.0..310.0).contains(&after), "178 s of samples, but for 100 s of fault: {after} s");
    assert_eq!(alarms(&record), [0.0; 0], "what was learnt is the rig without the fault");
}

/// A heater that is stuck at 60 % is as hot after 3 s as one with half the air, and until then the two are not told apart: either reason
/// switches it off.
#[test]
fn heat_without_air_or_without_being_asked_for_trips() {
    let [air, stuck] = [TripReason::AirFlowLost, TripReason::HeaterStuckOn];
    for (verb, size, reasons) in [(Verb::AirFlow, 0.35, [air, air]), (Verb::HeaterStuck, 60.0, [stuck, air])]
    {
        let record =
            run(&Config::default(), &scenario(vec![fault(verb, None, size, None, 60.0)], 440.0), 41).unwrap();
        let (t, row) = since_onset(&record).find(|(_, row)| !row.tick.mode.is_heating()).expect("a trip");
        assert!(
            matches!(row.tick.mode, Mode::Tripped(trip) if reasons.contains(&trip.reason)),
            "{:?}",
            row.tick.mode
        );
        assert!(t < 15.0, "{t} s");
    }
}

#[test]
fn the_memory_is_bounded() {
    assert!(size_of::<LikelihoodState>() <= 8192, "{} bytes", size_of::<LikelihoodState>());
}
