//! What the instrument does with the rig: the numbers that the paper's experiment must show, and rig events.

use std::sync::atomic::AtomicBool;

use fdi_core::control::{Controller, ControllerState};
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::identify::Adaptation;
use fdi_core::{Command, Config, Feedback, Instrument, Mode, RawSample, Report, Tick, TripReason};
use indicatif::ProgressBar;
use pt326_host::experiment::scenario::{Action, Scenario};
use pt326_host::experiment::{Backend, Record, run, run_on};
use pt326_host::record::summary::Summary;
use pt326_host::repeat::repeat;
use pt326_rig::fault::{Fault, Sensor, Verb};

fn fault(verb: Verb, sensor: Option<Sensor>, size: Option<f64>, at: f64, duration: f64) -> Fault {
    Fault::new(verb, sensor, size, at, duration)
}

fn run_with(faults: Vec<Fault>, actions: Vec<Action>, duration: f64, seed: u64) -> Record {
    let scenario = Scenario { duration, faults, actions, ..Scenario::default() };
    scenario.validate().unwrap();
    run(&Config::default(), &scenario, seed).unwrap()
}

/// The bounds, over 200 seeds, calm, nominal sizes, low-passed.
#[test]
fn two_hundred_runs_of_the_papers_experiment() {
    let r = repeat(
        &Config::default(),
        &Scenario::default(),
        1,
        200,
        &ProgressBar::hidden(),
        &AtomicBool::new(false),
    )
    .unwrap();
    let bounds = [("AFS2", 0.6, 25.0..=29.0), ("MFS1", 1.2, 10.0..=13.0), ("MFP", 1.3, 25.0..=29.0)];
    for (fault, (name, delay, duration)) in r.faults.iter().zip(bounds) {
        assert_eq!(fault.name, name);
        let score = &fault.signature;
        assert_eq!(score.detection_delay_s.missed, 0, "{name}");
        assert!(score.detection_delay_s.median.unwrap() <= delay, "{name}: {:?}", score.detection_delay_s);
        assert!(
            duration.contains(&score.indicated_duration_s.median.unwrap()),
            "{name}: {:?}",
            score.indicated_duration_s
        );
    }
    let error = r.control_error_max_pct.median.unwrap();
    assert!((4.0..=5.0).contains(&error), "largest control error {error} %");
}

#[test]
fn a_fault_free_run_learns_on_time_and_stays_quiet() {
    let record = run_with(vec![], vec![], 700.0, 4);
    let first = |name: &str| {
        record.rows.iter().find(|r| r.tick.mode.name() == name).map(|r| record.time(r.tick.index))
    };
    assert_eq!(first("learn"), Some(180.07));
    assert!((360.0..360.4).contains(&first("monitor").unwrap()));
    let baseline = record.baseline.unwrap();
    assert_eq!(baseline.samples, 1636);
    assert_eq!(Summary::new(&record).false_alarms.fdv, Some(0));
}

#[test]
fn faults_of_t1_that_endanger_trip_in_the_same_tick() {
    let cases = [
        (Verb::Open, None, TripReason::T1Open),
        (Verb::Short, None, TripReason::T1Short),
        (Verb::Offset, Some(90.0), TripReason::T1OutOfRange),
    ];
    for (verb, size, reason) in cases {
        let record = run_with(vec![fault(verb, Some(Sensor::T1), size, 50.0, 20.0)], vec![], 80.0, 1);
        let first = record.rows.iter().find(|r| r.truth != 0).unwrap();
        let Mode::Tripped(trip) = first.tick.mode else { panic!("{verb:?}: {:?}", first.tick.mode) };
        assert_eq!(trip.reason, reason);
        let after = record.rows.iter().skip_while(|r| r.truth == 0);
        assert!(after.clone().all(|r| r.tick.drive.0 == 0.0), "{verb:?}: the trip latches");
        assert!(after.count() > 200);
    }
}

#[test]
fn nothing_heats_before_it_is_armed() {
    let scenario = Scenario { duration: 8.0, arm_at: 5.0, faults: vec![], ..Scenario::default() };
    let record = run(&Config::default(), &scenario, 1).unwrap();
    for row in &record.rows {
        assert_eq!(row.tick.mode.is_heating(), record.time(row.tick.index) >= 5.0, "tick {}", row.tick.index);
    }
}

#[test]
fn a_dead_t1_trips_within_the_timeout() {
    let silent = fault(Verb::Missing, Some(Sensor::T1), Some(1.0), 50.0, 20.0);
    let stuck = fault(Verb::Stuck, Some(Sensor::T1), None, 50.0, 20.0);
    for (fault, reason, latest) in [(silent, TripReason::T1Lost, 0.7), (stuck, TripReason::T1Stuck, 3.9)] {
        let record = run_with(vec![fault], vec![], 80.0, 1);
        let summary = Summary::new(&record);
        assert_eq!(summary.trips.len(), 1, "{reason:?}");
        assert_eq!(summary.trips[0].reason, reason);
        assert!(summary.trips[0].t_s - 50.0 <= latest, "{reason:?} at {}", summary.trips[0].t_s);
    }
}

#[test]
fn over_temperature_trips_also_by_t2_alone() {
    for (sensor, reason) in
        [(Sensor::T1, TripReason::T1OverTemperature), (Sensor::T2, TripReason::T2OverTemperature)]
    {
        let record =
            run_with(vec![fault(Verb::Offset, Some(sensor), Some(45.0), 50.0, 20.0)], vec![], 60.0, 1);
        let trips = Summary::new(&record).trips;
        assert_eq!(trips.first().map(|t| (t.reason, t.limit_c)), Some((reason, 75.0)));
        assert!(trips[0].t_s < 50.3, "withheld as a spike for one tick, then believed: {}", trips[0].t_s);
    }
}

#[test]
fn t2_open_does_not_trip_and_comes_back() {
    let record = run_with(vec![fault(Verb::Open, Some(Sensor::T2), None, 400.0, 10.0)], vec![], 450.0, 1);
    assert!(record.rows.iter().all(|r| r.tick.mode.is_heating()));
    let last = record.rows.last().unwrap();
    assert!(last.report.y2.is_some() && last.report.filtered.is_some());
    let during = &record.rows[3700];
    assert!(
        during.truth != 0
            && during.report.y2.is_none()
            && during.report.filtered.is_none()
            && during.report.ms2.held
    );
}

#[test]
fn a_single_spike_neither_moves_the_loop_nor_alarms() {
    let spikes = |sensor| fault(Verb::Spike, Some(sensor), Some(10.0), 400.0, 1.0);
    let quiet = run_with(vec![], vec![], 420.0, 2);
    for sensor in [Sensor::T0, Sensor::T1, Sensor::T2] {
        let record = run_with(vec![spikes(sensor)], vec![], 420.0, 2);
        assert!(record.rows.iter().all(|r| r.report.filtered.is_none_or(|v| v.fdv == 0)), "{sensor:?}");
        let largest = record
            .rows
            .iter()
            .zip(&quiet.rows)
            .map(|(a, b)| (a.tick.drive.0 - b.tick.drive.0).abs())
            .fold(0.0, f32::max);
        assert!(largest < 3.0, "{sensor:?} moved the drive by {largest} %");
    }
}

#[test]
fn missing_samples_hold_and_do_not_trip() {
    let faults =
        [Sensor::T0, Sensor::T1, Sensor::T2].map(|s| fault(Verb::Missing, Some(s), Some(0.05), 400.0, 100.0));
    let record = run_with(faults.to_vec(), vec![], 520.0, 3);
    assert!(record.rows.iter().all(|r| r.tick.mode.is_heating()));
    assert!(record.rows.iter().all(|r| r.report.filtered.is_none_or(|v| v.fdv == 0)));
    let held = record.rows.iter().filter(|r| r.truth != 0 && r.report.ms1.held).count();
    assert!((100..700).contains(&held), "{held} held");
}

#[test]
fn learning_is_refused_while_unfit_and_begins_when_fit() {
    let setpoint = |at, to| Action { at, setpoint: Some(to), ..Action::default() };
    let excite = |at, on| Action { at, excite: Some(on), ..Action::default() };
    let cases = [
        ("Unexcited", vec![excite(100.0, false), excite(250.0, true)], 270.0),
        ("OutOfRegulation", vec![setpoint(200.0, 36.0)], 220.0),
        ("Saturated", vec![setpoint(175.0, 60.0), setpoint(182.0, 22.0), setpoint(230.0, 35.0)], 250.0),
    ];
    for (blocker, actions, begins) in cases {
        let record = run_with(vec![], actions, 480.0, 1);
        assert!(record.refused.is_empty());
        let seen = record.rows.iter().any(|r| r.tick.blocked.is_some_and(|b| format!("{b:?}") == blocker));
        assert!(seen, "{blocker} is said");
        let monitor =
            record.rows.iter().find(|r| r.tick.mode == Mode::Monitor).map(|r| record.time(r.tick.index));
        let latest = monitor.unwrap();
        assert!(
            (begins + 179.0..begins + 190.0).contains(&latest),
            "{blocker}: monitoring began at {latest}"
        );
    }
}

#[test]
fn a_missing_sample_is_skipped_and_the_window_made_longer() {
    let faults = vec![fault(Verb::Missing, Some(Sensor::T2), Some(0.2), 200.0, 60.0)];
    let record = run_with(faults, vec![], 400.0, 1);
    let baseline = record.baseline.unwrap();
    assert_eq!(baseline.samples, 1636);
    let monitor = record.rows.iter().find(|r| r.tick.mode == Mode::Monitor).unwrap();
    assert!((365.0..400.0).contains(&record.time(monitor.tick.index)));
}

#[test]
fn the_largest_setpoint_is_held_without_windup() {
    let to = |at, t| Action { at, setpoint: Some(t), ..Action::default() };
    let record = run_with(vec![], vec![to(60.0, 62.0), to(75.0, 35.0)], 115.0, 1);
    assert!(record.rows.iter().any(|r| r.tick.drive.0 == 100.0), "52.5 degC is all that it can");
    let settled = record.rows.iter().filter(|r| record.time(r.tick.index) > 80.0);
    let worst = settled.map(|r| (r.tick.sample.t1.celsius.0 - 35.0).abs()).fold(0.0, f32::max);
    assert!(worst < 2.5, "5 s after 15 s of saturation the error is {worst} degC");
}

/// Every verb does what it says to the codes, and the truth column says so.
#[test]
fn every_verb_acts() {
    use Sensor::{T0, T1, T2};
    let shift = |record: &Record, sensor: Sensor, from: f64, to: f64| {
        let rows = record.rows.iter().filter(|r| (from..to).contains(&record.time(r.tick.index)));
        let pick = |r: &pt326_host::experiment::Row| {
            [r.tick.sample.t0, r.tick.sample.t1, r.tick.sample.t2][sensor as usize].celsius.0
        };
        let values: Vec<f64> = rows.map(|r| f64::from(pick(r))).collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    let power = |record: &Record, from: f64, to: f64| {
        let rows = record.rows.iter().filter(|r| (from..to).contains(&record.time(r.tick.index)));
        let values: Vec<f64> = rows.map(|r| f64::from(r.tick.drive.0)).collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    let quiet = run_with(vec![], vec![], 90.0, 1);
    let of = |f: Fault| run_with(vec![f], vec![], 90.0, 1);
    let off = |s| of(fault(Verb::Offset, Some(s), Some(1.5), 60.0, 30.0));
    for s in [T0, T2] {
        assert!((shift(&off(s), s, 65.0, 90.0) - shift(&quiet, s, 65.0, 90.0) - 1.5).abs() < 0.1);
    }
    let drift = of(fault(Verb::Drift, Some(T2), Some(6.0), 60.0, 30.0));
    assert!((shift(&drift, T2, 80.0, 90.0) - shift(&quiet, T2, 80.0, 90.0) - 2.5).abs() < 0.15);
    // The loop compensates: power = rise / gain.
    let ratio = |f: Fault| power(&of(f), 65.0, 90.0) / power(&quiet, 65.0, 90.0);
    let clogged = ratio(Fault { lag: Some(0.4), ..fault(Verb::Clog, Some(T1), Some(0.85), 60.0, 30.0) });
    assert!((clogged - 1.0 / 0.85).abs() < 0.02, "{clogged}");
    assert!((ratio(fault(Verb::AirFlow, None, Some(1.26), 60.0, 30.0)) - 1.26).abs() < 0.02);
    assert!((ratio(fault(Verb::HeaterPower, None, Some(0.8), 60.0, 30.0)) - 1.25).abs() < 0.02);
    assert!((ratio(fault(Verb::Offset, Some(T1), Some(-1.5), 60.0, 30.0)) - 1.12).abs() < 0.02);
    let hot = of(fault(Verb::HeaterStuck, None, Some(80.0), 60.0, 30.0));
    assert!((shift(&hot, T1, 70.0, 90.0) - 46.5).abs() < 0.3 && power(&hot, 70.0, 90.0) < 5.2);
    let ambient = of(fault(Verb::Ambient, None, Some(2.0), 60.0, 30.0));
    assert!((shift(&ambient, T0, 70.0, 90.0) - 24.5).abs() < 0.2);
    let warming = of(fault(Verb::AmbientDrift, None, Some(6.0), 60.0, 30.0));
    assert!((shift(&warming, T0, 80.0, 90.0) - shift(&quiet, T0, 80.0, 90.0) - 2.5).abs() < 0.2);
    for (verb, sensor, truth) in
        [(Verb::Offset, T2, 1), (Verb::Clog, T1, 2), (Verb::Offset, T1, 5), (Verb::Open, T0, 13)]
    {
        let size = matches!(verb, Verb::Offset | Verb::Clog).then_some(1.0);
        let record = of(fault(verb, Some(sensor), size, 60.0, 10.0));
        assert_eq!(record.rows.iter().map(|r| r.truth).max(), Some(truth), "{verb:?} {sensor:?}");
    }
}

/// A second half that lags still reports the count of an earlier baseline: learning must not end by it.
#[test]
fn a_stale_count_does_not_end_learning() {
    struct Stale(Controller, ControllerState);
    impl Backend for Stale {
        fn control(&mut self, raw: RawSample) -> Tick {
            self.0.step(&mut self.1, raw)
        }
        fn diagnose(&mut self, _: &Tick) -> Report {
            self.0.feed_back(&mut self.1, Feedback { learned: u32::MAX, ..Feedback::default() });
            Report::default()
        }
        fn command(&mut self, command: Command) -> Result<(), String> {
            self.0.command(&mut self.1, command).map_err(|refusal| refusal.to_string())
        }
        fn baseline(&self) -> Option<Baseline> {
            None
        }
    }
    let config = Config::default();
    let controller = Controller::new(&config).unwrap();
    let mut backend = Stale(controller, controller.start(config.setpoint));
    let scenario = Scenario { duration: 400.0, faults: vec![], ..Scenario::default() };
    let record = run_on(&mut backend, &config, &scenario, 1);
    let monitor = record.rows.iter().find(|r| r.tick.mode == Mode::Monitor).unwrap();
    assert!((360.0..361.0).contains(&record.time(monitor.tick.index)));
}

/// A restored baseline: monitoring begins once in regulation, with the thresholds as they were.
#[test]
fn a_restored_baseline_spares_the_learning() {
    let config = Config::default();
    let learnt = run_with(vec![], vec![], 400.0, 1).baseline.unwrap();
    let mut instrument = Instrument::new(&config).unwrap();
    instrument.restore(&learnt).unwrap();
    let faults = vec![fault(Verb::Offset, Some(Sensor::T2), Some(1.5), 60.0, 20.0)];
    let scenario = Scenario { duration: 120.0, faults, ..Scenario::default() };
    let record = run_on(&mut instrument, &config, &scenario, 2);
    let monitor = record.rows.iter().find(|r| r.tick.mode == Mode::Monitor).unwrap();
    assert!((20.0..40.0).contains(&record.time(monitor.tick.index)));
    assert_eq!(record.baseline, Some(learnt));
    let seen = record.rows.iter().find(|r| r.report.filtered.is_some_and(|v| v.fdv != 0)).unwrap();
    assert!((60.0..63.0).contains(&record.time(seen.tick.index)), "{}", record.time(seen.tick.index));

    let mut nonsense = learnt;
    nonsense.filtered.sigma[2] = f32::NAN;
    let error = Instrument::new(&config).unwrap().restore(&nonsense).unwrap_err();
    assert!(error.to_string().contains("baseline.sigma"), "{error}");
}

/// The same seed gives the same run; another one does not.
#[test]
fn a_seed_is_a_run() {
    let drives = |seed| {
        run_with(vec![], vec![], 30.0, seed).rows.iter().map(|r| r.tick.drive.0.to_bits()).collect::<Vec<_>>()
    };
    assert_eq!(drives(1), drives(1));
    assert_ne!(drives(1), drives(2));
}

/// A whole closed loop with the Kalman form finds the rig's gain and bandwidth as well.
#[test]
fn random_walk_identifies_the_rig() {
    let mut config = Config::default();
    config.identification.adaptation = Adaptation::RandomWalk { r1: 1e-5, r2: 0.0064 };
    let scenario = pt326_host::experiment::scenario::Scenario { duration: 200.0, ..Default::default() };
    let record = pt326_host::experiment::run(&config, &scenario, 1).unwrap();
    let last = &record.rows.last().unwrap().report;
    let (gain, bandwidth) = (last.ms1.static_gain.unwrap(), last.ms1.bandwidth.unwrap());
    assert!((gain - 0.3).abs() < 0.006, "gain {gain}");
    assert!((bandwidth - 2.0).abs() < 0.3, "bandwidth {bandwidth}");
    assert!(!record.rows.iter().any(|row| row.report.ms1.diverged || row.report.ms2.diverged));
    let mut instrument = Instrument::new(&config).unwrap();
    assert!(instrument.command(Command::Arm).is_ok());
}
