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
    config.response_time.0 = 1.0;
    config.disagreement_time.0 = 11.0;
    let mut bench = Bench::new();
    bench.supervisor = Supervisor::of(&config, Percent(100.0), ANSWER, TS);
    let power = |tick| if (30..300).contains(&tick) { 0.0 } else { 25.0 };
    let tripped = bench.trips(true, |tick| Shown { t1: ROOM, t2: 45.0, pid: power(tick), ..IN_ORDER });
    assert!(matches!(tripped, Some((301..350, TripReason::SensorsDisagree))), "{tripped:?}");
}

#[test]
fn a_t1_that_comes_and_goes_answers_no_full_power() {
    let gone = |tick: u32| Shown {
        t1: 37.0,
        t2: 36.0,
        pid: 100.0,
        validity: if tick % 4 < 3 { t1(Validity::Missing).validity } else { [Validity::Good; 2] },
        ..IN_ORDER
    };
    let there = |tick: u32| Shown { validity: [Validity::Good; 2], ..gone(tick) };
    assert!(matches!(first_trip(there), Some((70..80, TripReason::NoResponse))));
    assert_eq!(first_trip(gone), first_trip(there));
}

/// Three thermistors in warm air, or a T0 that reads wrong beside a warm rig: no room is warm at once.
#[test]
fn the_room_grows_no_warmer_than_a_room_can() {
    let excess = |warm_t0: f32, for_ticks: u32| {
        let mut bench = Bench::new();
        for tick in 0..for_ticks {
            bench.step(tick, &Shown { t0: warm_t0, t1: 40.0, t2: 40.0, pid: 0.0, ..IN_ORDER });
        }
        bench.trips(true, |_| Shown { pid: 85.0, ..IN_ORDER })
    };
    for t0 in [ROOM, 40.0] {
        let tripped = excess(t0, 60);
        assert!(matches!(tripped, Some((45..55, TripReason::ExcessPower))), "{t0}: {tripped:?}");
    }
    let down = excess(0.0, 60);
    assert!(
        !matches!(down, Some((_, TripReason::ExcessPower))),
        "down at once: more power is needed: {down:?}"
    );
    // What a T0 in the warm air says does not make a rig cold that is hot without power.
    let hot = |tick| Shown { t0: 40.0, ..stays_hot(tick) };
    assert!(matches!(first_trip(hot), Some((_, TripReason::HeaterStuckOn))));
}

/// A rig that needs 6.5 %: noise and excitation may double that, but for 8 % more at least.
#[test]
fn little_power_is_no_excess_though_it_is_twice_what_is_needed() {
    let tripped = |pid| {
        let mut bench = Bench::new();
        bench.supervisor.restored(&mut bench.state, &learnt(2.0, 1.0));
        bench.trips(true, |_| Shown { pid, ..IN_ORDER })
    };
    assert_eq!(tripped(14.4), None);
    assert!(matches!(tripped(14.7), Some((32..100, TripReason::ExcessPower))));
}

/// A cold rig is given more than its set-point needs for as long as it grows warmer.
#[test]
fn a_t1_that_rises_is_an_answer_to_excess_power() {
    let warms = |tick: u32| {
        let t1 = 0.07 * tick as f32 - 6.0; // more than 2 degC within `excess_power_time`
        Shown { t1, t2: t1 - 1.0, pid: 85.0, ..IN_ORDER }
    };
    assert_eq!(first_trip(warms), None);
    let by_two_in_all = |tick: u32| Shown { t1: if tick < 40 { 30.0 } else { 32.0 }, ..warms(tick) };
    assert_eq!(first_trip(by_two_in_all), Some((51, TripReason::ExcessPower)), "just not enough");
}

/// The room may have grown warmer meanwhile, so that less is asked of T1; never colder, so that a T1 that stands still seems to answer.
#[test]
fn a_rest_accounts_for_no_power() {
    let effect = Effect::new(ANSWER, TS);
    let trips = |t1: f32, rest: u32| {
        let mut state = EffectState::default();
        let mut step = |drive, heating| effect.step(&mut state, code(t1), Percent(drive), heating);
        step(20.0, true);
        for _ in 0..rest {
            step(0.0, false);
        }
        (0..10_000).position(|_| step(100.0, true))
    };
    for t1 in [15.0, 30.0] {
        assert_eq!((trips(t1, 0), trips(t1, 6000)), (Some(145), Some(145)), "{t1}");
    }
}
