//! A trace.csv as a recording; how it is read is told in `pt326_lab::recording`.

use std::path::Path;

use fdi_core::Config;
use pt326_lab::recording::{Asked, Recording as Trace};

use super::{Change, Recorded, Recording, Said};
use pt326_host::experiment::{as_written, truth};
use pt326_host::record::summary;
use pt326_rig::fault::Fault;

/// Reads a trace.
///
/// # Errors
/// A column without which it can't be replayed, or a bad cell, by line and column.
pub(super) fn read(text: &str, config: &Config) -> anyhow::Result<Recording> {
    let trace = Trace::read(text, config)?;
    let mut remarks = Vec::new();
    if !trace.lacks.is_empty() {
        remarks.push(format!("the trace has no column {}, which is not compared", trace.lacks.join(", ")));
    }
    let order = |asked: &Asked| match asked {
        Asked::Command(command) => Change::Command(*command),
        Asked::Settings(config) => Change::Settings(config.clone()),
    };
    let ticks = trace.rows.iter().map(|row| Recorded {
        orders: row.asked.iter().map(order).collect(),
        raw: row.raw,
        applied: None,
        truth: row.truth,
        said: Said::Cells(trace.cells(row).map(|(column, cell)| (column, cell.to_owned())).collect()),
    });
    let ticks: Vec<Recorded> = ticks.collect();
    let faults = faults(&ticks, as_written(trace.config.sample_time.0));
    Ok(Recording { config: trace.config, baseline: None, ticks, faults, remarks })
}

/// The true faults as far as the column `truth` knows them: from tick to tick, and without a size.
fn faults(ticks: &[Recorded], sample_time: f64) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut from = 0;
    for run in ticks.chunk_by(|a, b| a.truth == b.truth) {
        let (at, duration) = (from as f64 * sample_time, run.len() as f64 * sample_time);
        faults.extend(Fault::from_truth(run[0].truth, at, duration));
        from += run.len();
    }
    faults
}

/// Takes onsets and sizes of the faults from the summary.json beside a trace, if it is one of the same run, so that delays
/// are those of that run; else says that they are known to a tick only.
pub(super) fn use_summary(recording: &mut Recording, file: &Path) {
    if recording.faults.is_empty() {
        return;
    }
    let json = std::fs::read_to_string(file.with_file_name("summary.json"));
    let exact = json.ok().and_then(|json| summary::faults_in(&json));
    let sample_time = as_written(recording.config.sample_time.0);
    let is_of_this_run = |faults: &Vec<Fault>| {
        let mut ticks = recording.ticks.iter().enumerate();
        ticks.all(|(i, tick)| truth(faults, i as f64 * sample_time) == tick.truth)
    };
    match exact.filter(is_of_this_run) {
        Some(faults) => recording.faults = faults,
        None => recording.remarks.push(
            "no summary.json of this run beside the trace: sizes of the faults are not known, onsets to a tick only".into(),
        ),
    }
}

#[cfg(test)]
mod tests {
    use pt326_lab::scene::{Order as Do, Scene};
    use pt326_lab::session::Session;
    use pt326_lab::trace::SETTINGS;
    use pt326_rig::fault::{Sensor, Verb};

    use super::*;

    /// Ticks of the replay of a session's trace, and what differs, where anything does.
    fn replayed(session: &Session) -> (usize, Option<String>) {
        let text = session.trace().unwrap().collect::<Vec<_>>().join("\n");
        let recording = read(&text, &Config::default()).unwrap();
        let (record, agreement) =
            super::super::rerun(&recording, Path::new("trace.csv"), |_, _, _| ()).unwrap();
        let mut again = Vec::new();
        pt326_host::record::trace::write_trace(&record, &mut again).unwrap();
        assert_eq!(told(&text), told(&String::from_utf8(again).unwrap()));
        (agreement.ticks, (agreement.differing > 0).then(|| agreement.to_string()))
    }

    /// The cells of the column `settings`; none where there is no such column.
    fn told(text: &str) -> Vec<&str> {
        let place = text.lines().next().unwrap().split(',').position(|name| name == SETTINGS);
        place.map_or(Vec::new(), |i| text.lines().skip(1).map(|l| l.split(',').nth(i).unwrap()).collect())
    }

    fn set(name: &str, value: f32) -> Do {
        Do::Set { name: name.into(), value }
    }

    /// Settings that are changed in the middle of a run are told by its trace, and so are those that it began with, seed and preset.
    #[test]
    fn settings_are_found_again() {
        for (preset, seed) in [("paper", 7), ("oven", 1), ("hotend", 2), ("tclab", 3)] {
            let mut session =
                Session::new(Scene { preset: preset.into(), seed, ..Scene::default() }).unwrap();
            session.order(set("pid.td", 0.1)).unwrap();
            for orders in [
                vec![set("pid.kp", 2.0), set("pid.ti", 0.7)],
                vec![set("prbs.amplitude", 0.0), set("diagnosis.sigma_factor", 4.0)],
                vec![Do::Setpoint { celsius: 36.5 }, set("sensors.t1.beta", 3900.0)],
                vec![set("prbs.amplitude", 3.0), Do::Stop],
            ] {
                (0..60).for_each(|_| drop(session.step()));
                orders.into_iter().for_each(|order| session.order(order).unwrap());
            }
            (0..60).for_each(|_| drop(session.step()));
            assert_eq!(replayed(&session), (300, None), "{preset}");
            let text = session.trace().unwrap().collect::<Vec<_>>().join("\n");
            assert!(told(&text).iter().filter(|cell| !cell.is_empty()).count() >= 4, "{preset}");
        }
    }

    /// An experiment for PID settings ends by itself, or is stopped.
    #[test]
    fn an_experiment_is_found_again() {
        for stopped in [false, true] {
            let mut session = Session::new(Scene { orders: Vec::new(), ..Scene::default() }).unwrap();
            session.order(Do::Tune).unwrap();
            let tunes = |session: &mut Session| session.step().tick.mode == fdi_core::Mode::Tune;
            if stopped {
                assert!((0..100).all(|_| tunes(&mut session)));
                session.order(Do::Stop).unwrap();
            } else {
                assert!((0..6000).any(|_| !tunes(&mut session)));
            }
            (0..100).for_each(|_| drop(session.step()));
            session.order(Do::Arm).unwrap();
            (0..100).for_each(|_| drop(session.step()));
            assert_eq!(replayed(&session).1, None, "stopped {stopped}");
        }
    }

    /// What is said of an alarm makes it advice, and is found again from its own column.
    #[test]
    fn what_is_acknowledged_and_shelved_is_found_again() {
        let mut session = Session::new(Scene::default()).unwrap();
        (0..4000).for_each(|_| drop(session.step()));
        let wrong = |size| Fault::new(Verb::Offset, Some(Sensor::T2), Some(size), 0.0, 200.0);
        let advice = |session: &mut Session, order: Do| {
            session.order(order).unwrap();
            (0..100).for_each(|_| drop(session.step()));
            let said = session.step().report.likelihood;
            (said.alarm, said.advice)
        };
        assert_eq!(advice(&mut session, Do::Break { fault: wrong(2.0) }), (true, false));
        assert_eq!(advice(&mut session, Do::Acknowledge), (true, true));
        assert_eq!(advice(&mut session, Do::Mend), (false, false));
        (0..2500).for_each(|_| drop(session.step())); // three within minutes would be a loose contact
        assert_eq!(advice(&mut session, Do::Break { fault: wrong(2.0) }), (true, false), "it came again");
        assert_eq!(advice(&mut session, Do::Shelve { seconds: 3600.0 }), (true, true));
        assert_eq!(advice(&mut session, Do::Mend), (false, false));
        assert_eq!(advice(&mut session, Do::Break { fault: wrong(2.0) }), (true, true), "still shelved");
        assert_eq!(advice(&mut session, Do::Shelve { seconds: 0.0 }), (true, false));
        assert_eq!(replayed(&session).1, None);
    }

    /// A session in which the user stops, arms, acknowledges a trip: what was asked for is found again from its trace.
    #[test]
    fn what_the_user_did_is_found_again() {
        let mut session = Session::new(Scene::default()).unwrap();
        let broken = Fault::new(Verb::Open, Some(Sensor::T1), None, 0.0, 1.0);
        for order in [
            Do::Setpoint { celsius: 36.0 },
            Do::Stop,
            Do::Arm,
            Do::Break { fault: broken },
            Do::Acknowledge,
            Do::Arm,
        ] {
            (0..50).for_each(|_| drop(session.step()));
            session.order(order).unwrap();
        }
        (0..50).for_each(|_| drop(session.step()));
        assert_eq!(replayed(&session), (350, None));
    }
}
