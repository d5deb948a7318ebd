//! What the rules go by: the room, and what was learnt; and what is no heat that nobody asked for.

use super::*;
#[test]
fn gain_and_difference_are_means_over_what_was_learnt() {
    let mut bench = Bench::new();
    let account = &mut bench.state.account;
    let learn = |account: &mut AccountState, pid: f32, t1: f32, t2: f32| {
        situation(0, &Shown { pid, t1, t2, ..IN_ORDER }, 35.0, |now| account.push(now));
    };
    account.forget();
    account.end();
    assert_eq!(account.power_for(Celsius(35.0)), None, "of nothing");
    learn(account, 90.0, 90.0, 20.0);
    account.begin();
    learn(account, 20.0, 30.0, 29.0);
    learn(account, 30.0, 34.0, 31.0);
    account.end();
    account.end(); // each tick of monitoring
    assert_eq!(account.learnt.map(|learnt| learnt.t1_over_t2), Some(2.0));
    let power = account.power_for(Celsius(35.0)).expect("learnt");
    assert!((power - 32.5).abs() < 1e-3, "0.4 degC per %: {power}");
    account.begin();
    learn(account, 2.0, 24.0, 23.0);
    account.end();
    assert_eq!(account.power_for(Celsius(35.0)), None, "2 % are too little to learn a gain from");
}

/// A rig of 0.4 degC per % that was learnt in a room of 27 degC: what is taken for the cold rig after so many hours.
fn cold_after(hours: f32, shown: impl Fn(f32) -> Shown) -> f32 {
    let mut bench = Bench::new();
    bench.state = SupervisorState::default();
    bench.supervisor.restored(&mut bench.state, &learnt(0.4, 1.0));
    for tick in 0..20 {
        bench.step(tick, &Shown { t0: 27.0, t1: 27.0, t2: 27.0, pid: 0.0, ..IN_ORDER });
    }
    bench.state.mode = Mode::Monitor;
    for tick in 0..(hours * 3600.0 / TS.0) as u32 {
        bench.step(tick, &shown(tick as f32 * TS.0 / 3600.0));
    }
    bench.state.account.cold.expect("known")
}

/// Twelve hours later the room is 10 degC colder, and the power has followed: no more than that is needed. A day later it is warm again.
#[test]
fn a_night_and_a_day_are_followed_while_it_heats() {
    let night = |hours: f32| {
        let t0 = 27.0 - 10.0 * hours / 12.0;
        Shown { t0, t1: 37.0, t2: 36.0, pid: (37.0 - t0) / 0.4, ..IN_ORDER }
    };
    let cold = cold_after(12.0, night);
    assert!((cold - 17.0).abs() < 0.2, "{cold}");
    let warm = cold_after(24.0, |hours| night(if hours < 12.0 { hours } else { 24.0 - hours }));
    assert!((warm - 27.0).abs() < 0.2, "{warm}");
}

/// What is no room: a T0 that reads lower and lower, one that jumps, and power that T1 does not show.
#[test]
fn a_wrong_t0_moves_the_cold_rig_by_no_more_than_a_quarter_of_the_rise() {
    let at = |t0: f32, pid: f32| Shown { t0, t1: 37.0, t2: 36.0, pid, ..IN_ORDER };
    let drifting = cold_after(6.0, |hours| at(27.0 - 2.0 * hours, 25.0));
    assert!((24.3..24.7).contains(&drifting), "a rise of 12.5 is the most that 25 % may give: {drifting}");
    let jumped = cold_after(1.0, |_| at(10.0, 25.0));
    assert!((jumped - 27.0).abs() < 0.01, "{jumped}");
    let too_little = cold_after(1.0, |_| at(25.0, 40.0));
    assert!((too_little - 27.0).abs() < 0.01, "T1 shows 12 of 16: {too_little}");
    let by_six = cold_after(0.5, |_| at(25.0, 30.0));
    assert!(
        (by_six - 25.0).abs() < 0.1 && cold_after(0.5, |_| at(18.0, 47.5)) > 23.9,
        "6 degC an hour: {by_six}"
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
    // A rise that was under way when the power went.
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
        bench.step(tick, &Shown { t0: room(tick), t1: 40.0, t2: 39.0, pid: 50.0, ..IN_ORDER });
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
