//! Modes, commands, trips and events, without a rig: codes made by hand.

use fdi_core::control::Controller;
use fdi_core::diagnosis::event::{Event, EventRules, EventState};
use fdi_core::diagnosis::signature::{PAPER_DETECTION, PAPER_ISOLATION, Pattern, Symptom, Symptoms, Table};
use fdi_core::{
    AdcCode, Celsius, Command, Config, ConfigError, Feedback, Instrument, Mode, Percent, RawSample, Refusal,
    RetuneError, TripReason, Validity,
};

pub(crate) const AMBIENT: f32 = 2160.0;

pub(crate) fn armed() -> Instrument {
    let mut instrument = Instrument::new(&Config::default()).unwrap();
    instrument.command(Command::Arm).unwrap();
    instrument
}

/// One tick at the code given for T1, which T2 shares unless it is a broken wire's, with a count of flicker so that nothing looks stuck.
pub(crate) fn tick(instrument: &mut Instrument, t1: f32, k: usize) -> fdi_core::Tick {
    let flicker = (k % 2) as f32;
    let raw = RawSample {
        t0: AdcCode(AMBIENT + flicker),
        t1: AdcCode(t1 + flicker),
        t2: AdcCode(if t1 < 4000.0 { t1 } else { AMBIENT } + flicker),
        ..RawSample::default()
    };
    let tick = instrument.control(raw);
    instrument.diagnose(&tick, tick.drive);
    tick
}

#[test]
fn nothing_heats_before_it_is_armed() {
    let mut instrument = Instrument::new(&Config::default()).unwrap();
    for k in 0..20 {
        let tick = tick(&mut instrument, AMBIENT, k);
        assert!(tick.drive.0 == 0.0 && tick.mode == Mode::Off);
    }
    instrument.command(Command::Arm).unwrap();
    assert!(tick(&mut instrument, AMBIENT, 0).mode.is_heating());
}

/// The same code again and again, near the set-point, where the power is excited.
#[test]
fn a_t1_that_does_not_change_at_all_trips_while_it_heats() {
    let mut instrument = armed();
    let trip = (0..60).find_map(|_| match tick(&mut instrument, 1617.0, 0).mode {
        Mode::Tripped(trip) => Some(trip),
        _ => None,
    });
    assert_eq!(trip.map(|trip| trip.reason), Some(TripReason::T1Stuck));
}

#[test]
fn a_trip_latches_until_acknowledged_after_its_cause_has_gone() {
    let mut instrument = armed();
    for k in 0..8 {
        tick(&mut instrument, AMBIENT, k);
    }
    let tripped = tick(&mut instrument, 4094.0, 0);
    let Mode::Tripped(trip) = tripped.mode else { panic!("{:?}", tripped.mode) };
    assert_eq!((trip.reason, tripped.drive.0), (TripReason::T1Open, 0.0));
    assert_eq!((trip.raw.t1, trip.tick, trip.sample.t1.validity), (AdcCode(4094.0), 8, Validity::Open));

    let persists = Err(Refusal::CausePersists(TripReason::T1Open));
    assert_eq!(instrument.command(Command::Acknowledge), persists);
    tick(&mut instrument, AMBIENT, 0);
    assert!(
        matches!(tick(&mut instrument, AMBIENT, 1).mode, Mode::Tripped(_)),
        "the cause has gone, the trip has not"
    );
    assert_eq!(instrument.command(Command::Arm), Err(Refusal::NotInMode("tripped")));
    assert_eq!(instrument.command(Command::Stop), Ok(()));
    assert!(matches!(tick(&mut instrument, AMBIENT, 0).mode, Mode::Tripped(_)), "stop does not acknowledge");
    instrument.command(Command::Acknowledge).unwrap();
    assert_eq!(tick(&mut instrument, AMBIENT, 1).mode, Mode::Off);
    instrument.command(Command::Arm).unwrap();
    let again = tick(&mut instrument, AMBIENT, 0);
    assert!(again.mode.is_heating() && again.pid.0 < 10.0, "it begins anew, from nothing: {}", again.pid);
}

/// The diagnosis says what it found; that lost air trips, and that a heater which gives more than it is asked for only looks
/// like it, is decided by the supervisor.
#[test]
fn lost_air_trips_unless_the_heater_is_to_blame() {
    let tripped = |found: Feedback| {
        let controller = Controller::new(&Config::default()).unwrap();
        let mut state = controller.start(Celsius(35.0));
        controller.command(&mut state, Command::Arm).unwrap();
        let room = AdcCode(AMBIENT);
        let _ =
            controller.step(&mut state, RawSample { t0: room, t1: room, t2: room, ..RawSample::default() });
        controller.feed_back(&mut state, found);
        match controller
            .step(&mut state, RawSample { t0: room, t1: room, t2: room, ..RawSample::default() })
            .mode
        {
            Mode::Tripped(trip) => Some(trip.reason),
            _ => None,
        }
    };
    let little = Feedback { air_flow: Some(Percent(20.0)), ..Feedback::default() };
    assert_eq!(tripped(little), Some(TripReason::AirFlowLost));
    assert_eq!(tripped(Feedback { heater_faulty: true, ..little }), None);
    assert_eq!(tripped(Feedback { air_flow: Some(Percent(80.0)), ..little }), None);
    let stuck_on = Feedback { heater_stuck_on: true, heater_faulty: true, ..little };
    assert_eq!(tripped(stuck_on), Some(TripReason::HeaterStuckOn));
}

#[test]
fn arming_onto_a_broken_t1_is_refused() {
    let mut instrument = Instrument::new(&Config::default()).unwrap();
    tick(&mut instrument, 10.0, 0);
    assert_eq!(instrument.command(Command::Arm), Err(Refusal::CausePersists(TripReason::T1Short)));
}

#[test]
fn stop_works_in_every_mode() {
    let mut instrument = armed();
    tick(&mut instrument, AMBIENT, 0);
    instrument.command(Command::Stop).unwrap();
    let stopped = tick(&mut instrument, AMBIENT, 1);
    assert!(stopped.mode == Mode::Off && stopped.drive.0 == 0.0);
    instrument.command(Command::Stop).unwrap();
}

#[test]
fn set_points_are_bounded_by_number() {
    let mut instrument = armed();
    for wanted in [19.9, 65.1, f32::NAN, f32::INFINITY] {
        let refused = instrument.command(Command::SetPoint(Celsius(wanted))).unwrap_err();
        assert!(refused.to_string().contains("expected 20 to 65"), "{refused}");
    }
    instrument.command(Command::SetPoint(Celsius(40.0))).unwrap();
    assert_eq!(tick(&mut instrument, AMBIENT, 0).setpoint, Celsius(40.0));
}

#[test]
fn a_loose_contact_fails_the_rate_check_and_trips() {
    let mut instrument = armed();
    let mut last = None;
    for k in 0..40 {
        let jump = if k % 3 == 0 { -700.0 } else { 0.0 };
        last = Some(tick(&mut instrument, 1620.0 + jump, k));
    }
    let Some(Mode::Tripped(trip)) = last.map(|t| t.mode) else { panic!("{last:?}") };
    assert_eq!(trip.reason, TripReason::T1Lost);
}

#[test]
fn a_single_spike_is_withheld_and_a_step_is_believed_at_once_after() {
    let mut instrument = armed();
    let validity = |instrument: &mut Instrument, code| tick(instrument, code, 0).sample.t1.validity;
    for _ in 0..5 {
        assert_eq!(validity(&mut instrument, 1620.0), Validity::Good);
    }
    assert_eq!(validity(&mut instrument, 1200.0), Validity::Spike);
    for _ in 0..8 {
        assert_eq!(validity(&mut instrument, 1620.0), Validity::Good);
    }
    assert_eq!(validity(&mut instrument, 1200.0), Validity::Spike);
    assert_eq!(validity(&mut instrument, 1200.0), Validity::Good, "it was a step");
}

#[test]
fn the_papers_tables_say_what_the_paper_says() {
    let symptoms = |text: &str| -> Symptoms {
        let mut words = text.split(' ').map(|w| match w {
            "-1" => Symptom::Low,
            "+1" => Symptom::High,
            _ => Symptom::Normal,
        });
        std::array::from_fn(|_| words.next().unwrap())
    };
    let cases = [
        ("0 0 0 0 0", 0, 0),
        ("0 -1 0 +1 0", 1, 1),
        ("+1 -1 -1 0 -1", 2, 2),
        ("+1 0 -1 -1 +1", 2, 3),
        ("+1 0 -1 -1 -1", 2, 0), // the early phase of MFP: no row
        ("+1 -1 -1 +1 0", 2, 0), // both rows of fdv match: 2 wins
        ("0 +1 0 -1 0", 0, 0),   // T2 reading low: the paper is blind
    ];
    for (text, fdv, fiv) in cases {
        let s = symptoms(text);
        assert_eq!(
            [&PAPER_DETECTION[..], &PAPER_ISOLATION].map(|rows| Table::new(rows).look_up(&s)),
            [[fdv, 0], [fiv, 0]],
            "{text}"
        );
    }
}

#[test]
fn ambiguous_and_unnumbered_tables_are_refused() {
    let mut config = Config::default();
    config.diagnosis.isolation[2].pattern = "+1 x -1 x x".parse::<Pattern>().unwrap();
    let error = Instrument::new(&config).unwrap_err();
    assert_eq!(error, ConfigError::AmbiguousRows { name: "diagnosis.isolation", first: 1, second: 2 });
    let mut config = Config::default();
    config.diagnosis.detection[0].number = 0;
    assert!(Instrument::new(&config).unwrap_err().to_string().contains("diagnosis.detection"));
    for bad in ["", "x x x x", "x x x x x x", "x -1 2 x x"] {
        assert!(bad.parse::<Pattern>().is_err(), "{bad:?}");
    }
}

#[test]
fn events_tell_onset_detection_isolation_and_end() {
    let rules = EventRules { onset_window: 45, clear_ticks: 10 };
    let mut state = EventState::default();
    let normal: Symptoms = [Symptom::Normal; 5];
    let mut early = normal;
    early[1] = Symptom::Low;
    let mut full = early;
    full[3] = Symptom::High;
    let mut seen = Vec::new();
    for k in 0..200u32 {
        let (symptoms, fdv, fiv) = match k {
            100..103 => (early, 0, 0),
            103..105 => (full, 1, 0),
            105..120 => (full, 1, 1),
            120..125 => (normal, 0, 0), // flicker, shorter than the clearing time
            125..150 => (full, 1, 1),
            _ => (normal, 0, 0),
        };
        seen.extend(rules.step(&mut state, k, &symptoms, fdv, fiv).into_iter().map(|e| (k, e)));
    }
    let [(103, Event::Detected(a)), (105, Event::Isolated(b)), (160, Event::Ended(c))] = seen[..] else {
        panic!("{seen:#?}")
    };
    assert_eq!((a.onset, a.detected, a.isolated), (100, 103, None));
    assert_eq!((b.isolation_number, b.isolated), (1, Some(105)));
    assert_eq!((c.last_seen, c.duration(), c.detection_number), (149, 47, 1));
}

/// What really drove the heater is what is identified, not what was asked for; no number counts as the drive.
#[test]
fn the_applied_power_is_what_counts() {
    let mut instrument = armed();
    let mut seen = Vec::new();
    for k in 0..60 {
        let flicker = ((k * 7) % 5) as f32;
        let raw = RawSample {
            t0: AdcCode(AMBIENT),
            t1: AdcCode(1620.0 + flicker),
            t2: AdcCode(1650.0 - flicker),
            ..RawSample::default()
        };
        let tick = instrument.control(raw);
        let applied = if k == 59 { f32::NAN } else { 20.0 + flicker };
        let report = instrument.diagnose(&tick, fdi_core::Percent(applied));
        seen.extend(report.features.map(|f| (f[2], applied, tick.drive.0)));
    }
    let (last, applied) = seen.split_last().unwrap();
    assert!(applied.len() > 20 && applied.iter().all(|(power, applied, _)| power == applied));
    assert_eq!(last.0, last.2);
}

/// Ticks with codes for T1 and T2 until one trips, and what it tripped on; `None` if none of them does.
fn first_trip(codes: &[(f32, f32)]) -> Option<(usize, TripReason)> {
    let mut instrument = armed();
    codes.iter().enumerate().find_map(|(k, &(t1, t2))| {
        let tick = instrument.control(RawSample {
            t0: AdcCode(AMBIENT),
            t1: AdcCode(t1),
            t2: AdcCode(t2),
            ..RawSample::default()
        });
        match tick.mode {
            Mode::Tripped(trip) => Some((k, trip.reason)),
            _ => None,
        }
    })
}

#[test]
fn hotter_than_the_limit_trips_in_its_tick_however_odd_the_reading_is() {
    // 85 degC, and 111 to 200 degC and the rail, which are no longer plausible.
    for code in [400.0, 200.0, 150.0, 100.0, 41.0, 30.0, 0.0] {
        let t2 = [(AMBIENT, AMBIENT), (AMBIENT, AMBIENT), (AMBIENT, code)];
        assert_eq!(first_trip(&t2), Some((2, TripReason::T2OverTemperature)), "T2 at {code}");
        let t1 = first_trip(&[(AMBIENT, AMBIENT), (AMBIENT, AMBIENT), (code, AMBIENT)]);
        assert_eq!(t1.map(|(k, _)| k), Some(2), "T1 at {code}: {t1:?}");
    }
    assert_eq!(
        first_trip(&[(AMBIENT, AMBIENT), (AMBIENT, f32::NAN), (AMBIENT, 4094.0)]),
        None,
        "nothing read is not hot"
    );
}

#[test]
fn a_ramp_or_a_pattern_above_the_limit_trips_in_the_first_tick_above_it() {
    let config = Config::default();
    let sensor = fdi_core::sense::thermistor::Thermistor::new(&config.sensors.t1, 1).unwrap();
    let code = |celsius: f32| sensor.code(Celsius(celsius)).0;
    for step in [4.5, 6.0, 8.0, 10.0, 12.0, 15.0] {
        let ramp: Vec<f32> = (0..20).map(|k| 25.0 + step * k as f32).collect();
        let above = ramp.iter().position(|&t| t > 75.0).unwrap();
        let codes: Vec<_> = ramp.iter().map(|&t| (code(t), code(25.0))).collect();
        assert_eq!(first_trip(&codes), Some((above, TripReason::T1OverTemperature)), "{step} degC a tick");
    }
    let pattern: Vec<_> = [30.0, 30.0, 95.0, 29.0, 31.0].iter().map(|&t| (code(t), code(30.0))).collect();
    assert_eq!(first_trip(&pattern), Some((2, TripReason::T1OverTemperature)));
}

#[test]
fn a_trip_whose_cause_lasts_can_not_be_acknowledged() {
    let mut instrument = armed();
    let hot =
        RawSample { t0: AdcCode(AMBIENT), t1: AdcCode(AMBIENT), t2: AdcCode(10.0), ..RawSample::default() };
    let _ = instrument.control(hot);
    assert_eq!(
        instrument.command(Command::Acknowledge),
        Err(Refusal::CausePersists(TripReason::T2OverTemperature))
    );
}

#[test]
fn no_limit_is_widened_while_the_heater_is_on() {
    type Change = fn(&mut Config);
    let widened: [(&str, Change); 9] = [
        ("supervisor.over_temperature", |c| c.supervisor.over_temperature.0 = 100.0),
        ("supervisor.min_air_flow", |c| c.supervisor.min_air_flow.0 = 0.0),
        ("supervisor.max_disagreement", |c| c.supervisor.max_disagreement.0 = 10.0),
        ("supervisor.cooling_time", |c| c.supervisor.cooling_time.0 = 32.0),
        ("supervisor.go_on_without_t1", |c| c.supervisor.go_on_without_t1 = true),
        ("identification.answer_time", |c| c.identification.answer_time.0 = 4.0),
        ("plausibility.stuck_time", |c| c.plausibility.stuck_time.0 = 16.0),
        ("sensors.t1", |c| c.sensors.t1.offset.0 = -15.0),
        ("pid.output_max", |c| c.pid.output_max.0 = 100.0),
    ];
    let mut base = Config::default();
    base.pid.output_max.0 = 80.0;
    for (name, change) in widened {
        let mut instrument = Instrument::new(&base).unwrap();
        let mut config = base.clone();
        change(&mut config);
        instrument.retune(&config).unwrap_or_else(|e| panic!("{name}, off: {e}"));
        instrument.retune(&base).unwrap();
        instrument.command(Command::Arm).unwrap();
        tick(&mut instrument, AMBIENT, 0);
        let error = instrument.retune(&config).unwrap_err();
        assert_eq!(error, RetuneError::Refused(Refusal::WidensLimit(name)));
        instrument.command(Command::Stop).unwrap();
        instrument.retune(&config).unwrap();
        instrument.command(Command::Arm).unwrap();
        let narrower = instrument.retune(&base);
        assert!(narrower.is_ok() || name == "sensors.t1", "{name}: {narrower:?}");
    }
}

#[test]
fn settings_that_undo_each_other_are_refused_by_both_names() {
    let refused = |change: fn(&mut Config)| {
        let mut config = Config::default();
        change(&mut config);
        Instrument::new(&config).unwrap_err().to_string()
    };
    for text in [
        refused(|c| c.plausibility.max.0 = 70.0),
        refused(|c| c.supervisor.over_temperature.0 = 120.0),
        refused(|c| c.supervisor.over_temperature.0 = 110.0),
    ] {
        assert!(text.contains("plausibility.max") && text.contains("supervisor.over_temperature"), "{text}");
    }
    // 100 samples are learnt at least: 11 s.
    let too_short = refused(|c| c.supervisor.learn_end.0 = c.supervisor.learn_start.0 + 10.9);
    assert!(too_short.contains("supervisor.learn_end") && too_short.contains("learn_start"), "{too_short}");
}

/// When the heat of before has died away, 8 s after the power, the tick may come without a sample.
#[test]
fn a_missing_sample_is_no_heater_stuck_on() {
    let mut instrument = Instrument::new(&Config::default()).unwrap();
    for k in 0..400 {
        let code = if (68..78).contains(&k) { f32::NAN } else { AMBIENT };
        let raw =
            RawSample { t0: AdcCode(code), t1: AdcCode(code), t2: AdcCode(code), ..RawSample::default() };
        assert_eq!(instrument.control(raw).mode, Mode::Off, "tick {k}");
    }
}

/// Thermistors that are calibrated anew read other temperatures of the same rig: nobody has heated it.
#[test]
fn a_calibration_at_rest_is_no_heat() {
    let mut config = Config::default();
    let mut instrument = Instrument::new(&config).unwrap();
    for k in 0..1000 {
        if k == 100 {
            for sensor in [&mut config.sensors.t0, &mut config.sensors.t1, &mut config.sensors.t2] {
                sensor.offset.0 = 12.0;
            }
            instrument.retune(&config).unwrap();
        }
        assert_eq!(tick(&mut instrument, AMBIENT, k).mode, Mode::Off, "tick {k}");
    }
}
