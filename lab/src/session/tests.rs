use pt326_rig::fault::{Sensor, Verb};

use super::*;
use crate::protocol::read;
use crate::recording::Recording;

fn place(name: &str) -> usize {
    schema::field(name).unwrap()
}

/// A session that monitors.
fn monitoring() -> Session {
    let mut session = Session::new(Scene::default()).unwrap();
    while session.step().tick.mode != fdi_core::Mode::Monitor {}
    (0..100).for_each(|_| drop(session.step()));
    session
}

fn offset() -> Order {
    Order::Break { fault: Fault::new(Verb::Offset, Some(Sensor::T2), Some(1.5), 0.0, 25.0) }
}

#[test]
fn a_fault_that_is_put_in_is_named_and_explained() {
    let mut session = monitoring();
    session.order(offset()).unwrap();
    let row = (0..40).map(|_| session.step()).last().unwrap();
    let last = session.numbers(&row);
    assert_eq!(last[place("class")], 2.0, "t2_offset");
    assert_eq!(last[place("truth")], 1.0);
    let [right, wrong] = ["x_t2_offset", "x_t1_offset"].map(|name| last[place(name)]);
    assert!(right > 0.8 && wrong < 0.8 * right, "{right} {wrong}");
    assert!((last[place("t2")] - last[place("t2_expected")] - 1.5).abs() < 0.4);
    session.order(Order::Mend).unwrap();
    assert_eq!(session.step().truth, 0);
}

/// Whatever the rig, with the settings that belong to it the session comes to monitor.
#[test]
fn every_preset_monitors_after_its_own_time() {
    for (preset, sample_time) in [
        ("trainer", 0.11),
        ("harsh", 0.11),
        ("recorded", 0.11),
        ("oven", 2.0),
        ("hotend", 0.5),
        ("tclab", 5.0),
    ] {
        let mut session = Session::new(Scene { preset: preset.into(), ..Scene::default() }).unwrap();
        assert_eq!(session.sample_time(), sample_time, "{preset}");
        let monitors = (0..4000).any(|_| session.step().tick.mode == fdi_core::Mode::Monitor);
        assert!(monitors, "{preset}");
    }
}

/// The trace of a session is that of its scene, whenever it is asked for, orders and all.
#[test]
fn a_scene_leads_to_the_same_bits_again() {
    let mut session = Session::new(Scene { seed: 5, ..Scene::default() }).unwrap();
    let mut lines = vec![header(COLUMNS.iter()) + ",settings"];
    let mut step = |session: &mut Session| {
        let row = session.step();
        let mut line = String::new();
        let on = Moment { truth: row.truth, ..Moment::new(&row.tick, &row.report) };
        append_cells(&mut line, COLUMNS.iter(), &on, 0.11);
        lines.push(line + "," + &row.settings);
    };
    (0..300).for_each(|_| step(&mut session));
    session.order(Order::Setpoint { celsius: 38.0 }).unwrap();
    session.order(offset()).unwrap();
    session.order(Order::Set { name: "pid.kp".into(), value: 2.0 }).unwrap();
    (0..300).for_each(|_| step(&mut session));
    session.order(Order::Mend).unwrap();
    session.order(Order::Stop).unwrap();
    (0..50).for_each(|_| step(&mut session));
    let told: Vec<_> =
        lines.iter().filter_map(|line| line.rsplit(',').next().filter(|c| c.contains('='))).collect();
    assert!(told[0].starts_with("prbs.start=") && told[1..] == ["pid.kp=2"], "{told:?}");
    let text = serde_json::to_string(&session.scene()).unwrap();
    let mut again = Session::new(read(text.as_bytes()).unwrap()).unwrap();
    (0..650).for_each(|_| drop(again.step()));
    assert!(again.trace().unwrap().eq(lines.iter().cloned()));
    assert!(session.trace().unwrap().eq(lines));
}

/// What a trace does not tell is had again from it, to the bit; one that was changed is not taken for its own.
#[test]
fn a_trace_gives_all_numbers_again() {
    let mut session = Session::new(Scene { seed: 3, preset: "trainer".into(), ..Scene::default() }).unwrap();
    let mut rows = Vec::new();
    for tick in 0..3500 {
        match tick {
            3350 => session.order(offset()).unwrap(),
            3400 => session.order(Order::Set { name: "diagnosis.sigma_factor".into(), value: 4.0 }).unwrap(),
            _ => {}
        }
        let row = session.step();
        rows.push(session.numbers(&row).map(f32::to_bits));
    }
    let text = session.trace().unwrap().collect::<Vec<_>>().join("\n");
    let again = Recording::read(&text, &Config::default()).unwrap().numbers().unwrap();
    let again: Vec<_> = again.into_iter().map(|row| row.map(f32::to_bits)).collect();
    let shares = place("x_t2_offset");
    assert!(again == rows && rows[3390][shares] != f32::NAN.to_bits());
    let line = text.lines().nth(2000).unwrap();
    let drive = line.split(',').nth(7).unwrap();
    let changed = text.replacen(line, &line.replacen(drive, "12.5", 1), 1);
    let error = Recording::read(&changed, &Config::default()).unwrap().numbers().unwrap_err().to_string();
    assert!(error.starts_with("219.89 s, pa_pct: trace \"12.5\""), "{error}");
}

#[test]
fn what_cannot_be_is_refused_and_changes_nothing() {
    let mut session = monitoring();
    let before = session.scene();
    let fault = Fault { size: Some(1e9), ..Fault::new(Verb::Offset, Some(Sensor::T2), None, 0.0, 25.0) };
    for (order, words, code) in [
        (Order::Setpoint { celsius: 500.0 }, "set-point 500", "setpoint"),
        (Order::Fan { percent: -1.0 }, "fan level -1", "fan"),
        (Order::Arm, "not possible in mode monitor", "mode"),
        (Order::Set { name: "pid.kp".into(), value: -1.0 }, "pid.kp is -1", "range"),
        (Order::Set { name: "sample_time".into(), value: 1.0 }, "sample_time", "setting"),
        (
            Order::Set { name: "supervisor.over_temperature".into(), value: 90.0 },
            "can't be widened",
            "widens",
        ),
        (Order::Break { fault }, "size is 1000000000", ""),
    ] {
        let refusal = crate::refusal::message(&session.order(order).unwrap_err());
        assert!(refusal["why"].as_str().unwrap().contains(words), "{refusal}");
        assert_eq!(refusal["code"].as_str().unwrap_or(""), code, "{refusal}");
    }
    assert_eq!(session.scene(), before);
    let scene = |text: &str| Session::new(read(text.as_bytes())?).map(drop);
    for (text, words) in [
        (r#"{"preset":"kettle"}"#, "kettle"),
        (r#"{"orders":[[5,{"order":"arm"}],[4,{"order":"stop"}]]}"#, "order of time"),
        (r#"{"orders":[[0,{"order":"melt"}]]}"#, "melt"),
    ] {
        let error = format!("{:#}", scene(text).unwrap_err());
        assert!(error.contains(words), "{error}");
    }
}
