//! The rules by themselves, shown one situation after another.

mod damage;
mod learning;
mod modes;
mod rules;

extern crate std;

use super::*;
use crate::diagnosis::baseline::Normal;
use crate::diagnosis::residual::Residual;
use crate::sense::{Reading, Validity};

const ROOM: f32 = 22.0;
const TS: Seconds = Seconds(0.11);
/// Longer than any rule takes, in ticks: 66 s.
const LONG: u32 = 600;

/// What a supervisor is shown on a tick. As it is by default the rig is warm and in order.
#[derive(Clone, Copy)]
struct Shown {
    t0: f32,
    t1: f32,
    t2: f32,
    /// Of T1 and T2.
    validity: [Validity; 2],
    pid: f32,
    /// The virtual T1 is regulated, and what it is where it is known.
    virtual_t1: Option<Option<f32>>,
    by_models: bool,
    fan: Option<f32>,
    air_flow: Option<f32>,
}

const IN_ORDER: Shown = Shown {
    t0: ROOM,
    t1: 30.0,
    t2: 29.0,
    validity: [Validity::Good; 2],
    pid: 25.0,
    virtual_t1: None,
    by_models: false,
    fan: None,
    air_flow: None,
};
const VIRTUAL: Shown = Shown { virtual_t1: Some(Some(30.0)), ..IN_ORDER };
const VIRTUAL_HOT: Shown = Shown { virtual_t1: Some(Some(75.1)), ..IN_ORDER };

/// What is dangerous: its name, whether it is armed, what is shown at a tick; the tick on which it trips, and on what.
type Danger = (&'static str, bool, fn(u32) -> Shown, u32, TripReason);

const DANGERS: [Danger; 23] = [
    ("T1 hot", true, |_| Shown { t1: 75.1, ..IN_ORDER }, 0, TripReason::T1OverTemperature),
    ("T2 hot", true, |_| Shown { t2: 75.1, ..IN_ORDER }, 0, TripReason::T2OverTemperature),
    ("virtual T1 hot", true, |_| Shown { t2: 75.0, ..VIRTUAL_HOT }, 0, TripReason::T1OverTemperature),
    ("T2 hot, T1 virtual", true, |_| Shown { t2: 75.1, ..VIRTUAL }, 0, TripReason::T2OverTemperature),
    ("T1 open", true, |_| t1(Validity::Open), 0, TripReason::T1Open),
    ("T1 short", true, |_| t1(Validity::Short), 0, TripReason::T1Short),
    ("T1 out of range", true, |_| t1(Validity::OutOfRange), 0, TripReason::T1OutOfRange),
    // `signal_timeout`: 5 ticks pass.
    ("T1 lost", true, |_| t1(Validity::Missing), 5, TripReason::T1Lost),
    ("T1 jumps", true, |_| t1(Validity::Rate), 5, TripReason::T1Lost),
    ("T1 stuck", true, |_| t1(Validity::Stuck), 5, TripReason::T1Stuck),
    ("virtual T1 lost", true, |_| Shown { virtual_t1: Some(None), ..IN_ORDER }, 5, TripReason::T1Lost),
    // `disagreement_time`: 11 ticks pass.
    ("T1 out", true, |_| Shown { t1: ROOM, t2: 27.0, ..IN_ORDER }, 13, TripReason::SensorsDisagree),
    ("excess power", true, |_| Shown { pid: 85.0, ..IN_ORDER }, 21, TripReason::ExcessPower),
    ("T1 cold", true, |_| Shown { t1: ROOM, t2: ROOM, pid: 43.0, ..IN_ORDER }, 30, TripReason::ExcessPower),
    ("more warmth than power", true, |_| Shown { pid: 5.0, ..IN_ORDER }, 17, TripReason::AirFlowLost),
    ("little air announced", true, |_| Shown { fan: Some(49.0), ..IN_ORDER }, 0, TripReason::AirFlowLost),
    ("no air announced", true, |_| Shown { fan: Some(4.0), ..IN_ORDER }, 0, TripReason::AirFlowLost),
    ("little air found", true, |_| Shown { air_flow: Some(49.0), ..IN_ORDER }, 0, TripReason::AirFlowLost),
    ("heater stuck on", true, |_| Shown { by_models: true, ..IN_ORDER }, 0, TripReason::HeaterStuckOn),
    // 0.1 degC a tick, and warm from 8 degC on.
    ("heats unasked", false, heats_unasked, 87, TripReason::HeaterStuckOn),
    // When the mean power has gone a tenth must be lost in every `cooling_time`; while armed, all that no power explains.
    ("stays hot unasked", false, stays_hot, 125, TripReason::HeaterStuckOn),
    ("stays hot, armed", true, stays_hot, 21, TripReason::HeaterStuckOn),
    ("stays hot, no T2", true, stays_hot_without_t2, 21, TripReason::HeaterStuckOn),
];

/// What is just not.
const ALLOWED: [fn(u32) -> Shown; 10] = [
    |_| IN_ORDER,
    |_| Shown { t1: 75.0, t2: 75.0, pid: 100.0, ..IN_ORDER },
    |_| Shown { virtual_t1: Some(Some(75.0)), t2: 75.0, pid: 100.0, ..IN_ORDER },
    |_| Shown { t2: 76.0, validity: [Validity::Good, Validity::Missing], ..IN_ORDER },
    |_| Shown { t1: ROOM, t2: 26.5, pid: 8.0, ..IN_ORDER },
    |_| Shown { t1: 37.0, t2: 36.0, pid: 83.0, ..IN_ORDER },
    |_| Shown { pid: 57.0, ..IN_ORDER },
    |_| Shown { pid: 10.1, ..IN_ORDER },
    |_| Shown { fan: Some(50.0), air_flow: Some(50.0), ..IN_ORDER },
    |tick| if tick % 6 == 5 { IN_ORDER } else { t1(Validity::Missing) },
];

fn t1(validity: Validity) -> Shown {
    Shown { validity: [validity, Validity::Good], ..IN_ORDER }
}

fn stays_hot_without_t2(tick: u32) -> Shown {
    Shown { validity: [Validity::Good, Validity::Open], ..stays_hot(tick) }
}

fn heats_unasked(tick: u32) -> Shown {
    let t = ROOM + 0.1 * tick as f32;
    Shown { t1: t, t2: t, pid: 0.0, ..IN_ORDER }
}

/// Power for a moment, and hot ever after.
fn stays_hot(tick: u32) -> Shown {
    let pid = if tick < 10 { 50.0 } else { 0.0 };
    Shown { t1: 40.0, t2: 39.0, pid, ..IN_ORDER }
}

fn situation<R>(tick: u32, shown: &Shown, setpoint: f32, look: impl FnOnce(&Situation) -> R) -> R {
    let reading = |t, validity| Reading { celsius: Celsius(t), validity };
    let [t1, t2] = shown.validity;
    let t1 = if shown.virtual_t1.is_some() { Validity::Stuck } else { t1 };
    let (t0, t1, t2) = (reading(shown.t0, Validity::Good), reading(shown.t1, t1), reading(shown.t2, t2));
    let sample = Sample { t0, t1, t2 };
    let value = shown.virtual_t1.unwrap_or(t1.good()).map(Celsius);
    look(&Situation {
        tick,
        raw: RawSample::default(),
        sample: &sample,
        regulated: Regulated { value, is_virtual: shown.virtual_t1.is_some() },
        mean_error: Some(0.0),
        setpoint: Celsius(setpoint),
        pid: Percent(shown.pid),
        drive: Percent(shown.pid),
        saturated: false,
        excited: true,
        known: &KnownInputs { fan: shown.fan.map(Percent), ..KnownInputs::default() },
        feedback: &Feedback {
            air_flow: shown.air_flow.map(Percent),
            heater_stuck_on: shown.by_models,
            ..Feedback::default()
        },
    })
}

/// A supervisor with its memory, and the set-point, all of which can be damaged.
struct Bench {
    supervisor: Supervisor,
    state: SupervisorState,
    setpoint: f32,
}

impl Bench {
    /// At rest, with what was learnt of a rig: 0.3 degC per %, T1 1 degC above T2.
    fn new() -> Self {
        let supervisor = Supervisor::of(&SupervisorConfig::default(), Percent(100.0), &plant(), TS);
        let mut bench = Self { supervisor, state: SupervisorState::default(), setpoint: 35.0 };
        bench.supervisor.restored(&mut bench.state, &learnt(0.3, 1.0));
        for tick in 0..20 {
            bench.step(tick, &Shown { t1: ROOM, t2: ROOM, pid: 0.0, ..IN_ORDER });
        }
        bench
    }

    fn step(&mut self, tick: u32, shown: &Shown) {
        situation(tick, shown, self.setpoint, |now| {
            let _ = self.supervisor.step(&mut self.state, now);
        });
    }

    /// After how many ticks of this danger it trips, and on what. Off already, it is enough that nothing arms.
    fn trips(&mut self, armed: bool, shown: impl Fn(u32) -> Shown) -> Option<(u32, TripReason)> {
        if armed {
            self.state.mode = Mode::Settle { steady: 0 };
        }
        (0..LONG).find_map(|tick| {
            self.step(tick, &shown(tick));
            match self.state.mode {
                Mode::Tripped(trip) => Some((tick, trip.reason)),
                Mode::Off => self.state.hazard.map(|reason| (tick, reason)),
                _ => None,
            }
        })
    }
}

/// What is declared of the rig.
fn plant() -> IdentificationConfig {
    IdentificationConfig::default()
}

fn learnt(gain: f32, t1_over_t2: f32) -> Baseline {
    let mut raw = Normal::default();
    raw.mean[Residual::Rsg1 as usize] = gain;
    // At a rise of T1 by 8 degC, as in `IN_ORDER`.
    raw.mean[Residual::Rsg2 as usize] = gain * (1.0 - t1_over_t2 / 8.0);
    raw.mean[Residual::Ry12 as usize] = t1_over_t2;
    Baseline { samples: 1000, raw, filtered: raw }
}

#[test]
fn each_danger_trips_by_its_rule_and_what_is_allowed_does_not() {
    let tripped = DANGERS.map(|(name, armed, shown, ..)| (name, Bench::new().trips(armed, shown)));
    assert_eq!(tripped, DANGERS.map(|(name, .., tick, reason)| (name, Some((tick, reason)))));
    for (number, shown) in ALLOWED.into_iter().enumerate() {
        assert_eq!(Bench::new().trips(true, shown), None, "allowed {number}");
    }
}

/// What is seen between two ticks: one sample, and nothing of before.
#[test]
fn one_sample_is_a_hazard_by_itself_where_it_is_too_hot_or_t1_is_broken() {
    let supervisor = Bench::new().supervisor;
    let is_hazardous = |shown: Shown, virtual_t1| {
        situation(0, &shown, 35.0, |now| supervisor.is_hazardous(now.sample, virtual_t1))
    };
    for broken in [Validity::Open, Validity::Short, Validity::OutOfRange] {
        assert!(is_hazardous(t1(broken), false) && !is_hazardous(t1(broken), true), "{broken:?}");
    }
    assert!(is_hazardous(Shown { t1: 75.1, ..IN_ORDER }, false));
    assert!(!is_hazardous(Shown { t1: 75.1, ..IN_ORDER }, true));
    for virtual_t1 in [false, true] {
        assert!(is_hazardous(Shown { t2: 75.1, ..IN_ORDER }, virtual_t1));
        assert!(!is_hazardous(Shown { t1: 75.0, t2: 75.0, ..IN_ORDER }, virtual_t1));
    }
    for doubtful in [Validity::Missing, Validity::Spike, Validity::Rate, Validity::Stuck] {
        assert!(!is_hazardous(t1(doubtful), false), "{doubtful:?}");
    }
}
