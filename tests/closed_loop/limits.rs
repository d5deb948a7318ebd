//! No settings let a T1 that is out of the tube heat for ever: settings are drawn at random from all that is allowed, T1 comes out, and the
//! heater must go off, or have been harmless all along.

use fdi_core::settings::Value;
use fdi_core::{Command, Config, Instrument, Mode, TripReason};
use pt326_host::experiment::{as_written, sample};
use pt326_host::search::Random;
use pt326_rig::fault::{Fault, Sensor, Verb};
use pt326_rig::{Disturbance, Rig, RigConfig};

/// Up to this power on average heat is harmless, %: a rig of gain 1.0 is no hotter than its highest set-point.
const HARMLESS: f64 = 40.0;
/// What is above it may amount to full power for so many answer times, of 75 s at most.
const ANSWERS: f64 = 32.0;
const LONGEST_ANSWER: f64 = 75.0;
/// Ticks of a run: 60 answer times where sampling is densest, up to 7500.
const TICKS: u32 = 30_000;

fn rig(place: usize) -> RigConfig {
    let gain = |gain| RigConfig { gain, ..RigConfig::default() };
    match place {
        0 => gain(0.3),
        1 => gain(0.6),
        2 => gain(1.0),
        _ => RigConfig::preset("trainer").unwrap(),
    }
}

/// What became of a T1 that came out.
#[derive(Debug, Default)]
struct Outcome {
    /// It could not be armed.
    refused: bool,
    tripped: Option<(f64, TripReason)>,
    /// Harmful heat, as a share of what is allowed; above 1 is too much.
    harm: f64,
    /// Power at the end, %, and the hottest air, degC.
    power: f64,
    hottest: f64,
}

/// Arms, takes T1 out at `onset`, a share of the run, and looks on.
fn with_t1_out(config: &Config, rig: &RigConfig, onset: f64, seed: u64) -> Outcome {
    let ts = as_written(config.sample_time.0);
    let answer = f64::from(config.identification.answer_time.0).min(LONGEST_ANSWER);
    let allowed = (100.0 - HARMLESS) * ANSWERS * answer;
    let onset = onset * f64::from(TICKS) * ts;
    let out = Fault::new(Verb::Detach, Some(Sensor::T1), Some(1.0), onset, 1e9);
    let mut rig = Rig::new(rig, Disturbance::Lively, ts, seed, &[out]);
    let mut instrument = Instrument::new(config).unwrap();
    let (mut outcome, mut heat) = (Outcome::default(), 0.0f64);
    let _ = instrument.control(sample(&mut rig));
    rig.advance(0.0);
    if instrument.command(Command::Arm).is_err() {
        return Outcome { refused: true, ..outcome };
    }
    for k in 0..TICKS {
        let (tick, time) = (instrument.control(sample(&mut rig)), f64::from(k) * ts);
        if let Mode::Tripped(trip) = tick.mode {
            outcome.tripped = Some((time - onset, trip.reason));
            break;
        }
        outcome.power = f64::from(tick.drive.0);
        rig.advance(outcome.power);
        instrument.diagnose(&tick, tick.drive);
        let air = rig.air()[0];
        // What is regulated by T2 and the models is no heat without end.
        let regulated = tick.virtual_t1.is_some() && air < f64::from(tick.setpoint.0) + 10.0;
        if time > onset && !regulated {
            outcome.hottest = outcome.hottest.max(air);
            heat = (heat + (outcome.power - HARMLESS) * ts).max(0.0);
            outcome.harm = outcome.harm.max(heat / allowed);
            if outcome.harm > 1.0 {
                break;
            }
        }
    }
    outcome
}

/// Draws from `first` on; those that are harmful, as text.
fn search(draws: std::ops::Range<u64>) -> Vec<String> {
    let (mut told, mut refused, mut unarmed, mut tripped, mut worst) = (Vec::new(), 0, 0, 0, 0.0f64);
    let count = draws.end - draws.start;
    for seed in draws {
        let mut random = Random::new(seed);
        let Some(config) = random.settings(&Config::default()) else {
            refused += 1;
            continue;
        };
        let onset = if random.below(2) == 0 { 0.0 } else { random.between(0.0, 0.5) };
        let outcome = with_t1_out(&config, &rig(random.below(4)), onset, seed);
        unarmed += u32::from(outcome.refused);
        tripped += u32::from(outcome.tripped.is_some());
        worst = worst.max(outcome.harm);
        if outcome.harm > 1.0 {
            let changed = pt326_lab::change::between(&Config::default(), &config);
            told.push(format!("draw {seed}, T1 out at {onset}: {outcome:?}\n  {changed}"));
        }
    }
    println!(
        "{count} draws: {refused} not valid, {unarmed} not armed, {tripped} tripped, {} harmful; the worst had {worst:.2} of what is allowed",
        told.len()
    );
    told
}

/// What once let T1 heat for ever, with T2 at 50 degC, and the widest that is allowed of it at the default answer time.
const WIDEST: [(&str, f32, f32); 8] = [
    ("plausibility.max", 350.0, 350.0),
    ("plausibility.stuck_time", 3600.0, 16.0),
    ("supervisor.over_temperature", 349.0, 110.0),
    ("supervisor.signal_timeout", 5.0, 2.0),
    ("supervisor.max_disagreement", 100.0, 22.5),
    ("supervisor.disagreement_time", 3600.0, 8.0),
    ("supervisor.cooling_time", 3600.0, 64.0),
    ("supervisor.min_air_flow", 0.0, 0.0),
];

#[test]
fn eight_settings_that_let_it_heat_for_ever_are_refused_and_the_widest_that_are_not_trip_and_are_told() {
    let set = |values: &dyn Fn(&(&str, f32, f32)) -> f32| {
        let mut config = Config::default();
        for wide in &WIDEST {
            let setting = Config::settings().find(|setting| setting.name == wide.0).unwrap();
            assert!(config.set(setting, Value::Number(values(wide))));
        }
        config
    };
    assert!(Instrument::new(&set(&|wide| wide.1)).is_err());
    let allowed = set(&|wide| wide.2);
    let told: Vec<_> = allowed.wider_than_default().map(|setting| setting.name).collect();
    assert_eq!(told, WIDEST.map(|(name, ..)| name));
    for place in 0..4 {
        for onset in [0.0, 0.1] {
            let outcome = with_t1_out(&allowed, &rig(place), onset, 1);
            assert!(
                outcome.tripped.is_some_and(|(after, _)| after < 30.0),
                "rig {place}, {onset}: {outcome:?}"
            );
        }
    }
}

#[test]
fn no_settings_let_a_t1_out_of_the_tube_heat_for_ever() {
    let harmful = search(0..200);
    assert!(harmful.is_empty(), "{}", harmful.join("\n"));
}

/// `cargo test --release -p pt326-tests --test closed_loop -- --ignored ten_thousand --nocapture`
#[test]
#[ignore = "three minutes on two idle cores"]
fn none_of_ten_thousand_settings_lets_a_t1_out_of_the_tube_heat_for_ever() {
    let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let share = |i: u64| 10_000 * i / threads + 1_000_000;
    let harmful: Vec<String> = std::thread::scope(|scope| {
        let some = |i| scope.spawn(move || search(share(i)..share(i + 1)));
        let all: Vec<_> = (0..threads).map(some).collect();
        all.into_iter().flat_map(|some| some.join().unwrap()).collect()
    });
    assert!(harmful.is_empty(), "{}", harmful.join("\n"));
}
