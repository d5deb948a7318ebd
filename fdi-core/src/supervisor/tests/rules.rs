//! What each rule must not be talked out of, and what it must not take for a danger.

use super::*;

/// When it trips, armed, and on what.
fn first_trip(shown: impl Fn(u32) -> Shown) -> Option<(u32, TripReason)> {
    Bench::new().trips(true, shown)
}

/// A set-point that falls: T2 is late, and rightly the hotter one, but never hotter than T1 was.
#[test]
fn a_t1_that_falls_faster_than_t2_is_no_disagreement() {
    let falls = |tick: u32| Shown {
        t1: if tick < 20 { 50.0 } else { 30.0 },
        t2: 29.0 + if tick < 20 { 20.0 } else { 20.0 * libm::powf(0.92, tick as f32 - 20.0) },
        pid: if tick < 20 { 93.0 } else { 25.0 },
        ..IN_ORDER
    };
    let momentary = (20..LONG).filter(|tick| falls(*tick).t2 - falls(*tick).t1 > 5.5).count();
    assert!(momentary > 12, "longer than the rule takes: {momentary}");
    assert_eq!(first_trip(falls), None);
    let t1_out = |tick: u32| Shown { t2: 49.0, ..falls(tick) };
    assert!(matches!(first_trip(t1_out), Some((20..60, TripReason::SensorsDisagree))));
}

/// A reading that jumps is no good to regulate by, but hot is hot.
#[test]
fn readings_that_jump_disagree_all_the_same() {
    let good = Validity::Good;
    for jumps in [Validity::Spike, Validity::Rate] {
        let t2 = first_trip(|_| Shown { t2: 45.0, validity: [good, jumps], ..IN_ORDER });
        assert!(matches!(t2, Some((11..16, TripReason::SensorsDisagree))), "{t2:?}");
        // A T1 that is good now and then, when T2 has no sample, is not lost.
        let validity = |tick| if tick % 4 == 3 { [good, Validity::Missing] } else { [jumps, good] };
        let t1 = first_trip(|tick| Shown { t2: 45.0, validity: validity(tick), ..IN_ORDER });
        assert!(matches!(t1, Some((11..20, TripReason::SensorsDisagree))), "{t1:?}");
    }
    let missing = [good, Validity::Missing];
    assert_eq!(first_trip(|_| Shown { t2: 45.0, validity: missing, ..IN_ORDER }), None, "nothing was read");
}

/// Without power the time stands still: it neither goes on nor begins anew.
#[test]
fn a_pause_of_the_power_does_not_begin_a_disagreement_anew() {
    // A mean power that is exactly zero soon after the power is, and a time that outlasts that.
    let mut config = SupervisorConfig::default();
    config.disagreement_time.0 = 11.0;
    let mut bench = Bench::new();
    bench.supervisor = Supervisor::of(&config, Percent(100.0), &plant(), TS);
    let power = |tick| if (30..300).contains(&tick) { 0.0 } else { 8.0 };
    let tripped = bench.trips(true, |tick| Shown { t1: ROOM, t2: 45.0, pid: power(tick), ..IN_ORDER });
    assert!(matches!(tripped, Some((301..370, TripReason::SensorsDisagree))), "{tripped:?}");
}

/// One sample, the first, is 10 degC too cold: T1 that stays at the room's temperature has not risen by 10 degC.
#[test]
fn one_false_sample_at_the_start_counts_for_nothing() {
    for first in [ROOM - 10.0, ROOM, ROOM + 10.0] {
        let mut bench = Bench::new();
        bench.state = SupervisorState::default();
        let out = |tick| Shown { t1: if tick == 0 { first } else { ROOM }, t2: ROOM, pid: 100.0, ..IN_ORDER };
        let tripped = bench.trips(true, out);
        assert!(matches!(tripped, Some((5..40, TripReason::NoResponse))), "{first}: {tripped:?}");
    }
}

/// At rest three thermistors agree; after a stop the rig may still be warm.
#[test]
fn what_is_armed_agrees_at_rest() {
    let armed = |warm: bool, t0: f32, t1: f32| {
        let mut bench = Bench::new();
        if warm {
            bench.trips(true, |_| IN_ORDER);
            bench.state.mode = Mode::Off;
        }
        bench.step(0, &Shown { t0, t1, t2: ROOM, pid: 0.0, ..IN_ORDER });
        bench.supervisor.command(&mut bench.state, Command::Arm)
    };
    let refused = |t0, t1| Err(Refusal::NotAtRest([t0, t1, ROOM]));
    for (t0, t1, wrong) in [(ROOM, 24.9, false), (ROOM, 25.1, true), (ROOM, 18.9, true), (18.9, ROOM, true)] {
        assert_eq!(armed(false, t0, t1), if wrong { refused(t0, t1) } else { Ok(()) }, "{t0} {t1}");
    }
    // A T2 that is lost does not hide that T1 has the wrong constants.
    let mut bench = Bench::new();
    bench.state = SupervisorState::default();
    let wrong = Shown { t1: 40.0, validity: [Validity::Good, Validity::Open], pid: 0.0, ..IN_ORDER };
    (0..20).for_each(|tick| bench.step(tick, &wrong));
    let refused_all_the_same = bench.supervisor.command(&mut bench.state, Command::Arm);
    assert!(
        matches!(refused_all_the_same, Err(Refusal::NotAtRest([_, t1, t2])) if t1 == 40.0 && t2.is_nan())
    );
    // Hot before it was ever asked to heat: that is no warmth that is left.
    let mut bench = Bench::new();
    bench.state = SupervisorState::default();
    (0..20).for_each(|tick| bench.step(tick, &Shown { t1: 45.0, t2: 44.0, pid: 0.0, ..IN_ORDER }));
    assert!(bench.supervisor.command(&mut bench.state, Command::Arm).is_err());
    assert!(bench.supervisor.command(&mut bench.state, Command::Tune).is_err());
    assert_eq!(armed(true, ROOM, 28.0), Ok(()), "warmth that is left");
    assert_eq!(armed(true, ROOM, 34.0), refused(ROOM, 34.0), "more than is left");
}

/// What tripped and is armed again has half the patience, until power is accounted for again.
#[test]
fn a_second_trip_takes_half_the_patience() {
    let excess = |_| Shown { pid: 85.0, ..IN_ORDER };
    let mut bench = Bench::new();
    let mut trips = |before: fn(u32) -> Shown| {
        bench.state.mode = Mode::Settle { steady: 0 };
        (0..200).for_each(|tick| bench.step(tick, &before(tick)));
        assert!(bench.state.mode.is_heating());
        let (tick, reason) = bench.trips(true, excess).expect("trips");
        assert_eq!(reason, TripReason::ExcessPower);
        bench.state.mode = Mode::Off;
        tick
    };
    let first = trips(|_| IN_ORDER);
    let again = {
        bench.state.mode = Mode::Off;
        (0..100).for_each(|tick| bench.step(tick, &Shown { t1: ROOM, t2: ROOM, pid: 0.0, ..IN_ORDER }));
        bench.state.account.owed_share()
    };
    assert!((again - 0.5).abs() < 1e-3 && first > 5, "{again} {first}");
    bench.state.mode = Mode::Settle { steady: 0 };
    (0..200).for_each(|tick| bench.step(tick, &IN_ORDER));
    assert_eq!(bench.state.account.owed_share(), 0.0, "accounted for");
}

/// With more air the same warmth takes more power, and that is announced.
#[test]
fn an_announced_fan_changes_what_the_power_must_show() {
    let fan = |level| first_trip(move |_| Shown { pid: 75.0, fan: Some(level), ..IN_ORDER });
    assert!(matches!(fan(100.0), Some((_, TripReason::ExcessPower))));
    assert_eq!(fan(170.0), None);
}

/// Without T0 the cold rig is the colder of T1 and T2 at rest.
#[test]
fn a_broken_t0_neither_trips_nor_hides_a_t1_that_is_out() {
    let lost = |out: bool| {
        let mut bench = Bench::new();
        bench.state = SupervisorState::default();
        let show = |bench: &mut Bench, tick: u32, shown: Shown| {
            let validity = Validity::Open;
            situation(tick, &shown, 35.0, |now| {
                let sample = Sample { t0: Reading { validity, ..now.sample.t0 }, ..*now.sample };
                let _ = bench.supervisor.step(&mut bench.state, &Situation { sample: &sample, ..*now });
            });
        };
        let rest = Shown { t1: ROOM, t2: ROOM, pid: 0.0, ..IN_ORDER };
        (0..20).for_each(|tick| show(&mut bench, tick, rest));
        bench.state.mode = Mode::Settle { steady: 0 };
        (0..LONG).for_each(|tick| {
            show(&mut bench, tick, if out { Shown { pid: 90.0, ..rest } } else { IN_ORDER })
        });
        bench.state.mode
    };
    assert!(lost(false).is_heating(), "{:?}", lost(false));
    assert!(matches!(lost(true), Mode::Tripped(trip) if trip.reason == TripReason::NoResponse));
}

/// A bench of which nothing was learnt; what the check has measured, if it has.
fn unlearnt(checked: Option<f32>) -> Bench {
    let mut bench = Bench::new();
    bench.supervisor.command(&mut bench.state, Command::Relearn).expect("in any mode");
    if let Some(gain) = checked {
        bench.supervisor.command(&mut bench.state, Command::Gain(gain)).expect("in any mode");
    }
    bench
}

/// Half of the power is 15 degC on a rig of 0.3: T1 shows 3. The declaration asks for 0.1 at least, and has nothing against it.
#[test]
fn the_gain_of_the_check_is_asked_of_t1_from_the_first_second() {
    let little = |_| Shown { t1: ROOM + 3.0, t2: ROOM + 3.0, pid: 50.0, ..IN_ORDER };
    for (checked, trips) in [(None, false), (Some(f32::NAN), false), (Some(-1.0), false), (Some(0.3), true)] {
        let tripped = unlearnt(checked).trips(true, little);
        assert_eq!(tripped.map(|(_, reason)| reason), trips.then_some(TripReason::NoResponse), "{checked:?}");
    }
    // What is learnt on a T1 that shows less than the check did does not make it right.
    let mut bench = unlearnt(Some(0.3));
    bench.supervisor.restored(&mut bench.state, &learnt(0.1, 0.0));
    assert!(matches!(bench.trips(true, little), Some((_, TripReason::ExcessPower))));
}

/// At a third of the air the same power warms more than twice as much; before anything is learnt only the check knows.
#[test]
fn a_fan_that_is_weaker_than_at_the_check_trips() {
    let weak = |_| Shown { t1: ROOM + 20.0, t2: ROOM + 19.0, pid: 10.0, ..IN_ORDER };
    assert_eq!(unlearnt(None).trips(true, weak), None);
    assert!(matches!(unlearnt(Some(0.3)).trips(true, weak), Some((_, TripReason::AirFlowLost))));
    let as_checked = |_| Shown { t1: ROOM + 20.0, t2: ROOM + 19.0, pid: 60.0, ..IN_ORDER };
    assert_eq!(unlearnt(Some(0.3)).trips(true, as_checked), None);
}

/// T1 was above T2 by 8 degC where it was learnt. In a rig that is hardly warm, both near the room's temperature, T2 is not missed for that.
#[test]
fn what_t1_was_above_t2_shrinks_with_the_warmth() {
    let hot = Shown { t1: 62.0, t2: 54.0, pid: 133.0, ..IN_ORDER };
    let cool = Shown { t1: ROOM + 2.0, t2: ROOM + 1.5, pid: 8.0, ..IN_ORDER };
    let mut bench = Bench::new();
    let mut raw = learnt(0.3, 8.0);
    raw.raw.mean[Residual::Rsg2 as usize] = 0.3 * 32.0 / 40.0;
    bench.supervisor.restored(&mut bench.state, &raw);
    assert_eq!(bench.trips(true, |tick| if tick < 300 { hot } else { cool }), None);
    let out = |tick| if tick < 300 { hot } else { Shown { t1: 46.5, t2: 54.0, ..hot } };
    let mut bench = Bench::new();
    bench.supervisor.restored(&mut bench.state, &raw);
    assert!(matches!(
        bench.trips(true, out),
        Some((300.., TripReason::SensorsDisagree | TripReason::ExcessPower))
    ));
}

/// In air that stands still T1 grows hot beside the element, and no heat reaches T2.
#[test]
fn a_hot_t1_before_a_cold_t2_is_air_that_stands_still() {
    let still = |tick: u32| {
        if tick < 100 { IN_ORDER } else { Shown { t1: 50.0, t2: ROOM + 1.0, pid: 0.0, ..IN_ORDER } }
    };
    assert!(matches!(first_trip(still), Some((100..130, TripReason::AirFlowLost))));
    // At rest it hangs in the sun.
    let mut bench = Bench::new();
    assert_eq!(bench.trips(false, still), None);
    // At rest a heater that is stuck on without a fan warms T2 by less than half as much: that trips all the same.
    let stuck_on = |tick: u32| {
        let rise = 0.3 * tick as f32;
        Shown { t1: ROOM + rise, t2: ROOM + 0.4 * rise, pid: 0.0, ..IN_ORDER }
    };
    assert!(matches!(Bench::new().trips(false, stuck_on), Some((_, TripReason::HeaterStuckOn))));
    // Both hot: that is the heater.
    let on = |tick: u32| if tick < 100 { still(tick) } else { Shown { t2: 49.0, ..still(tick) } };
    assert!(matches!(first_trip(on), Some((100..130, TripReason::HeaterStuckOn))));
}

/// All but a tenth of the power that there is, for 8 answer times of 2 s, with T1 below the set-point and no warmer.
#[test]
fn full_power_without_a_rise_is_a_set_point_out_of_reach() {
    let mut config = SupervisorConfig::default();
    config.min_air_flow.0 = 0.0;
    // At most half of the power: 45 % are full.
    let tripped = |pid: f32, error: f32, mode: Mode, t1: fn(u32) -> f32| {
        let mut bench = unlearnt(None);
        bench.supervisor = Supervisor::of(&config, Percent(50.0), &plant(), TS);
        bench.state.mode = mode;
        (0..LONG).find_map(|tick| {
            let shown = Shown { t1: t1(tick), t2: t1(tick), pid, ..IN_ORDER };
            situation(tick, &shown, 60.0, |now| {
                let now = Situation { mean_error: Some(error), ..*now };
                let _ = bench.supervisor.step(&mut bench.state, &now);
            });
            let Mode::Tripped(trip) = bench.state.mode else { return None };
            Some((tick, trip.reason))
        })
    };
    let (heating, warm) = (Mode::Settle { steady: 0 }, |_| ROOM + 13.5);
    let found = tripped(45.1, 20.0, heating, warm);
    assert!(matches!(found, Some((145..175, TripReason::OutOfReach))), "{found:?}");
    assert_eq!(tripped(44.9, 20.0, heating, warm), None, "less than full");
    assert_eq!(tripped(45.1, 1.9, heating, warm), None, "as good as there");
    assert_eq!(tripped(45.1, 20.0, Mode::Tune, warm), None, "an experiment has no set-point");
    let rises = |tick: u32| ROOM + 13.5 + 2.2 * (tick / 100) as f32;
    assert_eq!(tripped(45.1, 20.0, heating, rises), None, "it may get there");
}

/// A gain that is declared next to nothing asks for 0.09 degC per % all the same.
#[test]
fn no_declaration_asks_for_nothing() {
    let mut declared = plant();
    declared.y_scale.0 = 1e-3;
    let mut bench = unlearnt(None);
    bench.supervisor = Supervisor::of(&SupervisorConfig::default(), Percent(100.0), &declared, TS);
    let dead = |_| Shown { t1: ROOM, t2: ROOM, pid: 90.0, ..IN_ORDER };
    assert!(matches!(bench.trips(true, dead), Some((_, TripReason::NoResponse))));
}

/// Ten ticks of disagreement before a stop are none after it: eleven may pass.
#[test]
fn a_disagreement_begins_anew_after_a_stop() {
    let out = |tick: u32| if tick < 10 { Shown { t1: ROOM, t2: 27.5, ..IN_ORDER } } else { IN_ORDER };
    let mut bench = Bench::new();
    bench.state.mode = Mode::Settle { steady: 0 };
    (0..10).for_each(|tick| bench.step(tick, &out(tick)));
    bench.state.mode = Mode::Off;
    (0..3).for_each(|tick| bench.step(tick, &IN_ORDER));
    bench.state.mode = Mode::Settle { steady: 0 };
    (0..10).for_each(|tick| bench.step(tick, &out(tick)));
    assert!(bench.state.mode.is_heating(), "{:?}", bench.state.mode);
}

/// While T1 is known to be wrong what it shows is no warmth: that of T2 is.
#[test]
fn a_hot_t1_that_is_known_to_be_wrong_is_no_heat() {
    let trips = |is_virtual: bool| {
        let mut bench = Bench::new();
        bench.state.mode = Mode::Settle { steady: 0 };
        for tick in 0..200 {
            situation(tick, &Shown { t1: 60.0, ..IN_ORDER }, 35.0, |now| {
                let regulated = Regulated { value: Some(Celsius(30.0)), is_virtual };
                let _ = bench.supervisor.step(&mut bench.state, &Situation { regulated, ..*now });
            });
        }
        !bench.state.mode.is_heating()
    };
    assert_eq!([trips(true), trips(false)], [false, true]);
}

/// An unlearnt rig that shows one gain, and another one later, after so many ticks of little power; whether it goes on.
fn goes_on(mut bench: Bench, first: f32, ticks: u32, later: f32) -> bool {
    bench.state.mode = Mode::Settle { steady: 0 };
    let show = |bench: &mut Bench, ticks: u32, gain: f32, pid: f32| {
        let t = ROOM + gain * pid;
        (0..ticks).for_each(|tick| bench.step(tick, &Shown { t1: t, t2: t, pid, ..IN_ORDER }));
    };
    show(&mut bench, 100, first, 30.0);
    show(&mut bench, ticks, 0.5 * (first + later), 4.0);
    show(&mut bench, 100, later, 50.0);
    bench.state.mode.is_heating()
}

/// What T1 has shown of the gain is known at once, and fades: in a quarter of an hour of 2,400 time constants by a half.
#[test]
fn what_was_seen_of_the_gain_fades() {
    for (first, later) in [(0.8, 0.35), (0.25, 1.05)] {
        assert!(!goes_on(unlearnt(None), first, 200, later), "{first} {later}: believed");
        assert!(goes_on(unlearnt(None), first, 11_000, later), "{first} {later}: for long");
    }
    assert!(goes_on(unlearnt(None), 0.35, 200, 0.35));
}

#[test]
fn what_was_seen_is_forgotten_with_what_was_learnt() {
    let mut bench = unlearnt(None);
    bench.state.mode = Mode::Settle { steady: 0 };
    (0..100).for_each(|tick| {
        bench.step(tick, &Shown { t1: ROOM + 24.0, t2: ROOM + 24.0, pid: 30.0, ..IN_ORDER })
    });
    bench.supervisor.command(&mut bench.state, Command::Relearn).expect("while it heats");
    assert!(goes_on(bench, 0.35, 0, 0.35));
}

/// A T1 that was out tells nothing of the least gain: armed again, and mended, its warmth is no heat that nobody asked for.
#[test]
fn what_a_t1_that_is_out_shows_is_no_gain() {
    let mut bench = unlearnt(None);
    let dead = |_| Shown { t1: ROOM, t2: ROOM, pid: 50.0, ..IN_ORDER };
    assert!(matches!(bench.trips(true, dead), Some((_, TripReason::NoResponse))));
    bench.state.mode = Mode::Off;
    (0..300).for_each(|tick| bench.step(tick, &Shown { t1: ROOM, t2: ROOM, pid: 0.0, ..IN_ORDER }));
    let mended = |_| Shown { t1: ROOM + 15.0, t2: ROOM + 15.0, pid: 50.0, ..IN_ORDER };
    assert_eq!(bench.trips(true, mended), None);
}

/// A rig that was learnt at too little power to tell its gain: three times what is declared is the most that it may have.
#[test]
fn where_no_gain_was_learnt_the_declared_one_bounds_the_heat() {
    let mut bench = unlearnt(None);
    bench.supervisor.restored(&mut bench.state, &learnt(0.0, 0.0));
    let still = |_| Shown { t1: ROOM + 40.0, t2: ROOM + 1.0, pid: 1.0, ..IN_ORDER };
    assert!(matches!(bench.trips(true, still), Some((_, TripReason::AirFlowLost))));
}

/// The power is 0 already when it is stopped: what is warm then is what is left, and cools.
#[test]
fn a_stop_while_it_cools_is_no_heater_stuck_on() {
    let mut bench = Bench::new();
    bench.state.mode = Mode::Settle { steady: 0 };
    let warm = |rise: f32, pid: f32| Shown { t1: ROOM + rise, t2: ROOM + rise, pid, ..IN_ORDER };
    (0..200).for_each(|tick| bench.step(tick, &warm(18.0, 60.0)));
    (0..40).for_each(|tick| bench.step(tick, &warm(17.0, 0.0)));
    assert!(bench.state.mode.is_heating());
    bench.state.mode = Mode::Off;
    let cools = |tick: u32| warm(17.0 * libm::powf(0.88, tick as f32 / 137.0), 0.0);
    assert_eq!(bench.trips(false, cools), None);
}
