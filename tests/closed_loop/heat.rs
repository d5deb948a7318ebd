//! Heat without effect, and heat unasked: thermistors that come out of the tube and heaters that stay on, against the
//! simulated rig. What counts is how hot the air truly gets, and how soon the heater is off.

use fdi_core::supervisor::Blocker;
use fdi_core::{Celsius, Command, Config, Instrument, Mode, Refusal, Tick, TripReason};
use pt326_host::experiment::scenario::Scenario;
use pt326_host::experiment::{as_written, run, sample, with_prbs_phase};
use pt326_rig::fault::{Fault, Sensor, Verb};
use pt326_rig::{Disturbance, Rig, RigConfig};

/// When the faults begin that come after learning, s.
const LATE: f64 = 500.0;

/// An instrument on a rig of some gain, tuned to it as its user would.
struct Bench {
    instrument: Instrument,
    rig: Rig,
    sample_time: f64,
    setpoint: f64,
    time: f64,
}

/// What became of the heat.
#[derive(Debug, Default)]
struct Outcome {
    /// Highest air at T1 above the set-point since the onset, degC.
    overshoot: f64,
    /// Seconds from the onset until the heater was off, and why it was.
    off: Option<(f64, TripReason)>,
    /// Longest time at full power, s.
    saturated: f64,
}

impl Bench {
    fn new(gain: f64, setpoint: f32, ambient: f64, faults: &[Fault], seed: u64) -> Self {
        Self::with(&Config::default(), gain, setpoint, ambient, faults, seed)
    }

    fn with(base: &Config, gain: f64, setpoint: f32, ambient: f64, faults: &[Fault], seed: u64) -> Self {
        let mut config = Config { setpoint: Celsius(setpoint), ..with_prbs_phase(base, seed) };
        config.pid.kp *= 0.3 / gain as f32;
        config.prbs.amplitude.0 *= 0.3 / gain as f32;
        let sample_time = as_written(config.sample_time.0);
        let rig = RigConfig { gain, ambient, ..RigConfig::default() };
        let mut bench = Self {
            instrument: Instrument::new(&config).unwrap(),
            rig: Rig::new(&rig, Disturbance::Lively, sample_time, seed, faults),
            sample_time,
            setpoint: f64::from(setpoint),
            time: 0.0,
        };
        bench.tick();
        bench
    }

    fn armed(gain: f64, setpoint: f32, faults: &[Fault], seed: u64) -> Self {
        let mut bench = Self::new(gain, setpoint, 22.5, faults, seed);
        bench.instrument.command(Command::Arm).unwrap();
        bench
    }

    fn tick(&mut self) -> Tick {
        let tick = self.instrument.control(sample(&mut self.rig));
        self.rig.advance(f64::from(tick.drive.0));
        self.instrument.diagnose(&tick, tick.drive);
        self.time += self.sample_time;
        tick
    }

    fn run(&mut self, seconds: f64) -> Tick {
        let mut last = self.tick();
        for _ in 1..(seconds / self.sample_time) as u32 {
            last = self.tick();
        }
        last
    }

    /// Runs until the heater is off or `end`, and watches from `onset` on.
    fn watch(&mut self, onset: f64, end: f64) -> Outcome {
        let mut outcome = Outcome::default();
        let mut saturated = 0.0;
        while self.time < end && outcome.off.is_none() {
            let tick = self.tick();
            saturated = if tick.pid.0 >= 100.0 { saturated + self.sample_time } else { 0.0 };
            outcome.saturated = outcome.saturated.max(saturated);
            if self.time > onset {
                outcome.overshoot = outcome.overshoot.max(self.rig.air()[0] - self.setpoint);
            }
            if let Mode::Tripped(trip) = tick.mode {
                outcome.off = Some((self.time - onset, trip.reason));
            }
        }
        outcome
    }
}

fn fault(verb: Verb, sensor: Option<Sensor>, size: Option<f64>, at: f64) -> Fault {
    Fault::new(verb, sensor, size, at, 1e5)
}

/// A thermistor slides out of the tube in `over` s, by the share `size`.
fn out(sensor: Sensor, size: f64, over: f64, at: f64) -> Fault {
    Fault { over: (over > 0.0).then_some(over), ..fault(Verb::Detach, Some(sensor), Some(size), at) }
}

fn swapped(a: Sensor, b: Sensor, at: f64) -> Fault {
    Fault { with: Some(b), ..fault(Verb::Swap, Some(a), None, at) }
}

/// Gains in degC per %, and set-points that they reach.
const RIGS: [(f64, f32); 5] = [(0.3, 35.0), (0.6, 35.0), (1.0, 35.0), (0.6, 65.0), (1.0, 65.0)];
const BY_HEAT: [TripReason; 4] = [
    TripReason::SensorsDisagree,
    TripReason::T2OverTemperature,
    TripReason::NoResponse,
    TripReason::ExcessPower,
];

#[test]
fn a_t1_that_sees_too_little_is_switched_off_within_5_s() {
    use Sensor::{T0, T1};
    for (gain, setpoint) in RIGS {
        for onset in [0.0, LATE] {
            for (name, fault) in [
                ("out", out(T1, 1.0, 0.0, onset)),
                ("half out", out(T1, 0.5, 0.0, onset)),
                ("swapped with T0", swapped(T0, T1, onset)),
            ] {
                let outcome = Bench::armed(gain, setpoint, &[fault], 11).watch(onset, onset + 60.0);
                let place = format!("{name}, gain {gain}, {setpoint} degC, from {onset} s: {outcome:?}");
                let (delay, reason) = outcome.off.unwrap_or_else(|| panic!("never off: {place}"));
                assert!(BY_HEAT.contains(&reason), "{place}");
                // Before arming it takes a second until anything is warm enough to contradict.
                assert!(delay <= if onset > 0.0 { 5.0 } else { 6.0 }, "{place}");
            }
        }
    }
}

#[test]
fn a_t1_that_slides_out_slowly_overheats_by_less_than_10_degrees() {
    for (gain, setpoint) in RIGS {
        for over in [60.0, 600.0] {
            let slides = out(Sensor::T1, 1.0, over, LATE);
            // Nor is a virtual T1 believed against it.
            for go_on in [false, true] {
                let mut config = Config::default();
                config.supervisor.go_on_without_t1 = go_on;
                let mut bench = Bench::with(&config, gain, setpoint, 22.5, std::slice::from_ref(&slides), 12);
                bench.instrument.command(Command::Arm).unwrap();
                let outcome = bench.watch(LATE, LATE + over + 60.0);
                let place = format!("over {over} s, gain {gain}, {setpoint} degC, {go_on}: {outcome:?}");
                assert!(outcome.off.is_some() && outcome.overshoot < 10.0, "{place}");
            }
        }
    }
}

#[test]
fn with_both_out_the_power_itself_is_the_contradiction() {
    use Sensor::{T1, T2};
    let both = |onset| [out(T1, 1.0, 0.0, onset), out(T2, 1.0, 0.0, onset)];
    for (gain, setpoint) in RIGS {
        let learnt = Bench::armed(gain, setpoint, &both(LATE), 13).watch(LATE, LATE + 60.0);
        let (delay, seen) = learnt.off.expect("off");
        assert!(seen == TripReason::ExcessPower && delay < 5.0, "{gain}: {learnt:?}");
        for onset in [0.0, 100.0] {
            let unlearnt = Bench::armed(gain, setpoint, &both(onset), 13).watch(onset, onset + 60.0);
            assert_eq!(unlearnt.off.expect("off").1, TripReason::NoResponse, "{gain}: {unlearnt:?}");
            assert!(unlearnt.saturated <= 10.0, "{gain}, from {onset} s: {unlearnt:?}");
        }
    }
    let frozen = [out(T1, 1.0, 0.0, LATE), fault(Verb::Freeze, Some(T2), Some(0.0), LATE)];
    let outcome = Bench::armed(0.3, 35.0, &frozen, 14).watch(LATE, LATE + 60.0);
    assert!(outcome.off.expect("off").0 < 5.0, "{outcome:?}");
}

/// The instrument may be armed before it has seen a sample.
#[test]
fn a_heater_that_gives_too_little_trips_once_its_power_is_far_above_what_was_learnt() {
    let weak = fault(Verb::HeaterStuck, None, Some(20.0), 400.0);
    let scenario = Scenario { duration: 430.0, faults: vec![weak], ..Scenario::default() };
    let record = run(&Config::default(), &scenario, 15).unwrap();
    let Mode::Tripped(trip) = record.rows.last().unwrap().tick.mode else { panic!("still heating") };
    assert_eq!(trip.reason, TripReason::ExcessPower);
    let needed = trip.needed.expect("learnt").0;
    assert!((39.0..45.0).contains(&needed) && trip.power.0 > 1.75 * needed, "{trip:?}");
}

#[test]
fn what_was_learnt_outlives_a_trip_and_acts_at_once_after_arming_again() {
    use Sensor::{T1, T2};
    let both = [out(T1, 1.0, 0.0, LATE), out(T2, 1.0, 0.0, LATE)];
    let mut bench = Bench::armed(0.3, 35.0, &both, 15);
    bench.watch(LATE, LATE + 60.0).off.expect("trips");
    bench.run(60.0);
    bench.instrument.command(Command::Acknowledge).expect("nothing to be seen with the heater off");
    bench.tick();
    bench.instrument.command(Command::Arm).unwrap();
    let again = bench.watch(bench.time, bench.time + 60.0);
    let (delay, reason) = again.off.expect("trips again");
    assert!(reason == TripReason::ExcessPower && delay < 8.0, "{again:?}");

    // Whoever has changed the rig on purpose has it learn anew: then there is nothing to compare with.
    bench.run(60.0);
    bench.instrument.command(Command::Acknowledge).unwrap();
    bench.tick();
    bench.instrument.command(Command::Relearn).expect("possible while off");
    bench.instrument.command(Command::Arm).unwrap();
    let anew = bench.watch(bench.time, bench.time + 60.0);
    assert_eq!(anew.off.expect("full power does nothing").1, TripReason::NoResponse);
}

#[test]
fn a_heater_that_is_stuck_on_is_seen_in_every_mode() {
    let stuck = |at| [fault(Verb::HeaterStuck, None, Some(60.0), at)];
    // Armed, nothing learnt: T1 stays above the set-point while no power is asked for.
    let outcome = Bench::armed(0.3, 35.0, &stuck(60.0), 16).watch(60.0, 160.0);
    assert_eq!(outcome.off.expect("off").1, TripReason::HeaterStuckOn);
    // Never armed.
    let mut bench = Bench::new(0.3, 35.0, 22.5, &stuck(60.0), 16);
    assert_eq!(bench.run(59.0).mode, Mode::Off);
    let Mode::Tripped(trip) = bench.run(60.0).mode else { panic!("not seen while off") };
    assert_eq!(trip.reason, TripReason::HeaterStuckOn);
    let refused = Err(Refusal::CausePersists(TripReason::HeaterStuckOn));
    assert_eq!(bench.instrument.command(Command::Acknowledge), refused);
    bench.rig.clear();
    bench.run(20.0);
    bench.instrument.command(Command::Acknowledge).expect("it has cooled");
    // On before the instrument was.
    let mut bench = Bench::new(0.3, 35.0, 22.5, &[fault(Verb::HeaterStuck, None, Some(100.0), 0.0)], 17);
    assert!(matches!(bench.run(60.0).mode, Mode::Tripped(_)));
}

#[test]
fn cold_starts_steps_and_other_air_do_not_trip() {
    let quiet = |mut bench: Bench, seconds: f64, reachable: bool, place: String| {
        let outcome = bench.watch(0.0, bench.time + seconds);
        let beyond = |reason| !reachable && reason == TripReason::OutOfReach;
        assert!(outcome.off.is_none_or(|(_, reason)| beyond(reason)), "{place}: {outcome:?}");
    };
    for seed in 0..40 {
        // Rooms of 5 to 30 degC, set-points of 25 to 65 degC, drawn by the seed alone.
        let (ambient, setpoint) = (5.0 + (seed * 7 % 26) as f64, 25.0 + (seed * 17 % 41) as f32);
        let gain = [0.3, 0.6, 1.0][seed as usize % 3];
        let mut bench = Bench::new(gain, setpoint, ambient, &[], seed);
        bench.instrument.command(Command::Arm).unwrap();
        let reachable = ambient + 100.0 * gain > f64::from(setpoint) + 1.0;
        quiet(bench, 60.0, reachable, format!("room {ambient}, set-point {setpoint}, gain {gain}"));
    }
    for flow in [0.67, 1.5] {
        let air = [fault(Verb::AirFlow, None, Some(flow), LATE)];
        quiet(Bench::armed(0.3, 35.0, &air, 18), LATE + 60.0, true, format!("air flow {flow}"));
    }
    let mut bench = Bench::armed(0.3, 35.0, &[], 19);
    bench.run(400.0);
    for setpoint in [50.0, 24.0, 48.0, 51.0, 20.0, 35.0] {
        bench.instrument.command(Command::SetPoint(Celsius(setpoint))).unwrap();
        let mode = bench.run(40.0).mode;
        assert!(mode.is_heating(), "step to {setpoint}: {mode:?}");
    }
}

#[test]
fn a_gain_that_is_never_believed_is_the_reason_told_for_not_learning() {
    let mut config = Config::default();
    config.identification.gain_max = 0.29;
    let error = Instrument::new(&config).unwrap_err().to_string();
    assert!(error.contains("identification.gain_max") && error.contains("y_scale / u_scale"), "{error}");
    config.identification.gain_max = 0.001;
    config.identification.u_scale.0 = 1e5;
    let mut bench = Bench::armed(0.3, 35.0, &[], 20);
    bench.instrument = Instrument::new(&config).unwrap();
    bench.instrument.command(Command::Arm).unwrap();
    let tick = bench.run(300.0);
    assert_eq!(tick.blocked, Some(Blocker::NotIdentified), "{:?}", tick.mode);
}

/// What T1 and T2 differ by was learnt with other thermistors, so to speak.
#[test]
fn a_calibration_at_rest_leaves_nothing_to_contradict() {
    let mut bench = Bench::armed(0.3, 35.0, &[], 21);
    bench.run(400.0);
    bench.instrument.command(Command::Stop).unwrap();
    bench.run(30.0);
    let mut config = with_prbs_phase(&Config { setpoint: Celsius(35.0), ..Config::default() }, 21);
    config.sensors.t1.offset.0 = -2.5;
    bench.instrument.retune(&config).unwrap();
    bench.run(1.0);
    bench.instrument.command(Command::Arm).unwrap();
    let outcome = bench.watch(bench.time, bench.time + 60.0);
    assert!(outcome.off.is_none(), "{outcome:?}");
}
