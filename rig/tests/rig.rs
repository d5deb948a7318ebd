//! The rig's physics and faults against what they are said to be. No turbulence, no noise, so that tolerances are small.

use fdi_core::AdcCode;
use fdi_core::sense::thermistor::{Thermistor, ThermistorConfig};
use pt326_rig::fault::{Fault, Sensor, Verb};
use pt326_rig::{
    Disturbance, FanConfig, HeaterConfig, MainsConfig, PickupConfig, Rig, RigConfig, RoomConfig,
    SensorConfig, WallConfig,
};

use Sensor::{T0, T1, T2};

const TS: f64 = 0.11;
const AMBIENT: f64 = 22.5;

fn still(gain: f64) -> RigConfig {
    RigConfig { gain, turbulence: 0.0, white_noise: 0.0, ..RigConfig::default() }
}

fn rig(gain: f64, faults: &[Fault]) -> Rig {
    Rig::new(&still(gain), Disturbance::None, TS, 1, faults)
}

/// Drives the rig for `seconds` and gives the codes then.
fn codes(rig: &mut Rig, drive: f64, seconds: f64) -> [f64; 3] {
    for _ in 0..(seconds / TS).round() as u32 {
        rig.sample();
        rig.advance(drive);
    }
    rig.sample()
}

/// The same as temperatures.
fn celsius(rig: &mut Rig, drive: f64, seconds: f64) -> [f64; 3] {
    let thermistor = Thermistor::new(&ThermistorConfig::default(), 0).unwrap();
    codes(rig, drive, seconds).map(|code| f64::from(thermistor.celsius(AdcCode(code as f32)).0))
}

fn close(actual: [f64; 3], expected: [f64; 3]) {
    let near = actual.iter().zip(expected).all(|(a, e)| (a - e).abs() < 0.1);
    assert!(near, "{actual:?}, expected {expected:?}");
}

fn on(verb: Verb, sensor: Sensor, size: f64, at: f64) -> Fault {
    Fault::new(verb, Some(sensor), Some(size), at, 1e6)
}

fn swapped(sensor: Sensor, with: Sensor, at: f64) -> Fault {
    Fault { with: Some(with), ..Fault::new(Verb::Swap, Some(sensor), None, at, 1e6) }
}

#[test]
fn full_power_makes_the_air_as_hot_as_the_gain_says() {
    for (gain, hottest) in [(0.3, 52.5), (0.6, 82.5), (1.0, 122.5)] {
        let mut rig = rig(gain, &[on(Verb::Detach, T1, 1.0, 0.0), on(Verb::Offset, T2, 9.0, 0.0)]);
        codes(&mut rig, 100.0, 20.0);
        let [t1, t2] = rig.air();
        assert!((t1 - hottest).abs() < 1e-6, "{t1}");
        assert!((t2 - AMBIENT - 0.92 * (hottest - AMBIENT)).abs() < 1e-6, "{t2}");
    }
}

#[test]
fn the_air_at_a_sensor_is_that_of_the_heater_a_dead_time_ago() {
    let mut rig = rig(0.3, &[]);
    codes(&mut rig, 50.0, 2.0 * TS);
    let rise = |t: f64| 15.0 * (1.0 - (-t.max(0.0) / 0.45).exp());
    let [t1, t2] = rig.air();
    assert!(
        (t1 - AMBIENT - rise(0.22 - 0.1)).abs() < 1e-9
            && (t2 - AMBIENT - 0.92 * rise(0.22 - 0.2)).abs() < 1e-9
    );
}

#[test]
fn a_detached_sensor_misses_its_share_of_the_rise_and_slides_out() {
    let out = |size, over| {
        let slides = Fault { over, ..on(Verb::Detach, T1, size, 10.1) };
        let mut rig = rig(0.3, &[slides]);
        [10.0, 1.0, 29.0, 60.0].map(|more| celsius(&mut rig, 50.0, more)[1])
    };
    let near = |actual: [f64; 4], expected: [f64; 4]| {
        assert!(
            actual.iter().zip(expected).all(|(a, e)| (a - e).abs() < 0.15),
            "{actual:?}, expected {expected:?}"
        );
    };
    near(out(1.0, None), [37.5, 22.5, 22.5, 22.5]);
    near(out(0.5, None), [37.5, 30.0, 30.0, 30.0]);
    near(out(1.0, Some(60.0)), [37.5, 37.25, 30.0, 22.5]);
    let slow = Fault { lag: Some(10.0), ..on(Verb::Detach, T2, 1.0, 10.1) };
    let mut rig = rig(0.3, &[slow]);
    let before = celsius(&mut rig, 50.0, 10.0);
    close(celsius(&mut rig, 50.0, 10.0), [AMBIENT, 37.5, AMBIENT + (before[2] - AMBIENT) * (-1.0_f64).exp()]);
}

#[test]
fn swapped_sensors_are_exchanged_with_their_own_faults_until_cleared() {
    let mut rig = rig(0.3, &[on(Verb::Offset, T1, 2.0, 0.0), swapped(T0, T1, 0.0)]);
    close(celsius(&mut rig, 50.0, 10.0), [39.5, 22.5, 36.3]);
    rig.clear();
    close(celsius(&mut rig, 50.0, 1.0), [22.5, 37.5, 36.3]);
}

#[test]
fn a_frozen_sensor_goes_on_from_its_last_code_with_noise() {
    let mut rig = rig(0.3, &[on(Verb::Freeze, T1, 2.0, 20.0)]);
    codes(&mut rig, 50.0, 19.9);
    let held = rig.sample()[1];
    codes(&mut rig, 90.0, TS);
    let off: Vec<f64> = (0..500).map(|_| codes(&mut rig, 90.0, TS)[1] - held).collect();
    let mean = off.iter().sum::<f64>() / 500.0;
    let sd = (off.iter().map(|x| x * x).sum::<f64>() / 500.0).sqrt();
    assert!(mean.abs() < 0.4 && (1.8..2.2).contains(&sd), "mean {mean}, standard deviation {sd}");
}

#[test]
fn what_is_stuck_from_the_start_repeats_the_first_temperature() {
    let stuck = Fault::new(Verb::Stuck, Some(T1), None, 0.0, 1e6);
    let frozen = on(Verb::Freeze, T2, 0.0, 0.0);
    let mut rig = rig(0.3, &[stuck, frozen, on(Verb::Offset, T0, -20.0, 0.0)]);
    close(celsius(&mut rig, 50.0, 10.0), [2.5, 22.5, 22.5]);
}

#[test]
fn what_is_injected_counts_from_now() {
    let mut rig = rig(0.3, &[]);
    close(celsius(&mut rig, 50.0, 10.0), [22.5, 37.5, 36.3]);
    rig.inject(on(Verb::Offset, T2, 5.0, 1.0));
    close(celsius(&mut rig, 50.0, 0.9), [22.5, 37.5, 36.3]);
    close(celsius(&mut rig, 50.0, 0.22), [22.5, 37.5, 41.3]);
}

/// What is done to heater or air is no error of a sensor.
#[test]
fn the_error_of_the_sensors_is_what_their_faults_make() {
    let error = |faults: &[Fault]| {
        let mut rig = rig(0.3, faults);
        codes(&mut rig, 50.0, 20.0);
        rig.sensor_error()
    };
    let near = |faults: &[Fault], expected: f64| {
        let error = error(faults);
        assert!((error - expected).abs() < 0.1, "{error} of {faults:?}, expected {expected}");
    };
    near(&[], 0.0);
    near(&[Fault::new(Verb::AirFlow, None, Some(0.5), 10.0, 5.0), on(Verb::Spike, T1, 50.0, 3.0)], 0.0);
    near(&[on(Verb::Detach, T1, 0.5, 15.0)], 7.5);
    near(&[on(Verb::Detach, T2, 1.0, 0.0)], 13.8);
    near(&[on(Verb::Offset, T0, -20.0, 0.0)], 20.0);
    near(&[swapped(T1, T0, 5.0)], 15.0);
    near(&[Fault { duration: 5.0, ..on(Verb::Detach, T1, 1.0, 5.0) }], 0.0);
    assert!(error(&[Fault::new(Verb::Open, Some(T2), None, 10.0, 1e6)]) > 100.0);
    assert!(error(&[on(Verb::Freeze, T1, 0.0, 0.05)]) > 14.0);
}

/// A wall delays a part of the rise, also of what a detached sensor still sees, and alters no steady state.
#[test]
fn a_wall_alters_no_steady_state() {
    let wall = WallConfig { t1_share: 0.1, t2_share: 0.2, time: 20.0 };
    let config = RigConfig { wall, ..still(0.3) };
    let mut rig = Rig::new(&config, Disturbance::None, TS, 1, &[on(Verb::Detach, T2, 0.5, 300.0)]);
    close(celsius(&mut rig, 50.0, 5.0), [22.5, 22.5 + 13.5 + 1.5 * 0.21, 22.5 + 13.8 * (0.8 + 0.2 * 0.20)]);
    close(celsius(&mut rig, 50.0, 200.0), [22.5, 37.5, 36.3]);
    close(celsius(&mut rig, 50.0, 200.0), [22.5, 37.5, 29.4]);
    let [t1, t2] = rig.air();
    assert!((t1 - 37.5).abs() < 0.01 && (t2 - 36.3).abs() < 0.01, "{t1} {t2}");
}

/// 20 s of codes with all noise, at a drive of `drive` %.
fn noisy(config: &RigConfig, drive: f64) -> Vec<[f64; 3]> {
    let mut rig = Rig::new(config, Disturbance::Lively, TS, 5, &[]);
    let tick = |_| {
        let codes = rig.sample();
        rig.advance(drive);
        codes
    };
    (0..180).map(tick).collect()
}

/// What moves only the heat leaves a cold rig's codes alone to the bit, so it takes nothing from the common noise.
#[test]
fn an_ingredient_draws_from_its_own_stream() {
    let usual = RigConfig::default();
    let mains = MainsConfig { walk: 1.0, steps: 600.0, ..MainsConfig::default() };
    let thermistor = SensorConfig { t1_offset: 1.0, r25_sd: 1e-12, ..SensorConfig::default() };
    let room = RoomConfig { draughts: 3600.0, draught_depth: 0.0, ..RoomConfig::default() };
    let heater = HeaterConfig { bend: 0.3, ..HeaterConfig::default() };
    let with = RigConfig { mains, thermistor, room, heater, ..usual.clone() };
    let others = |codes: Vec<[f64; 3]>| codes.into_iter().map(|[t0, _, t2]| [t0, t2]).collect::<Vec<_>>();
    assert_eq!(others(noisy(&with, 0.0)), others(noisy(&usual, 0.0)));
    assert_ne!(noisy(&with, 0.0), noisy(&usual, 0.0));
    assert_ne!(others(noisy(&with, 40.0)), others(noisy(&usual, 40.0)));
}

/// Air with hunting and a lagging flow, a wire and a step of the flow, in ticks of 0.11 s and of 5.5 ms.
#[test]
fn steps_within_a_tick_are_fine_enough() {
    let config = RigConfig {
        fan: FanConfig { hunting: 0.03, period: 2.0, lag: 0.2, ..FanConfig::default() },
        heater: HeaterConfig { bend: 0.2, wire_time: 0.15 },
        ..still(0.3)
    };
    let faults = [Fault::new(Verb::AirFlow, None, Some(1.3), 5.0, 10.0)];
    let air = |ts: f64| {
        let mut rig = Rig::new(&config, Disturbance::None, ts, 1, &faults);
        let per_tick = (TS / ts).round() as usize;
        let drive = |n: usize| if n / per_tick % 40 < 20 { 60.0 } else { 30.0 };
        let tick = |n| {
            let air = rig.air();
            rig.advance(drive(n));
            air
        };
        (0..150 * per_tick).map(tick).step_by(per_tick).collect::<Vec<_>>()
    };
    let furthest = air(TS)
        .iter()
        .zip(air(TS / 20.0))
        .fold(0.0, |far: f64, (a, b)| far.max((a[0] - b[0]).abs()).max((a[1] - b[1]).abs()));
    assert!(furthest < 0.05, "{furthest} degC apart");
}

/// A sag of the mains is a loss of power by its square; the fan takes its part.
#[test]
fn mains_move_heat_and_air() {
    let level = |fan_exponent| {
        let mains = MainsConfig { steps: 3600.0, step_size: 3.0, fan_exponent, ..MainsConfig::default() };
        let mut rig = Rig::new(&RigConfig { mains, ..still(0.3) }, Disturbance::None, TS, 1, &[]);
        codes(&mut rig, 50.0, 10.0);
        let mut rises = Vec::new();
        for _ in 0..3000 {
            rig.sample();
            rig.advance(50.0);
            rises.push((rig.air()[0] - AMBIENT) / 15.0);
        }
        (rises.iter().map(|r| (r - 1.0).powi(2)).sum::<f64>() / rises.len() as f64).sqrt()
    };
    let (heat, both) = (level(0.0), level(1.0));
    assert!(heat > 0.02 && heat < 0.08, "{heat}");
    assert!((both / heat - 0.5).abs() < 0.05, "V^2/V: half of it, {both} of {heat}");
}

#[test]
fn every_preset_runs() {
    for name in ["paper", "trainer", "harsh"] {
        let codes = noisy(&RigConfig::preset(name).unwrap(), 45.0);
        assert!(codes.iter().flatten().all(|code| (0.0..=4095.0).contains(code)), "{name}");
    }
}

/// Two edges at one time made a stretch of no length, whose mean flow and power were 0/0.
#[test]
fn two_faults_may_begin_and_end_at_the_same_time() {
    let mut harsh = Rig::new(
        &RigConfig::preset("harsh").unwrap(),
        Disturbance::None,
        0.1,
        1,
        &[on(Verb::Offset, Sensor::T1, 1.5, 0.25), on(Verb::Offset, Sensor::T2, 1.5, 0.25)],
    );
    let codes = codes(&mut harsh, 40.0, 5.0);
    assert!(codes.iter().all(|code| (1.0..4095.0).contains(code)), "{codes:?}");
}

/// A rig without noise but for what `change` switches on.
fn only(change: impl Fn(&mut RigConfig), faults: &[Fault]) -> Rig {
    let mut config = RigConfig { adc_bits: 20, ..still(0.3) };
    change(&mut config);
    Rig::new(&config, Disturbance::None, TS, 1, faults)
}

#[test]
fn offsets_and_own_heat_of_thermistors_are_read_and_are_no_error_of_a_fault() {
    let mut rig = only(
        |c| {
            c.thermistor.t1_offset = 1.5;
            c.thermistor.t2_r25 = 5.0;
            c.thermistor.self_heating = 0.4;
        },
        &[],
    );
    // T1: a quarter of its heat in still air, and less of it when warm. T2: ln 1.05 T^2 / B too cold
    let [t0, t1, t2] = celsius(&mut rig, 50.0, 20.0);
    assert!((t0 - 22.9).abs() < 0.01, "{t0}");
    assert!((t1 - 39.0 - 0.095).abs() < 0.01, "{t1}");
    assert!((t2 - 36.3 - 0.095 + 0.04879 * 309.4 * 309.4 / 3950.0).abs() < 0.05, "{t2}");
    assert!(rig.sensor_error() < 0.01, "{}", rig.sensor_error());
}

#[test]
fn a_body_makes_the_reading_come_late() {
    let mut rig = only(|c| (c.thermistor.body_share, c.thermistor.body_time) = (0.2, 10.0), &[]);
    let t1 = celsius(&mut rig, 50.0, 5.0)[1];
    let felt = (-(5.0 - 0.05 - 0.45 - 0.1) / 10.0_f64).exp();
    assert!((t1 - 37.5 + 0.2 * 15.0 * felt).abs() < 0.05, "{t1}");
    close(celsius(&mut rig, 50.0, 100.0), [22.5, 37.5, 36.3]);
}

#[test]
fn the_room_reaches_all_three() {
    let mut rig = only(|c| (c.room.warm_up, c.room.warm_up_time) = (3.0, 10.0), &[]);
    close(celsius(&mut rig, 0.0, 60.0), [22.5; 3]);
    close(celsius(&mut rig, 50.0, 200.0), [25.5, 40.5, 39.3]);
    let mut rig = only(|c| c.room.day_swing = 5.0, &[]);
    let [t0, t1, t2] = celsius(&mut rig, 0.0, 0.0);
    assert!((t0 - AMBIENT).abs() > 0.2 && (t0 - t1).abs() < 0.01 && (t0 - t2).abs() < 0.01, "{t0}");
    close(celsius(&mut rig, 0.0, 12.0 * 3600.0), [2.0 * AMBIENT - t0; 3]);
}

#[test]
fn a_hum_is_as_large_as_set() {
    let mut rig = only(|c| c.pickup = PickupConfig { codes: 3.0, frequency: 0.37 }, &[]);
    let all: Vec<f64> = (0..2000).map(|_| codes(&mut rig, 0.0, TS)[1]).collect();
    let (low, high) = (all.iter().copied().fold(1e9, f64::min), all.iter().copied().fold(0.0, f64::max));
    assert!((high - low - 6.0).abs() < 0.05, "{low} to {high}");
}

/// What the air misses after a step of the power is the sum of the lags and the dead time; a wire adds its own, a flow of 2
/// takes from it as from the heater's.
#[test]
fn a_wire_adds_its_lag_and_a_bend_its_power() {
    let missed = |wire_time, flow: f64| {
        let fault = Fault::new(Verb::AirFlow, None, Some(flow), 0.0, 1e6);
        let mut rig = only(|c| c.heater = HeaterConfig { wire_time, bend: 0.2 }, &[fault]);
        let last = 0.3 * 80.0 * (1.0 + 0.2 * 0.6) / flow;
        let (mut missed, mut before) = (0.0, 1.0);
        for _ in 0..400 {
            rig.advance(80.0);
            let left = 1.0 - (rig.air()[0] - AMBIENT) / last;
            missed += 0.5 * TS * (before + left);
            before = left;
        }
        assert!(before.abs() < 1e-6, "{before}");
        missed
    };
    let slowness = 2.0_f64.powf(-0.8);
    for (flow, expected) in [(1.0, 0.3), (2.0, 0.3 * slowness)] {
        let more = missed(0.3, flow) - missed(0.0, flow);
        assert!((more - expected).abs() < 2e-3, "{more}, expected {expected}");
    }
}

#[test]
fn the_air_is_rougher_and_the_lag_shorter_with_more_flow() {
    let sd = |flow: f64, turbulence_exponent, lag_exponent| {
        let fault = Fault::new(Verb::AirFlow, None, Some(flow), 0.0, 1e6);
        let change = |c: &mut RigConfig| {
            c.turbulence = 0.12;
            c.fan.turbulence_exponent = turbulence_exponent;
            c.thermistor.lag_exponent = lag_exponent;
        };
        let mut rig = only(change, &[fault]);
        let read: Vec<f64> = (0..20_000).map(|_| celsius(&mut rig, 0.0, TS)[2] - AMBIENT).collect();
        (read.iter().map(|x| x * x).sum::<f64>() / read.len() as f64).sqrt()
    };
    let usual = sd(2.0, 0.0, 0.0);
    assert!((sd(2.0, 1.0, 0.0) / usual - 2.0).abs() < 0.02);
    let by_lag = |lag: f64| (0.15 / (0.15 + lag)).sqrt();
    let expected = by_lag(0.2) / by_lag(0.4);
    assert!((sd(2.0, 0.0, 1.0) / usual / expected - 1.0).abs() < 0.05);
}

/// Four weeks without power: the room of a calm run stays one, and goes both ways.
#[test]
fn a_room_stays_a_room_for_weeks() {
    for seed in 1..6 {
        let mut rig = Rig::new(&still(0.3), Disturbance::Calm, 60.0, seed, &[]);
        let (mut coldest, mut warmest) = (f64::MAX, f64::MIN);
        for _ in 0..4 * 7 * 24 * 60 {
            rig.sample();
            rig.advance(0.0);
            let [t1, _] = rig.air();
            (coldest, warmest) = (coldest.min(t1), warmest.max(t1));
        }
        let within = AMBIENT - 2.5..AMBIENT + 2.5;
        assert!(
            within.contains(&coldest) && within.contains(&warmest),
            "{coldest} to {warmest}, seed {seed}"
        );
        assert!(coldest < AMBIENT - 1.5 && warmest > AMBIENT + 1.5, "{coldest} to {warmest}, seed {seed}");
    }
}
