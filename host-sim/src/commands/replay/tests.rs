use pt326_rig::fault;

use super::*;
use pt326_host::experiment::scenario::{Action, Scenario};
use pt326_host::record::trace::write_trace;

fn traced(scenario: &Scenario, seed: u64) -> String {
    traced_with(&Config::default(), scenario, seed)
}

fn traced_with(config: &Config, scenario: &Scenario, seed: u64) -> String {
    let record = pt326_host::experiment::run(config, scenario, seed).unwrap();
    let mut trace = Vec::new();
    write_trace(&record, &mut trace).unwrap();
    String::from_utf8(trace).unwrap()
}

fn args(seed: u64) -> ReplayArgs {
    ReplayArgs { file: "nowhere".into(), config: None, seed: Some(seed), out: "nowhere".into() }
}

fn agreement(text: &str, seed: u64) -> Agreement {
    let recording = read(text, &args(seed)).unwrap();
    rerun(&recording, Path::new("test"), |_, _, _| ()).unwrap().1
}

#[test]
fn a_trace_replays_to_the_same_bits() {
    let action = |at, setpoint, excite| Action { at, setpoint, excite, ..Action::default() };
    let scenario = Scenario {
        duration: 450.0,
        actions: vec![
            action(420.0, Some(38.0), None),
            Action { at: 425.0, fan: Some(90.0), ..Action::default() },
            Action { at: 430.0, relearn: true, ..Action::default() },
            action(440.0, None, Some(false)),
        ],
        ..Scenario::default()
    };
    for seed in [1, 9] {
        let agreement = agreement(&traced(&scenario, seed), seed);
        assert_eq!(
            (agreement.ticks, agreement.differing),
            (4090, 0),
            "seed {seed}: {:?}",
            agreement.examples
        );
    }
}

#[test]
fn a_trace_with_a_measured_supply_replays_to_the_same_bits() {
    let mut config = Config::default();
    config.supply.nominal_voltage.0 = 12.0;
    let mut scenario = Scenario { duration: 450.0, ..Scenario::default() };
    (scenario.rig.mains.steps, scenario.rig.mains.measured_code) = (60.0, 2978.0);
    let trace = traced_with(&config, &scenario, 1);
    let recording = trace_file::read(&trace, &config).unwrap();
    let (_, agreement) = rerun(&recording, Path::new("test"), |_, _, _| ()).unwrap();
    assert_eq!((agreement.ticks, agreement.differing), (4090, 0), "{:?}", agreement.examples);
}

/// What was taught is told by the trace: it replays without the settings that it was made with.
#[test]
fn a_trace_tells_what_was_taught() {
    let told = "diagnosis.isolation.4=4 0 +1 0 -1 x hand;likelihood.taught.1=cap 0 0 0 0 150 0 0 0 0 0 0";
    let mut config = Config::default();
    pt326_lab::change::apply(&mut config, told).unwrap();
    let high = fault::Fault::new(fault::Verb::Offset, Some(fault::Sensor::T2), Some(1.5), 400.0, 20.0);
    let scenario = Scenario { duration: 420.0, faults: vec![high], ..Scenario::default() };
    let trace = traced_with(&config, &scenario, 1);
    let recording = read(&trace, &args(1)).unwrap();
    assert_eq!(recording.config, config);
    let (record, agreement) = rerun(&recording, Path::new("test"), |_, _, _| ()).unwrap();
    assert_eq!(agreement.differing, 0, "{:?}", agreement.examples);
    assert_eq!(record.names.taught, ["cap"]);
    assert!(record.rows.iter().any(|row| row.report.likelihood.taught.is_some()), "it is seen");
}

#[test]
fn columns_are_found_by_name() {
    let trace = traced(&Scenario { duration: 20.0, ..Scenario::default() }, 1);
    let turned = |line: &str| {
        let (first, rest) = line.split_once(',').unwrap();
        let rest: Vec<&str> = rest.split(',').rev().collect();
        format!("{first},{},7\n", rest.join(","))
    };
    let turned: String = trace.lines().map(turned).collect();
    let agreement = agreement(&turned, 1);
    assert_eq!((agreement.ticks, agreement.differing), (181, 0), "{:?}", agreement.examples);
    let Err(error) = read(&trace.replace("mode", "node"), &args(1)) else { panic!("no mode") };
    assert!(format!("{error:#}").contains("column mode"), "{error:#}");
}

#[test]
fn one_changed_number_is_found_and_told() {
    let scenario = Scenario { duration: 60.0, ..Scenario::default() };
    let trace = traced(&scenario, 1);
    let line = trace.lines().nth(400).unwrap();
    let drive = line.split(',').nth(7).unwrap();
    let changed = line.replacen(drive, "12.5", 1);
    let agreement = agreement(&trace.replacen(line, &changed, 1), 1);
    assert_eq!(agreement.differing, 1);
    assert!(agreement.examples[0].contains("pa_pct") && agreement.examples[0].contains("12.5"));
}

#[test]
fn an_older_trace_replays_without_the_likelihood_columns_and_a_changed_one_is_found() {
    let scenario = Scenario { duration: 20.0, ..Scenario::default() };
    let trace = traced(&scenario, 1);
    let older: Vec<String> =
        trace.lines().map(|line| line.split(',').take(40).collect::<Vec<_>>().join(",")).collect();
    let replayed = agreement(&older.join("\n"), 1);
    assert_eq!((replayed.ticks, replayed.differing), (181, 0), "{:?}", replayed.examples);
    let remarks = read(&older.join("\n"), &args(1)).unwrap().remarks;
    assert!(remarks[0].contains("alarm, verdict") && remarks[0].contains("not compared"), "{remarks:?}");
    let line = trace.lines().nth(100).unwrap();
    let mut cells: Vec<&str> = line.split(',').collect();
    assert_eq!((trace.lines().next().unwrap().split(',').nth(40), cells[40]), (Some("alarm"), "0"));
    cells[40] = "1";
    let replayed = agreement(&trace.replacen(line, &cells.join(","), 1), 1);
    assert_eq!(replayed.differing, 1);
    assert!(replayed.examples[0].contains("alarm"), "{:?}", replayed.examples);
}

/// A log as the board writes it: made from a run, with what a terminal puts around each line.
#[test]
fn a_board_log_replays_to_the_same_bits_and_shows_gaps() {
    let log = board_log::tests::log_of(&Config::default(), 60.0);
    let whole = agreement(&log, 1);
    assert_eq!((whole.ticks, whole.differing), (545, 0), "{:?}", whole.examples);
    let gapped: Vec<&str> = log.lines().filter(|line| !line.contains(" tick 64 ")).collect(); // tick 100
    let recording = read(&gapped.join("\n"), &args(1)).unwrap();
    assert_eq!(recording.ticks.len(), 100);
    assert!(recording.remarks[0].contains("100"), "{:?}", recording.remarks);
    assert!(read("no log at all\n", &args(1)).is_err());
}

#[test]
fn names_are_those_that_a_board_has_in_the_end() {
    let log = board_log::tests::log_of(&Config::default(), 60.0);
    let taught = "22.0 [INFO ] setting pid.kp = 3 %/degC\n\
        22.0 [INFO ] setting likelihood.taught.1 = cap 0 0 0 0 150 -150 0 0 0 0 0\n";
    let log = log.replacen("22.0 [INFO ] setting pid.kp = 3 %/degC\n", taught, 1);
    let recording = read(&log, &args(1)).unwrap();
    let (record, agreement) = rerun(&recording, Path::new("test"), |_, _, _| ()).unwrap();
    assert_eq!((record.names.taught, agreement.differing), (vec!["cap".to_owned()], 0));
}
