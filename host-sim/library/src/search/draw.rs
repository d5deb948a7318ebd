//! A case from a number.

use fdi_core::Config;
use pt326_lab::{change, preset};
use pt326_rig::fault::{Fault, Sensor, Verb};
use pt326_rig::{Disturbance, FanConfig, RigConfig};

use super::Case;
use super::random::Random;
use crate::experiment::scenario::{Action, Scenario};
use crate::experiment::{as_written, slowness};

/// Length of a run on the default plant, s. Where it is to learn, learning is shortened to a part of it.
const LENGTH: f64 = 150.0;
const LEARNING: [f32; 2] = [15.0, 40.0];
/// However short a sample time was drawn.
const MOST_TICKS: f64 = 5000.0;
/// It lasts to the end.
const EVER: f64 = 1e7;

impl Case {
    /// The case of a number: always the same.
    pub fn draw(number: u64) -> Self {
        let mut r = Random::new(number);
        let (mut config, rig) = plant(&mut r);
        let slow = slowness(&config);
        let s = &mut config.supervisor;
        if r.happens(0.6) {
            [s.learn_start.0, s.learn_end.0] = LEARNING.map(|time| time * slow as f32);
        }
        // Above what full power reaches, too.
        let s = &config.supervisor;
        let reached = (rig.ambient + 90.0 * rig.gain).min(f64::from(s.setpoint_max.0));
        let highest = if r.happens(0.9) { reached } else { s.setpoint_max.0.into() };
        let lowest = (rig.ambient + 4.0).min(highest - 1.0).max(s.setpoint_min.0.into());
        let setpoint = |r: &mut Random| r.between(lowest, highest.max(lowest + 0.1)) as f32;
        config.setpoint.0 = setpoint(&mut r);
        let healthy = r.happens(0.25);
        if !healthy && r.happens(0.15) {
            config = r.settings(&config).unwrap_or(config);
        }
        let duration = (LENGTH * slow).min(MOST_TICKS * as_written(config.sample_time.0));
        let arm_at = if r.happens(0.3) { 0.0 } else { 2.0 * slow };
        let mut actions = Vec::new();
        if r.happens(0.4) {
            let at = r.between(arm_at, duration);
            actions.push(Action { at, setpoint: Some(setpoint(&mut r)), ..Action::default() });
        }
        if r.happens(0.15) {
            let at = r.between(arm_at, duration);
            let later = |seconds: f64| at + seconds * slow;
            actions.push(Action { at, stop: true, ..Action::default() });
            actions.push(Action { at: later(1.0), acknowledge: true, ..Action::default() });
            actions.push(Action { at: later(r.between(1.0, 20.0)), arm: true, ..Action::default() });
        }
        let faults = if healthy { Vec::new() } else { faults(&mut r, duration, slow) };
        let disturbance = r.one_of(&[Disturbance::None, Disturbance::Calm, Disturbance::Lively]);
        let checked = r.happens(0.5);
        Self {
            number,
            checked,
            settings: change::between(&Config::default(), &config),
            healthy,
            scenario: Scenario { duration, arm_at, disturbance, rig, faults, actions },
        }
    }
}

/// A plant and the settings that its user would give it.
fn plant(r: &mut Random) -> (Config, RigConfig) {
    let name = r.one_of(&["own", "own", "own", "own", "own", "trainer", "harsh", "oven", "hotend", "tclab"]);
    if name != "own" {
        let known = |what: anyhow::Result<RigConfig>| what.unwrap_or_default();
        let rig = RigConfig { ambient: r.between(10.0, 32.0), ..known(RigConfig::preset(name)) };
        return (preset::config(name).unwrap_or_default(), rig);
    }
    let rig = RigConfig {
        ambient: r.between(5.0, 35.0),
        gain: r.spread(0.2, 2.0),
        heater_time: r.spread(0.2, 1.5),
        dead_time: r.spread(0.03, 0.4),
        t1_lag: r.spread(0.03, 0.5),
        t2_lag: r.spread(0.05, 0.8),
        t2_delay: r.spread(0.03, 0.4),
        heat_loss: r.between(0.02, 0.25),
        turbulence: r.spread(0.03, 0.4),
        fan: FanConfig {
            free_flow: r.spread(0.01, 0.06),
            housing: r.between(0.0, 0.3),
            ..FanConfig::default()
        },
        ..RigConfig::default()
    };
    let mut config = Config::default();
    // Tuned to the gain and the times, which its user declares. A gain that is wrong by half he may not know.
    let answer = (rig.dead_time + rig.t1_lag + 4.0 * rig.heater_time).max(2.0) as f32;
    let times = answer / 2.0;
    let gain = 0.3 / rig.gain as f32;
    config.pid.kp *= gain;
    config.pid.ti.0 *= times;
    config.pid.td.0 *= times;
    config.prbs.amplitude.0 *= gain;
    config.identification.answer_time.0 = answer;
    config.identification.gain_max *= (rig.gain as f32 / 0.3).max(1.0);
    if r.happens(0.7) {
        config.identification.y_scale.0 *= r.spread(0.6, 1.6) as f32 / gain;
    }
    (config, rig)
}

/// One fault or two.
fn faults(r: &mut Random, duration: f64, slow: f64) -> Vec<Fault> {
    // At a moment that matters: from the start, when it is armed, while it warms up, while it learns, later.
    let at = match r.below(5) {
        0 => 0.0,
        1 => r.between(0.0, 4.0) * slow,
        2 => r.between(2.0, 15.0) * slow,
        _ => r.between(0.1, 0.8) * duration,
    };
    let mut faults = one(r, at, duration, slow);
    if r.happens(0.3) {
        let at = r.between(at, duration);
        faults.extend(one(r, at, duration, slow));
    }
    faults
}

/// A fault, or what comes together.
fn one(r: &mut Random, at: f64, duration: f64, slow: f64) -> Vec<Fault> {
    let fault = |verb, sensor, size| Fault::new(verb, sensor, size, at, EVER);
    let share = if r.happens(0.5) { r.between(0.85, 1.0) } else { r.between(0.3, 0.95) };
    let over = r.happens(0.4).then(|| r.spread(2.0, 150.0) * slow);
    let out = |sensor, size| Fault { over, ..fault(Verb::Detach, Some(sensor), Some(size)) };
    let air = [Sensor::T1, Sensor::T2];
    let any = [Sensor::T0, Sensor::T1, Sensor::T2];
    match r.below(14) {
        0 => vec![out(Sensor::T1, share)],
        1 | 2 => vec![out(Sensor::T1, share), out(Sensor::T2, share)],
        3 => vec![out(Sensor::T1, share), out(Sensor::T2, r.between(0.3, 1.0))],
        4 => {
            // Out, and back again.
            let lasts = r.spread(1.0, 40.0) * slow;
            air.map(|sensor| Fault { duration: lasts, ..out(sensor, share) }).to_vec()
        }
        5 => vec![fault(Verb::Return, None, Some(r.spread(200.0, 5000.0)))],
        6 => vec![fault(Verb::Shunt, Some(r.one_of(&any)), Some(r.spread(1000.0, 50_000.0)))],
        7 => {
            let with = r.below(3);
            vec![Fault { with: Some(any[(with + 1) % 3]), ..fault(Verb::Swap, Some(any[with]), None) }]
        }
        8 => vec![fault(Verb::HeaterStuck, None, Some(r.between(0.0, 100.0)))],
        9 => vec![Fault { over, ..fault(Verb::HeaterPower, None, Some(r.between(0.0, 2.0))) }],
        10 | 11 => {
            let left = if r.happens(0.6) { 0.0 } else { r.between(0.0, 0.4) };
            vec![Fault { over: over.or(Some(0.5 * slow)), ..fault(Verb::AirFlow, None, Some(left)) }]
        }
        12 => {
            let size = r.between(-25.0, 25.0);
            let sun = [Sensor::T0, Sensor::T0, Sensor::T1, Sensor::T2];
            vec![Fault { over, ..fault(Verb::Offset, Some(r.one_of(&sun)), Some(size)) }]
        }
        _ => {
            // A few false samples with both out: the worst moment is where a rule begins.
            let spike = Fault {
                duration: r.between(1.0, 4.0) * as_written(0.11) * slow,
                ..fault(Verb::Offset, Some(Sensor::T1), Some(r.between(-30.0, 30.0)))
            };
            let late = Fault { at: at + r.between(0.0, 0.2) * duration, ..spike.clone() };
            vec![out(Sensor::T1, share), out(Sensor::T2, share), spike, late]
        }
    }
}
