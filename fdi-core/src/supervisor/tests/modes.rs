//! Modes, one tick after another: what is fit to be learnt from, when learning begins and ends, and which command does what in which mode.

use super::*;
use crate::supervisor::Command::{self, Acknowledge, Arm, Relearn, Stop};

/// Ticks: learning begins after 10 of heating, after 5 fit ones in a row, and takes 110.
const START: u32 = 10;
const STEADY: u32 = 5;
const ENOUGH: u32 = 110;
const SETPOINT: Celsius = Celsius(35.0);

struct Modes {
    supervisor: Supervisor,
    state: SupervisorState,
}

/// Changes what is seen on a tick.
type Change = fn(&mut Situation);

impl Modes {
    fn new(mode: Mode) -> Self {
        let ticks = |n: u32| Seconds(n as f32 * TS.0);
        let config = SupervisorConfig {
            learn_start: ticks(START),
            learn_end: ticks(START + ENOUGH),
            regulation_time: ticks(STEADY),
            ..SupervisorConfig::default()
        };
        let supervisor = Supervisor::new(&config, Percent(100.0), &plant(), TS).expect("valid");
        let state = SupervisorState { setpoint: SETPOINT, mode, ..SupervisorState::default() };
        Self { supervisor, state }
    }

    /// In order but for `change`, with so many samples in the baseline.
    fn step(&mut self, learned: u32, change: Change) -> Decision {
        let feedback = Feedback { learned, ..Feedback::default() };
        situation(0, &IN_ORDER, SETPOINT.0, |now| {
            let mut now = Situation { feedback: &feedback, ..*now };
            change(&mut now);
            self.supervisor.step(&mut self.state, &now)
        })
    }

    /// In order for so long.
    fn steps(&mut self, ticks: u32) -> Decision {
        (0..ticks).map(|_| self.step(0, |_| ())).last().expect("a tick at least")
    }
}

const fn sample(t1: f32, t2: f32, of_t2: Validity) -> Sample {
    const fn reading(celsius: f32, validity: Validity) -> Reading {
        Reading { celsius: Celsius(celsius), validity }
    }
    Sample { t0: reading(ROOM, Validity::Good), t1: reading(t1, Validity::Good), t2: reading(t2, of_t2) }
}

static AT_REST: Sample = sample(ROOM, ROOM, Validity::Good);
static T2_LOST: Sample = sample(IN_ORDER.t1, IN_ORDER.t2, Validity::Missing);

fn lose_t2(now: &mut Situation) {
    now.sample = &T2_LOST;
}

/// What keeps a sample out, and whether what came before it still counts.
const DISTURBANCES: [(Change, Blocker, bool); 6] = [
    (|now| now.saturated = true, Blocker::Saturated, false),
    (|now| now.mean_error = None, Blocker::OutOfRegulation, false),
    (|now| now.mean_error = Some(-0.05 * SETPOINT.0), Blocker::OutOfRegulation, false),
    (|now| now.setpoint = Celsius(36.0), Blocker::OutOfRegulation, false),
    (|now| now.excited = false, Blocker::Unexcited, false),
    (lose_t2, Blocker::InvalidSample, true),
];

#[test]
fn a_disturbance_is_told_and_begins_anew_where_it_is_more_than_a_missing_sample() {
    for (number, (change, blocker, goes_on)) in DISTURBANCES.into_iter().enumerate() {
        for (mode, learned) in [(Mode::Settle { steady: 3 }, 0), (Mode::Learn { accepted: 7 }, 7)] {
            let mut modes = Modes::new(mode);
            modes.state.elapsed = START;
            let decision = modes.step(learned, change);
            assert_eq!(decision.blocked, Some(blocker), "{number}, {mode:?}");
            assert!(!decision.learn && !decision.forget, "{number}, {mode:?}");
            let after = if goes_on { mode } else { Mode::Settle { steady: 0 } };
            assert_eq!(modes.state.mode, after, "{number}, {mode:?}");
        }
    }
    let mut nearly = Modes::new(Mode::Learn { accepted: 7 });
    let decision = nearly.step(7, |now| now.mean_error = Some(0.049 * SETPOINT.0));
    assert!(decision.learn && decision.blocked.is_none());
}

#[test]
fn learning_begins_by_the_clock_once_it_has_been_steady() {
    let mut modes = Modes::new(Mode::Settle { steady: 0 });
    for tick in 1..=START {
        let decision = modes.steps(1);
        assert_eq!((modes.state.mode, decision.blocked), (Mode::Settle { steady: tick }, None));
        assert!(!decision.learn);
    }
    let decision = modes.steps(1);
    assert_eq!(modes.state.mode, Mode::Learn { accepted: 1 });
    assert!(decision.learn && decision.blocked.is_none());

    let mut late = Modes::new(Mode::Settle { steady: 0 });
    late.steps(START - 1);
    let blocked = late.step(0, |now| now.excited = false).blocked;
    assert_eq!(blocked, None, "it is not due yet");
    for steady in 1..=STEADY {
        assert_eq!(late.steps(1).blocked, Some(Blocker::NotSteady));
        assert_eq!(late.state.mode, Mode::Settle { steady });
    }
    assert!(late.steps(1).learn);
    assert_eq!(late.state.mode, Mode::Learn { accepted: 1 });
}

#[test]
fn learning_ends_when_both_halves_have_enough() {
    let mut modes = Modes::new(Mode::Learn { accepted: 1 });
    let mut learnt = 0;
    for accepted in 1..=ENOUGH {
        assert_eq!(modes.state.mode, Mode::Learn { accepted });
        learnt += u32::from(modes.step(accepted - 1, |_| ()).learn);
    }
    assert_eq!(learnt, ENOUGH);
    assert!(modes.step(ENOUGH - 1, |_| ()).learn, "the second half has one too few");
    assert!(!modes.step(ENOUGH, |_| ()).learn);
    assert_eq!(modes.state.mode, Mode::Monitor);

    let mut modes = Modes::new(Mode::Learn { accepted: ENOUGH - 1 });
    modes.step(1000, |_| ());
    assert_eq!(modes.state.mode, Mode::Learn { accepted: ENOUGH }, "of an earlier baseline");
    modes.step(1000, lose_t2);
    assert_eq!(modes.state.mode, Mode::Monitor, "nothing is missing any more");
    assert_eq!(modes.step(1000, |now| now.saturated = true).blocked, None);
    assert_eq!(modes.state.mode, Mode::Monitor, "what disturbs keeps nothing from being watched");
}

/// The second half is asked what it has learnt, and what there was to learn.
#[test]
fn models_that_give_nothing_to_learn_are_told_but_end_nothing() {
    let mut modes = Modes::new(Mode::Learn { accepted: 5 + UNIDENTIFIED - 1 });
    let decision = modes.step(5, |_| ());
    assert!(decision.learn && decision.blocked.is_none());
    let decision = modes.step(5, |_| ());
    assert!(decision.learn && decision.blocked == Some(Blocker::NotIdentified));
    assert!(modes.step(6, |_| ()).blocked == Some(Blocker::NotIdentified));
    assert_eq!(modes.step(5 + UNIDENTIFIED, |_| ()).blocked, None);
}

#[test]
fn what_was_restored_is_watched_without_the_clock_until_it_is_forgotten() {
    let mut modes = Modes::new(Mode::Settle { steady: 0 });
    modes.supervisor.restored(&mut modes.state, &learnt(0.3, 1.0));
    for steady in 1..=STEADY {
        assert_eq!(modes.steps(1).blocked, Some(Blocker::NotSteady));
        assert_eq!(modes.state.mode, Mode::Settle { steady });
    }
    modes.steps(1);
    assert_eq!(modes.state.mode, Mode::Monitor);

    modes.supervisor.command(&mut modes.state, Relearn).expect("possible");
    assert_eq!(modes.state.mode, Mode::Settle { steady: 0 });
    assert!(modes.step(0, |_| ()).forget, "told once");
    assert!(!modes.step(0, |_| ()).forget);
    assert!(modes.state.account.learnt.is_none());
    modes.steps(START);
    assert!(
        matches!(modes.state.mode, Mode::Learn { .. }),
        "by the clock, from arming on: {:?}",
        modes.state.mode
    );
}

/// What the rules go by is learnt along with the baseline: from its first sample, and in force with its last.
#[test]
fn power_and_temperatures_are_learnt_with_the_baseline() {
    let mut modes = Modes::new(Mode::Off);
    for _ in 0..5 {
        modes.step(0, |now| now.sample = &AT_REST);
    }
    modes.state.mode = Mode::Settle { steady: STEADY };
    modes.state.elapsed = START;
    for _ in 0..5 {
        modes.step(0, |now| now.pid = Percent(50.0));
    }
    assert_eq!(modes.state.mode, Mode::Learn { accepted: 5 });
    // A new set-point begins anew, and so does what is learnt.
    modes.step(0, |now| now.setpoint = Celsius(36.0));
    modes.state.mode = Mode::Settle { steady: STEADY };
    modes.step(0, |now| now.saturated = true);
    modes.state.mode = Mode::Settle { steady: STEADY };
    for tick in 0..=ENOUGH {
        assert!(modes.state.account.learnt.is_none(), "{tick}");
        modes.step(tick, |_| ());
    }
    assert_eq!(modes.state.mode, Mode::Monitor);
    let needed = modes.state.account.power_for(Celsius(38.0)).expect("learnt");
    assert!((needed - 50.0).abs() < 1e-3, "8 degC at 25 %, so 16 at 50: {needed}");
    let warmer = modes.state.account;
    modes.steps(100);
    assert_eq!(
        modes.state.account.power_for(Celsius(38.0)),
        warmer.power_for(Celsius(38.0)),
        "no room while it heats"
    );
}

#[test]
fn a_trip_keeps_its_reason_whatever_comes_after_it() {
    let mut bench = Bench::new();
    let (tick, reason) = bench.trips(true, |_| t1(Validity::Open)).expect("trips");
    let tripped = bench.state.mode;
    bench.step(tick + 1, &Shown { by_models: true, ..IN_ORDER });
    assert_eq!((bench.state.hazard, reason), (Some(TripReason::HeaterStuckOn), TripReason::T1Open));
    assert_eq!(bench.state.mode, tripped);
}

/// Each command in each mode: the mode after it, or the word of its refusal; and the same where something is dangerous.
#[test]
fn each_command_does_in_each_mode_what_the_diagram_says() {
    let tripped = Mode::Tripped(Trip {
        reason: TripReason::T1Lost,
        tick: 0,
        raw: RawSample::default(),
        sample: AT_REST,
        setpoint: SETPOINT,
        limit: Celsius(75.0),
        power: Percent(0.0),
        needed: None,
    });
    let modes = [
        Mode::Off,
        Mode::Settle { steady: 3 },
        Mode::Learn { accepted: 3 },
        Mode::Monitor,
        Mode::Tune,
        tripped,
    ];
    let others = [Command::SetPoint(SETPOINT), Command::Excite(true), Command::Fan(Percent(50.0))];
    let same = modes.map(|mode| mode.name());
    let no = "not possible";
    let persists = "persists";
    let table = [
        (Arm, ["settle", no, no, no, no, no], [persists, no, no, no, no, no]),
        (Command::Tune, ["tune", no, no, no, no, no], [persists, no, no, no, no, no]),
        (Acknowledge, [no, no, no, "monitor", no, "off"], [no, no, no, "monitor", no, persists]),
        (Command::Shelve(Seconds(60.0)), [no, no, no, "monitor", no, no], [no, no, no, "monitor", no, no]),
        (
            Relearn,
            ["off", "settle", "settle", "settle", no, no],
            ["off", "settle", "settle", "settle", no, no],
        ),
        (
            Stop,
            ["off", "off", "off", "off", "off", "tripped"],
            ["off", "off", "off", "off", "off", "tripped"],
        ),
    ];
    let changes_no_mode = others.map(|command| (command, same, same));
    for (command, without, with) in table.into_iter().chain(changes_no_mode) {
        for (hazard, expected) in [(None, without), (Some(TripReason::T1Open), with)] {
            for (mode, expected) in modes.into_iter().zip(expected) {
                let mut bench = Modes::new(mode);
                bench.state.hazard = hazard;
                let said = match bench.supervisor.command(&mut bench.state, command) {
                    Ok(()) => bench.state.mode.name(),
                    Err(Refusal::NotInMode(name)) if name == mode.name() => no,
                    Err(Refusal::CausePersists(reason)) if Some(reason) == hazard => persists,
                    Err(other) => unreachable!("{other}"),
                };
                assert_eq!(said, expected, "{command:?} in {mode:?}, {hazard:?}");
                if said == no || said == persists {
                    assert_eq!(bench.state.mode, mode);
                }
            }
        }
    }
}

/// An alarm is shelved for a bounded time.
#[test]
fn what_is_shelved_is_handed_on_and_no_time_without_bounds_is_taken() {
    let mut bench = Modes::new(Mode::Monitor);
    for time in [f32::NAN, -1.0, 86_401.0, f32::INFINITY] {
        let said = bench.supervisor.command(&mut bench.state, Command::Shelve(Seconds(time)));
        assert!(matches!(said, Err(Refusal::Shelving(_))), "{time}: {said:?}");
    }
    assert_eq!(bench.state.shelve, None);
    for (command, told) in [
        (Command::Shelve(Seconds(11.0)), Shelving::For(100)),
        (Command::Shelve(Seconds(0.0)), Shelving::For(0)),
        (Acknowledge, Shelving::UntilItEnds),
    ] {
        bench.supervisor.command(&mut bench.state, command).expect("it monitors");
        assert_eq!(bench.state.shelve, Some(told));
    }
}
