//! The rules by themselves, shown one situation after another.

mod damage;
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
    virtual_t1: Option<f32>,
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
    fan: None,
    air_flow: None,
};
/// Of a T1 without a sample.
const LOST: [Validity; 2] = [Validity::Missing, Validity::Good];

/// What is dangerous: its name, whether it is armed, what is shown at a tick, and what it trips on.
type Danger = (&'static str, bool, fn(u32) -> Shown, TripReason);

const DANGERS: [Danger; 14] = [
    ("T1 hot", true, |_| Shown { t1: 76.0, ..IN_ORDER }, TripReason::T1OverTemperature),
    ("T2 hot", true, |_| Shown { t2: 76.0, ..IN_ORDER }, TripReason::T2OverTemperature),
    (
        "virtual T1 hot",
        true,
        |_| Shown { virtual_t1: Some(76.0), ..IN_ORDER },
        TripReason::T1OverTemperature,
    ),
    (
        "T2 hot, T1 virtual",
        true,
        |_| Shown { virtual_t1: Some(30.0), t2: 76.0, ..IN_ORDER },
        TripReason::T2OverTemperature,
    ),
    ("T1 lost", true, |_| Shown { validity: LOST, ..IN_ORDER }, TripReason::T1Lost),
    ("T1 out", true, |_| Shown { t1: ROOM, t2: 45.0, pid: 60.0, ..IN_ORDER }, TripReason::SensorsDisagree),
    // Above the set-point no power is too much for it.
    ("no answer", true, |_| Shown { t1: 37.0, t2: 36.0, pid: 100.0, ..IN_ORDER }, TripReason::NoResponse),
    ("excess power", true, |_| Shown { pid: 85.0, ..IN_ORDER }, TripReason::ExcessPower),
    ("little air announced", true, |_| Shown { fan: Some(20.0), ..IN_ORDER }, TripReason::AirFlowLost),
    ("no air announced", true, |_| Shown { fan: Some(3.0), ..IN_ORDER }, TripReason::AirFlowLost),
    ("little air found", true, |_| Shown { air_flow: Some(20.0), ..IN_ORDER }, TripReason::AirFlowLost),
    ("heats unasked", false, heats_unasked, TripReason::HeaterStuckOn),
    ("stays hot unasked", false, stays_hot, TripReason::HeaterStuckOn),
    ("stays hot, armed", true, stays_hot, TripReason::HeaterStuckOn),
];

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
    let (t0, t1, t2) =
        (reading(shown.t0, Validity::Good), reading(shown.t1, t1), reading(shown.t2, t2));
    let sample = Sample { t0, t1, t2 };
    let value = shown.virtual_t1.or(t1.good()).map(Celsius);
    look(&Situation {
        tick,
        raw: RawSample::default(),
        sample: &sample,
        regulated: Regulated { value, is_virtual: shown.virtual_t1.is_some() },
        mean_error: Some(0.0),
        setpoint: Celsius(setpoint),
        pid: Percent(shown.pid),
        saturated: false,
        excited: true,
        known: &KnownInputs { fan: shown.fan.map(Percent), ..KnownInputs::default() },
        feedback: &Feedback { air_flow: shown.air_flow.map(Percent), ..Feedback::default() },
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
        let supervisor = Supervisor::new(&SupervisorConfig::default(), Percent(100.0), TS).expect("valid");
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

fn learnt(gain: f32, t1_over_t2: f32) -> Baseline {
    let mut raw = Normal::default();
    raw.mean[Residual::Rsg1 as usize] = gain;
    raw.mean[Residual::Ry12 as usize] = t1_over_t2;
    Baseline { samples: 1000, raw, filtered: raw }
}

#[test]
fn each_danger_trips_by_its_rule_and_what_is_in_order_does_not() {
    for (name, armed, shown, reason) in DANGERS {
        let tripped = Bench::new().trips(armed, shown).map(|(_, reason)| reason);
        assert_eq!(tripped, Some(reason), "{name}");
    }
    assert_eq!(Bench::new().trips(true, |_| IN_ORDER), None);
}
