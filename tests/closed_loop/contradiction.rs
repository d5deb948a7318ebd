//! Thermistors that contradict each other, and a T0 that is wrong: the right name, learnt or not, and no trip for another
//! reason. What a rig would need many verbs for is done here to the codes on their way to the instrument.

use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::likelihood::{Channel, Pair};
use fdi_core::{
    AdcCode, Celsius, Command, Config, FaultClass, Instrument, Mode, RawSample, Report, Tick, TripReason,
};
use pt326_host::experiment::scenario::Scenario;
use pt326_host::experiment::{Backend, Record, Row, run, run_on, with_prbs_phase};
use pt326_rig::fault::{Fault, Sensor, Verb};
use pt326_rig::{Disturbance, RigConfig};

const TS: f64 = 0.11;

/// What is done to the codes of a sample: it gets this one, and T0's code of the sample before.
type Deed = fn(RawSample, ambient: AdcCode, tick: u32) -> RawSample;

/// An instrument whose thermistors are not where it thinks, from a tick on; ordered about at some ticks.
struct Misplaced {
    instrument: Instrument,
    deed: Deed,
    from: u32,
    orders: Vec<(u32, Command)>,
    tick: u32,
    ambient: AdcCode,
}

impl Misplaced {
    fn new(config: &Config, from: u32, deed: Deed) -> Self {
        let instrument = Instrument::new(config).unwrap();
        Self { instrument, deed, from, orders: Vec::new(), tick: 0, ambient: AdcCode(2160.0) }
    }
}

impl Backend for Misplaced {
    fn control(&mut self, raw: RawSample) -> Tick {
        for (_, command) in self.orders.iter().filter(|(tick, _)| *tick == self.tick) {
            let _ = self.instrument.command(*command); // a refusal shows in what follows
        }
        let before = std::mem::replace(&mut self.ambient, raw.t0);
        let raw = if self.tick >= self.from { (self.deed)(raw, before, self.tick) } else { raw };
        self.tick += 1;
        self.instrument.control(raw)
    }

    fn diagnose(&mut self, tick: &Tick) -> Report {
        Backend::diagnose(&mut self.instrument, tick)
    }

    fn command(&mut self, command: Command) -> Result<(), String> {
        Backend::command(&mut self.instrument, command)
    }

    fn baseline(&self) -> Option<Baseline> {
        Backend::baseline(&self.instrument)
    }
}

fn swap_t1_t2(raw: RawSample, _: AdcCode, _: u32) -> RawSample {
    RawSample { t1: raw.t2, t2: raw.t1, ..raw }
}

fn swap_t0_t1(raw: RawSample, _: AdcCode, _: u32) -> RawSample {
    RawSample { t0: raw.t1, t1: raw.t0, ..raw }
}

fn swap_t0_t2(raw: RawSample, _: AdcCode, _: u32) -> RawSample {
    RawSample { t0: raw.t2, t2: raw.t0, ..raw }
}

fn t1_out(raw: RawSample, ambient: AdcCode, _: u32) -> RawSample {
    RawSample { t1: ambient, ..raw }
}

fn t2_out(raw: RawSample, ambient: AdcCode, _: u32) -> RawSample {
    RawSample { t2: ambient, ..raw }
}

/// Codes are not quite linear in the temperature: somewhat less than half.
fn t1_half_out(raw: RawSample, ambient: AdcCode, _: u32) -> RawSample {
    RawSample { t1: AdcCode(0.5 * (raw.t1.0 + ambient.0)), ..raw }
}

/// Two counts either way around what it would read at 35 degC.
fn t1_frozen(raw: RawSample, _: AdcCode, tick: u32) -> RawSample {
    let noise = (tick.wrapping_mul(2654435761) >> 24) % 5;
    RawSample { t1: AdcCode(1604.0 + noise as f32), ..raw }
}

fn scenario(gain: f64, duration: f64, faults: Vec<Fault>) -> Scenario {
    let rig = RigConfig { gain, ..RigConfig::default() };
    Scenario { duration, disturbance: Disturbance::Lively, rig, faults, ..Scenario::default() }
}

fn offset(sensor: Sensor, size: f64, at: f64) -> Fault {
    Fault::new(Verb::Offset, Some(sensor), Some(size), at, 1e4)
}

fn config(setpoint: f32, seed: u64) -> Config {
    with_prbs_phase(&Config { setpoint: Celsius(setpoint), ..Config::default() }, seed)
}

fn class(row: &Row) -> Option<FaultClass> {
    row.report.likelihood.finding.map(|finding| finding.class)
}

/// When a class was first named after `from` s, and the class named last.
fn named(record: &Record, wanted: FaultClass, from: f64) -> (Option<f64>, Option<FaultClass>) {
    let first = record.rows.iter().find(|row| class(row) == Some(wanted));
    (first.map(|row| record.time(row.tick.index) - from), class(record.rows.last().unwrap()))
}

fn trip(record: &Record) -> Option<(f64, TripReason)> {
    let tripped = |row: &Row| match row.tick.mode {
        Mode::Tripped(trip) => Some((record.time(row.tick.index), trip.reason)),
        _ => None,
    };
    record.rows.iter().find_map(tripped)
}

#[test]
fn misplaced_thermistors_are_named_learnt_or_not() {
    let out = FaultClass::T1Detached;
    let cases: [(&str, Deed, FaultClass); 5] = [
        ("T1 and T2 swapped", swap_t1_t2, FaultClass::Swapped(Pair::T1T2)),
        ("T0 and T1 swapped", swap_t0_t1, FaultClass::Swapped(Pair::T0T1)),
        ("T0 and T2 swapped", swap_t0_t2, FaultClass::Swapped(Pair::T0T2)),
        ("T1 out", t1_out, out),
        ("T2 out", t2_out, FaultClass::T2Detached),
    ];
    for (name, deed, class) in cases {
        for (gain, seed) in [(0.3, 1), (0.6, 2)] {
            for from in [0, 4000] {
                let config = config(35.0, seed);
                let since = f64::from(from) * TS;
                let mut rig = Misplaced::new(&config, from, deed);
                let record = run_on(&mut rig, &config, &scenario(gain, since + 60.0, vec![]), seed);
                let (first, last) = named(&record, class, since);
                let place = format!("{name}, gain {gain}, from {since} s, seed {seed}");
                assert!(first.is_some_and(|delay| delay < 10.0), "{place}: after {first:?} s");
                assert_eq!(last, Some(class), "{place}");
            }
        }
    }
}

/// It sees half of the rise, so either name is right, and the supervisor does not wait for one.
#[test]
fn a_t1_that_is_half_out_trips_and_is_named_if_the_rig_was_learnt() {
    for (gain, seed) in [(0.3, 1), (0.6, 2), (0.3, 3)] {
        for from in [0, 4000] {
            let config = config(35.0, seed);
            let since = f64::from(from) * TS;
            let mut rig = Misplaced::new(&config, from, t1_half_out);
            let record = run_on(&mut rig, &config, &scenario(gain, since + 30.0, vec![]), seed);
            let (time, reason) = trip(&record).expect("T2 is far hotter");
            let place = format!("gain {gain}, from {since} s, seed {seed}");
            assert!(reason == TripReason::SensorsDisagree && time - since < 6.0, "{place}: {time} s");
            let name = class(record.rows.last().unwrap());
            let right = [Some(FaultClass::T1Detached), Some(FaultClass::T1Clogged)].contains(&name);
            assert!(right || from == 0 && name.is_none(), "{place}: {name:?}");
        }
    }
}

/// Learnt: by its signature. Not learnt: it does not answer, which trips before it has a name.
#[test]
fn a_frozen_t1_is_stuck_however_noisy() {
    let stuck = FaultClass::Stuck(Channel::T1);
    for (gain, seed) in [(0.3, 1), (0.6, 2)] {
        for (from, latest) in [(0, 30.0), (4000, 10.0)] {
            let config = config(35.0, seed);
            let since = f64::from(from) * TS;
            let mut rig = Misplaced::new(&config, from, t1_frozen);
            let record = run_on(&mut rig, &config, &scenario(gain, since + 60.0, vec![]), seed);
            let (first, _) = named(&record, stuck, since);
            let tripped = trip(&record).map(|(time, _)| time - since).filter(|_| from == 0);
            let delay = first.or(tripped);
            assert!(delay.is_some_and(|delay| delay < latest), "from {since} s, gain {gain}: {delay:?} s");
        }
    }
}

#[test]
fn what_is_expected_of_a_detached_t1_is_what_the_models_say() {
    let config = config(35.0, 1);
    let mut rig = Misplaced::new(&config, 4000, t1_out);
    let record = run_on(&mut rig, &config, &scenario(0.3, 4000.0 * TS + 10.0, vec![]), 1);
    let hot = record.rows.iter().rev().find(|row| row.tick.mode.is_heating()).unwrap();
    let [ambient, t1, _] = hot.report.likelihood.expected.map(|t| t.expect("the models are trained"));
    let beside = hot.tick.sample.t2.celsius.0;
    assert!((ambient - 22.5).abs() < 0.5, "{ambient}");
    assert!(t1 > beside && t1 < beside + 8.0, "T2 reads {beside}, T1 should read {t1}");
}

/// Heating up, regulating, changing the set-point, with weak rigs and strong ones.
#[test]
fn nothing_is_said_of_thermistors_that_are_in_their_place() {
    use pt326_host::experiment::scenario::Action;
    let step = |at: f64, t: f32| Action { at, setpoint: Some(t), ..Action::default() };
    for (gain, seed) in [(0.05, 1), (0.1, 2), (0.2, 3), (0.45, 4), (0.6, 5), (1.0, 6)] {
        let actions = vec![step(60.0, 55.0), step(100.0, 25.0), step(130.0, 40.0), step(150.0, 35.0)];
        let scenario = Scenario { actions, ..scenario(gain, 200.0, vec![]) };
        let record = run(&Config::default(), &scenario, seed).unwrap();
        let said: Vec<_> = record.rows.iter().filter_map(class).collect();
        assert_eq!(said, [], "gain {gain}, seed {seed}");
    }
}

#[test]
fn a_wrong_t0_is_named_and_does_not_trip() {
    for (size, gain, setpoint) in
        [(20.0, 0.3, 35.0), (-20.0, 0.3, 35.0), (20.0, 0.6, 65.0), (-20.0, 0.6, 65.0)]
    {
        for at in [0.0, 440.0] {
            let scenario = scenario(gain, at + 90.0, vec![offset(Sensor::T0, size, at)]);
            let record = run_on(
                &mut Instrument::new(&config(setpoint, 7)).unwrap(),
                &config(setpoint, 7),
                &scenario,
                7,
            );
            let (first, last) = named(&record, FaultClass::T0Fault, at);
            let place = format!("T0 off by {size} degC at {at} s, set-point {setpoint}");
            assert!(first.is_some_and(|delay| delay < 10.0), "{place}: after {first:?} s");
            assert_eq!((last, trip(&record)), (Some(FaultClass::T0Fault), None), "{place}");
        }
    }
}

/// Off for a minute: three thermistors should agree. The alarm stays while it heats.
#[test]
fn a_wrong_t0_is_named_at_rest() {
    let config = config(35.0, 8);
    let mut rig = Misplaced::new(&config, 0, |raw, _, _| raw);
    rig.orders = vec![(0, Command::Stop), (545, Command::Arm)];
    let record = run_on(&mut rig, &config, &scenario(0.3, 120.0, vec![offset(Sensor::T0, -8.0, 0.0)]), 8);
    let (first, last) = named(&record, FaultClass::T0Fault, 0.0);
    assert!(first.is_some_and(|delay| delay < 40.0), "{first:?} s");
    assert_eq!(last, Some(FaultClass::T0Fault));
    let finding = record.rows.last().unwrap().report.likelihood.finding.unwrap();
    let off = finding.magnitude.expect("known at rest").value;
    assert!((off + 8.0).abs() < 1.0, "{off} degC");
}

#[test]
fn a_wrong_or_lost_t0_hides_no_loss_of_air() {
    let loss = |at: f64| Fault::new(Verb::AirFlow, None, Some(0.3), at, 1e4);
    let open = Fault { verb: Verb::Open, size: None, ..offset(Sensor::T0, 0.0, 400.0) };
    for t0 in [offset(Sensor::T0, 20.0, 400.0), offset(Sensor::T0, -20.0, 400.0), open] {
        let scenario = scenario(0.3, 480.0, vec![t0.clone(), loss(460.0)]);
        let record = run(&Config::default(), &scenario, 9).unwrap();
        let (time, reason) = trip(&record).expect("too little air");
        assert_eq!(reason, TripReason::AirFlowLost, "{}", t0.label());
        assert!((460.0..475.0).contains(&time), "{}: {time} s", t0.label());
    }
}

/// What tripped is seen again as soon as it heats again; after a relearning it is what is normal.
#[test]
fn models_outlast_a_trip_until_they_are_forgotten() {
    let config = config(35.0, 10);
    let loss = Fault::new(Verb::AirFlow, None, Some(0.35), 400.0, 1e4);
    let again = [(4000, Command::Acknowledge), (4001, Command::Arm)];
    let rearmed = |orders: Vec<(u32, Command)>| {
        let mut rig = Misplaced::new(&config, 0, |raw, _, _| raw);
        rig.orders = orders;
        run_on(&mut rig, &config, &scenario(0.3, 520.0, vec![loss.clone()]), 10)
    };
    let heating =
        |record: &Record| record.rows[4002..].iter().filter(|row| row.tick.mode.is_heating()).count();
    let seconds = heating(&rearmed(again.to_vec())) as f64 * TS;
    assert!(seconds > 0.0 && seconds < 8.0, "heated for {seconds} s with the cause still there");
    let told = [again[0], again[1], (4002, Command::Relearn)];
    assert!(heating(&rearmed(told.to_vec())) as f64 * TS > 70.0, "a rig changed on purpose");
}

/// The models are looked at from the first second of the second start on: to the highest set-point, too.
#[test]
fn a_second_start_does_not_trip() {
    for (seed, gain, setpoint) in
        [(1, 0.3, 35.0), (2, 0.6, 35.0), (3, 0.6, 65.0), (4, 0.45, 60.0), (5, 0.2, 60.0)]
    {
        let config = config(35.0, seed);
        let mut rig = Misplaced::new(&config, 0, |raw, _, _| raw);
        let highest = Command::SetPoint(Celsius(setpoint));
        rig.orders = vec![(4000, Command::Stop), (4200, highest), (4201, Command::Arm)];
        let record = run_on(&mut rig, &config, &scenario(gain, 520.0, vec![]), seed);
        // 60 degC is more than full power gives a rig of gain 0.2: that is said, after 40 s.
        let told = trip(&record).map(|(_, reason)| reason);
        assert_eq!(told, (gain < 0.3).then_some(TripReason::OutOfReach), "gain {gain}, set-point {setpoint}");
        assert_eq!(record.rows[4201..].iter().find_map(class), None, "gain {gain}, set-point {setpoint}");
        let current = record.rows[4100].report.likelihood.expected[1].is_some();
        assert!(current || gain < 0.3, "gain {gain}: trained before");
    }
}

/// A T1 that reads far too low beside a T2 that does not: neither is regulated by.
#[test]
fn there_is_no_virtual_t1_where_t1_and_t2_contradict_each_other() {
    let mut config = config(35.0, 11);
    config.supervisor.go_on_without_t1 = true;
    let mut rig = Misplaced::new(&config, 4000, t1_out);
    let record = run_on(&mut rig, &config, &scenario(0.3, 4000.0 * TS + 20.0, vec![]), 11);
    let after = 4000 + (3.0 / TS) as usize;
    assert!(record.rows[after..].iter().all(|row| row.report.likelihood.virtual_rise.is_none()));
    let hottest = record.rows[after..].iter().map(|row| row.tick.sample.t2.celsius.0).fold(0.0, f32::max);
    assert!(hottest < 45.0, "{hottest} degC");
}

#[test]
fn a_heater_stuck_on_is_seen_with_the_instrument_off() {
    let config = config(35.0, 12);
    let mut rig = Misplaced::new(&config, 0, |raw, _, _| raw);
    rig.orders = vec![(4000, Command::Stop)];
    let stuck = Fault::new(Verb::HeaterStuck, None, Some(40.0), 460.0, 1e4);
    let record = run_on(&mut rig, &config, &scenario(0.3, 500.0, vec![stuck]), 12);
    let seen = record.rows[4100..].iter().find(|row| row.report.likelihood.heater_stuck_on).expect("seen");
    assert!((460.0..485.0).contains(&record.time(seen.tick.index)));
    // The supervisor needs no models for it, and has tripped already.
    assert_eq!(record.rows[4150].tick.mode, Mode::Off);
    assert!(matches!(seen.tick.mode, Mode::Tripped(trip) if trip.reason == TripReason::HeaterStuckOn));
}
