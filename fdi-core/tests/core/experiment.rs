//! The experiment that tunes the PID, as a mode of the supervisor: whatever happens in it, it ends in off or trips.

use fdi_core::tune::{Standing, Unclear};
use fdi_core::{AdcCode, Command, Config, Instrument, Mode, RawSample, Refusal, RetuneError, TripReason};

use crate::supervision::{AMBIENT, armed, tick};

/// An order before the tick after its end begins from off, as any other does.
#[test]
fn arming_right_after_an_experiment_begins_anew() {
    let mut config = Config::default();
    (config.supervisor.learn_start.0, config.pid.output_max.0) = (5.0, 20.0);
    let mut instrument = Instrument::new(&config).unwrap();
    instrument.command(Command::Tune).unwrap();
    let ends = |tick: &fdi_core::Tick| matches!(tick.tuning, Some(Standing::Over(_)));
    assert!((0..2000).any(|k| ends(&tick(&mut instrument, AMBIENT, k))));
    instrument.command(Command::Arm).unwrap();
    let first = tick(&mut instrument, AMBIENT, 1);
    assert_eq!(first.blocked, None, "learning is not due yet");
    assert!(matches!(first.mode, Mode::Settle { .. }));
}

/// A thermistor that stands still while the relay moves the heater is stuck, and regulates nothing.
#[test]
fn an_experiment_on_a_t1_that_stands_still_ends() {
    let mut instrument = Instrument::new(&Config::default()).unwrap();
    instrument.command(Command::Tune).unwrap();
    let (mut code, mut k) = (AMBIENT, 0);
    let last = loop {
        let last = tick(&mut instrument, code, k);
        match last.tuning {
            Some(Standing::Swing) => break last,
            Some(Standing::Over(_)) => panic!("{last:?}"),
            _ => code += 0.1 * (AMBIENT - 10.0 * last.drive.0 - code),
        }
        k += 1;
    };
    assert!(last.drive.0 > 0.0);
    let still =
        RawSample { t0: AdcCode(AMBIENT), t1: AdcCode(code), t2: AdcCode(code), ..RawSample::default() };
    let ended = (0..60).map(|_| instrument.control(still)).find(|tick| tick.drive.0 == 0.0);
    let ended = ended.expect("3 s without any change are no live thermistor");
    assert_eq!(ended.tuning, Some(Standing::Over(Err(Unclear::NoSample))));
}

fn tuning() -> Instrument {
    let mut instrument = Instrument::new(&Config::default()).unwrap();
    instrument.command(Command::Tune).unwrap();
    // The experiment is at rest first; with T1 at rest for good it then heats.
    let heats = (0..100).map(|k| tick(&mut instrument, AMBIENT, k)).any(|tick| tick.drive.0 > 0.0);
    assert!(heats);
    instrument
}

#[test]
fn an_experiment_trips_in_the_same_tick_and_says_that_it_is_over() {
    let mut instrument = tuning();
    assert_eq!(tick(&mut instrument, AMBIENT, 0).tuning, Some(Standing::Warm));
    let tripped = tick(&mut instrument, 4094.0, 0);
    let Mode::Tripped(trip) = tripped.mode else { panic!("{:?}", tripped.mode) };
    assert_eq!((trip.reason, tripped.drive.0), (TripReason::T1Open, 0.0));
    assert_eq!(tripped.tuning, Some(Standing::Over(Err(Unclear::Stopped))));
    assert_eq!(tick(&mut instrument, AMBIENT, 1).tuning, None, "said once");
    assert_eq!(instrument.command(Command::Tune), Err(Refusal::NotInMode("tripped")));
}

/// Its heat is asked for, and not taken for a heater that is stuck on; nor is that of the answer that it waits for in vain.
#[test]
fn an_experiment_without_an_answer_ends_in_off() {
    // Power that shows nothing trips; so little that it may be harmless ends the experiment.
    let mut much = tuning();
    let tripped = (0..2000).map(|k| tick(&mut much, AMBIENT, k).mode).find(|mode| *mode != Mode::Tune);
    assert!(
        matches!(tripped, Some(Mode::Tripped(trip)) if trip.reason == TripReason::NoResponse),
        "{tripped:?}"
    );
    let mut config = Config::default();
    config.pid.output_max.0 = 20.0;
    let mut instrument = Instrument::new(&config).unwrap();
    instrument.command(Command::Tune).unwrap();
    let is_over = |tick: &fdi_core::Tick| matches!(tick.tuning, Some(Standing::Over(_)));
    let last = (0..2000).map(|k| tick(&mut instrument, AMBIENT, k)).find(is_over).expect("it ends");
    assert_eq!((last.mode, last.drive.0), (Mode::Off, 0.0));
    assert_eq!(last.tuning, Some(Standing::Over(Err(Unclear::NoAnswer))));
    assert_eq!(tick(&mut instrument, AMBIENT, 1).drive.0, 0.0);
}

#[test]
fn an_experiment_begins_from_off_alone_and_only_a_stop_or_its_end_leads_on() {
    let mut instrument = armed();
    assert_eq!(instrument.command(Command::Tune), Err(Refusal::NotInMode("settle")));
    let mut instrument = tuning();
    for command in [Command::Arm, Command::Tune, Command::Relearn, Command::Acknowledge] {
        assert_eq!(instrument.command(command), Err(Refusal::NotInMode("tune")));
    }
    let refused = instrument.retune(&Config::default());
    assert_eq!(refused, Err(RetuneError::Refused(Refusal::NotInMode("tune"))));
    instrument.command(Command::Stop).unwrap();
    let stopped = tick(&mut instrument, AMBIENT, 0);
    assert_eq!((stopped.mode, stopped.drive.0), (Mode::Off, 0.0));
    assert_eq!(stopped.tuning, Some(Standing::Over(Err(Unclear::Stopped))));
}

/// With a T1 that answers a little while T2 grows hot.
#[test]
fn an_experiment_on_a_t1_that_is_half_out_trips() {
    let mut instrument = tuning();
    for k in 0..1000 {
        let raw = |t1: f32, t2: f32| RawSample {
            t0: AdcCode(AMBIENT),
            t1: AdcCode(t1),
            t2: AdcCode(t2),
            ..RawSample::default()
        };
        let hot = AMBIENT - 4.0 * k as f32;
        let tick = instrument.control(raw(AMBIENT - 100.0 + (k % 2) as f32, hot));
        instrument.diagnose(&tick, tick.drive);
        if tick.drive.0 == 0.0 {
            let Mode::Tripped(trip) = tick.mode else { panic!("{:?} {:?}", tick.mode, tick.tuning) };
            return assert_eq!(trip.reason, TripReason::SensorsDisagree);
        }
    }
    panic!("it goes on");
}
