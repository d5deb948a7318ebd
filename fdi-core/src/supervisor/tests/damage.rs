//! A limit, or a part of the memory, that is no number: a flipped bit must not disarm a rule.

use super::*;
use crate::settings::{Fields, Kind, Value};

/// A trip may come so many ticks later than without the damage: the mean power begins anew, the slowest over four answer times.
const LATER: u32 = 60;

/// Whatever `damage` has done to it, it trips on each danger about as soon as without.
fn trips_all_the_same(name: &str, damage: impl Fn(&mut Bench)) {
    for (danger, armed, shown, ..) in DANGERS {
        let (intact, _) = Bench::new().trips(armed, shown).expect("it trips");
        let mut bench = Bench::new();
        damage(&mut bench);
        let damaged = bench.trips(armed, shown);
        assert!(
            damaged.is_some_and(|(tick, _)| tick <= intact + LATER),
            "{name} is no number, {danger}: {damaged:?}, expected a trip {intact} ticks after it"
        );
    }
}

#[test]
fn a_limit_that_is_no_number_trips() {
    let numbers =
        SupervisorConfig::SETTINGS[0].iter().filter(|setting| matches!(setting.kind, Kind::Number { .. }));
    let mut tried = 0;
    for setting in numbers {
        let mut config = SupervisorConfig::default();
        let field = config.field_mut(setting.index.into()).expect("it is a setting");
        assert!(field.set(Value::Number(f32::NAN)));
        let damaged = Supervisor::of(&config, Percent(100.0), &plant(), TS);
        trips_all_the_same(setting.name, |bench| bench.supervisor = damaged);
        tried += 1;
    }
    assert!(tried > 10, "{tried}");
    let config = SupervisorConfig::default();
    let no_output = Supervisor::of(&config, Percent(f32::NAN), &plant(), TS);
    trips_all_the_same("pid.output_max", |bench| bench.supervisor = no_output);
    let no_time = Supervisor::of(&config, Percent(100.0), &plant(), Seconds(f32::NAN));
    trips_all_the_same("sample_time", |bench| bench.supervisor = no_time);
}

#[test]
fn a_memory_that_is_no_number_disarms_no_rule() {
    for nonsense in [f32::NAN, f32::INFINITY, -1e38, 1e38] {
        trips_all_the_same("account", |bench| bench.state.account.damage(nonsense));
        // Whatever was learnt, a T2 that is hotter than T1 by twice the limit is too hot.
        let mut bench = Bench::new();
        bench.supervisor.restored(&mut bench.state, &learnt(0.3, -nonsense.abs()));
        let tripped = bench.trips(true, |_| Shown { t1: ROOM, t2: 33.1, ..IN_ORDER });
        assert_eq!(tripped, Some((11, TripReason::SensorsDisagree)), "learnt difference {nonsense}");
    }
    trips_all_the_same("learnt difference", |bench| {
        bench.supervisor.restored(&mut bench.state, &learnt(0.3, f32::NAN));
    });
    trips_all_the_same("learnt gain", |bench| {
        bench.supervisor.restored(&mut bench.state, &learnt(f32::NAN, 1.0));
    });
    let virtual_t1 = |_| Shown { virtual_t1: Some(Some(f32::NAN)), ..IN_ORDER };
    assert_eq!(Bench::new().trips(true, virtual_t1), Some((0, TripReason::T1OverTemperature)));
    trips_all_the_same("set-point", |bench| bench.setpoint = f32::NAN);
}
