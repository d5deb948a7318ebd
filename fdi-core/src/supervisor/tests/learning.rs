//! What the rules go by: the room, and what was learnt; and what is no heat that nobody asked for.

use super::*;
use crate::supervisor::operation::Operation;

fn show(operation: &mut Operation, shown: Shown, change: fn(&mut Operation, &Situation)) {
    situation(0, &shown, 35.0, |now| change(operation, now));
}

fn in_room(operation: &mut Operation, degrees: f32, ticks: u32) {
    for _ in 0..ticks {
        let shown = Shown { t0: degrees, t1: degrees, t2: degrees, ..IN_ORDER };
        show(operation, shown, |operation, now| operation.follow_ambient(now, TS));
    }
}

fn learn(operation: &mut Operation, pid: f32, t1: f32, t2: f32) {
    show(operation, Shown { pid, t1, t2, ..IN_ORDER }, Operation::push);
}

#[test]
fn gain_and_difference_are_means_over_what_was_learnt() {
    let needed = |operation: &Operation, setpoint| operation.power_for(Celsius(setpoint));
    let mut operation = Operation::default();
    assert!(operation.knows_no_ambient());
    in_room(&mut operation, 22.0, 1);
    assert!(!operation.knows_no_ambient() && operation.learnt().is_none());
    operation.end();
    assert!(operation.learnt().is_none(), "of nothing");
    learn(&mut operation, 90.0, 90.0, 20.0);
    operation.begin();
    learn(&mut operation, 20.0, 30.0, 29.0);
    learn(&mut operation, 30.0, 34.0, 31.0);
    operation.end();
    operation.end(); // each tick of monitoring
    assert_eq!(operation.learnt().map(|learnt| learnt.t1_over_t2()), Some(2.0));
    let power = needed(&operation, 35.0).expect("learnt");
    assert!((power - 32.5).abs() < 1e-4, "0.4 degC per %: {power}");
    assert_eq!(needed(&operation, 22.5), None, "too little to tell");
    // A minute later the room may be 1 degC warmer.
    in_room(&mut operation, 40.0, 546);
    let power = needed(&operation, 35.0).expect("learnt");
    assert!((power - 30.0).abs() < 0.02, "{power}");
    operation.forget();
    assert!(operation.learnt().is_none());

    operation.begin();
    learn(&mut operation, 2.0, 24.0, 23.0);
    operation.end();
    assert_eq!(operation.learnt().map(|learnt| learnt.t1_over_t2()), Some(1.0));
    assert_eq!(needed(&operation, 35.0), None, "2 % are too little to learn a gain from");
}

/// A rig that rises by 0.4 degC for each per cent and was learnt in a room of 27 degC; the room is thought to be this after so many hours of monitoring.
fn room_after(hours: u32, shown: impl Fn(f32) -> Shown) -> f32 {
    let mut operation = Operation::default();
    in_room(&mut operation, 27.0, 1);
    operation.begin();
    learn(&mut operation, 25.0, 37.0, 36.0);
    operation.end();
    // 10 s at once, for the test's sake: the rate is one of time.
    for k in 0..hours * 360 {
        situation(0, &shown(k as f32 / 360.0), 37.0, |now| {
            operation.follow_heated_room(now, now.pid.0, Seconds(10.0));
        });
    }
    37.0 - 0.4 * operation.power_for(Celsius(37.0)).expect("learnt")
}

/// Twelve hours later the room is 10 degC colder, and the power has followed: no more than that is needed.
#[test]
fn a_night_is_followed_while_it_heats() {
    let night = |hours: f32| {
        let t0 = 27.0 - 10.0 * hours / 12.0;
        Shown { t0, t1: 37.0, t2: 36.0, pid: (37.0 - t0) / 0.4, ..IN_ORDER }
    };
    assert!((room_after(12, night) - 17.0).abs() < 0.1, "{}", room_after(12, night));
    let day = |hours: f32| night(if hours < 12.0 { hours } else { 24.0 - hours });
    assert!((room_after(24, day) - 27.0).abs() < 0.2, "{}", room_after(24, day));
    let warmer = |hours: f32| night(-hours);
    assert_eq!(room_after(4, warmer), 27.0, "no tighter than when heating began");
}

/// What is no room: a T0 that reads lower and lower, one that jumps, and power that T1 does not show.
#[test]
fn a_wrong_t0_moves_the_room_by_no_more_than_a_quarter_of_the_rise() {
    let at = |t0: f32, pid: f32| Shown { t0, t1: 37.0, t2: 36.0, pid, ..IN_ORDER };
    let drifting = room_after(24, |hours| at(27.0 - 2.0 * hours, 25.0));
    assert!((24.4..24.6).contains(&drifting), "a rise of 12.5 is the most that 25 % may give: {drifting}");
    let jumped = room_after(24, |_| at(10.0, 25.0));
    assert_eq!(jumped, 27.0);
    let out_of_the_tube = room_after(24, |_| Shown { t1: 27.0, ..at(20.0, 100.0) });
    assert_eq!(out_of_the_tube, 27.0);
    let within_an_hour = room_after(1, |_| at(25.0, 30.0));
    assert!(
        (within_an_hour - 25.0).abs() < 0.01 && room_after(1, |_| at(18.0, 47.5)) > 20.9,
        "6 degC an hour"
    );
}

/// At rest, off: whether it is taken for a heater that is stuck on.
fn is_stuck_on(shown: impl Fn(u32) -> Shown) -> bool {
    let mut bench = Bench::new();
    matches!(bench.trips(false, shown), Some((_, TripReason::HeaterStuckOn)))
}

#[test]
fn both_must_show_heat_that_nobody_asked_for() {
    assert!(is_stuck_on(heats_unasked));
    assert!(!is_stuck_on(|tick| Shown { t1: ROOM, ..heats_unasked(tick) }), "T2 in a hand");
    assert!(!is_stuck_on(|tick| Shown { t2: ROOM, ..heats_unasked(tick) }), "T1 in a hand");
    for (t2, stuck_on) in [
        (Validity::Open, true),
        (Validity::Short, true),
        (Validity::OutOfRange, true),
        (Validity::Missing, false),
        (Validity::Stuck, false),
    ] {
        let without_t2 = |tick| Shown { validity: [Validity::Good, t2], t2: ROOM, ..heats_unasked(tick) };
        assert_eq!(is_stuck_on(without_t2), stuck_on, "T2 {t2:?}");
    }
}

#[test]
fn what_cools_or_is_asked_for_is_no_heater_stuck_on() {
    // A tenth in each 15 s is cooling; less is not.
    let cools = |share: f32| {
        move |tick: u32| {
            let t = ROOM + 22.0 * libm::powf(1.0 - share, tick as f32 / 137.0);
            Shown { t1: t, t2: t, ..stays_hot(tick) }
        }
    };
    assert!(!is_stuck_on(cools(0.12)));
    assert!(is_stuck_on(cools(0.08)));
    // Warm by less than 8 degC, for however long.
    assert!(!is_stuck_on(|tick| Shown { t1: 29.9, t2: 29.9, ..stays_hot(tick) }));
    // Power all the while.
    assert!(!is_stuck_on(|tick| Shown { pid: 1.0, ..heats_unasked(tick) }));
    // A rise that was under way when the power went, within `response_time`.
    let late = |tick: u32| {
        let t = ROOM + if tick < 60 { 0.1 * tick as f32 } else { 6.0 + 0.01 * (tick as f32 - 60.0) };
        Shown { t1: t, t2: t, ..stays_hot(tick) }
    };
    assert!(!is_stuck_on(|tick| Shown {
        t1: late(tick.min(200)).t1,
        t2: late(tick.min(200)).t2,
        ..late(tick)
    }));
}

/// Ten minutes with the heater on, while the room grows 10 degC warmer: then the rig cools to that room and no further.
#[test]
fn a_room_that_has_grown_warmer_is_no_heater_stuck_on() {
    let mut bench = Bench::new();
    let room = |tick: u32| ROOM + 0.0017 * tick.min(6000) as f32;
    bench.state.mode = Mode::Settle { steady: 0 };
    for tick in 0..6000 {
        bench.step(tick, &Shown { t0: room(tick), t1: 40.0, t2: 39.0, pid: 25.0, ..IN_ORDER });
    }
    assert!(bench.state.mode.is_heating());
    bench.state.mode = Mode::Off;
    let cooled = Shown { t0: room(6000), t1: room(6000) + 0.5, t2: room(6000) + 0.5, pid: 0.0, ..IN_ORDER };
    assert_eq!(bench.trips(false, |_| cooled), None);
}

/// Hot from the start there is no colder reading to hold it against: then no room is above 45 degC.
#[test]
fn a_rig_that_has_been_hot_from_the_start_is_stuck_on() {
    let from_the_start = |t: fn(u32) -> f32| {
        let mut bench = Bench::new();
        bench.state = SupervisorState::default();
        bench.trips(false, |tick| Shown { t1: t(tick), t2: t(tick), pid: 0.0, ..IN_ORDER })
    };
    // By half a degree in `cooling_time`, where a tenth of what it is above 45 degC would be 1.5.
    let slowly = from_the_start(|tick| 60.0 - tick as f32 / 274.0);
    assert!(matches!(slowly, Some((_, TripReason::HeaterStuckOn))), "{slowly:?}");
    assert_eq!(from_the_start(|tick| 60.0 - tick as f32 / 60.0), None, "it cools");
    assert_eq!(from_the_start(|_| 44.0), None, "in the sun");
}
