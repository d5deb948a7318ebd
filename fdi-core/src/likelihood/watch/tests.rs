extern crate std;

use std::string::String;
use std::vec;
use std::vec::Vec;

use super::super::class::{Channel, FaultClass, Pair};
use super::super::onset::Onset;
use super::super::process::{Motion, Parameter, Parameters, Process, Rises};
use super::super::reference::Random;
use super::super::regressor::{LASTING, Regressor};
use super::super::second_heater::SecondHeater;
use super::super::whitening::ResidualStatistics;
use super::*;
use crate::likelihood::Tuning;

mod mains;

pub(super) const TS: f32 = 0.11;
/// When faults begin and end, ticks after the models are armed.
const ONSET: usize = 2000;
const END: usize = 2400;
const TICKS: usize = 3000;

/// The reference rig, about.
fn parameters() -> Parameters {
    Parameters([-1.2, 1.41, 0.9, -0.8, 0.03, 0.92, 0.9, 1.3, 0.01, 5.6, 0.2, -0.1, 0.0])
}

/// Residuals as those of the rig's turbulence: T2 follows T1, and has its own.
struct Noise {
    random: Random,
    e: [f32; 2],
}

impl Noise {
    fn tick(&mut self) -> [f32; 2] {
        let before = self.e[0];
        self.e[0] = 0.5 * self.e[0] + 0.05 * self.random.gaussian() as f32;
        self.e[1] = 0.5 * self.e[1] + 0.2 * before + 0.04 * self.random.gaussian() as f32;
        self.e
    }
}

fn watch() -> Watch {
    Watch::new(&LikelihoodConfig::default(), Tuned::default(), TS, 2.0)
}

/// A tick with these rises, at a T0 of 22 degC where it is known.
pub(super) fn input(tick: u32, y: [Option<f32>; 2], power: f32) -> Input {
    Input { tick, y, believed: y, t0: Some(22.0), power, second_power: 0.0, fan: 1.0 }
}

/// A rig at its set-point, its power excited, trained as it is.
pub(in crate::likelihood) fn trained(seed: u64) -> Trained {
    let mut noise = Noise { random: Random::new(seed), e: [0.0; 2] };
    let mut statistics = ResidualStatistics::default();
    for k in 0..4000 {
        let y = if k % 20 < 10 { [9.0; 2] } else { [15.0; 2] };
        statistics.push(noise.tick(), y);
    }
    let rise = 40.0 * libm::expf(-1.2);
    Trained {
        parameters: parameters(),
        motion: Motion::steady(40.0),
        whitening: statistics.finish(&Tuning::DEFAULT.whitening, 2).unwrap(),
        mean: [0.0; 2],
        beside: SecondHeater::default(),
        power: 40.0,
        rise,
        curvature_error: 0.0,
    }
}

/// What is wrong from ONSET to END.
#[derive(Clone, Copy)]
enum Wrong {
    /// What T1 and T2 read, by what they should and how many ticks it has been so.
    Readings(fn([f32; 2], usize) -> [f32; 2]),
    Flow(f32),
    /// The air flow, by for how many ticks it has been wrong.
    FlowBy(fn(usize) -> f32),
    Power(f32),
    Constant(f32),
}

/// A run with a fault: what is said on each tick.
struct Run {
    seed: u64,
    wrong: Wrong,
    missing: f64,
    end: usize,
    ticks: usize,
    /// How much steps of the power are known to move here, a share; none: what is assumed.
    steps: Option<f32>,
}

impl Run {
    fn new(wrong: Wrong, seed: u64) -> Self {
        Self { seed, wrong, missing: 0.0, end: END, ticks: TICKS, steps: None }
    }

    fn said(&self) -> Vec<Said> {
        self.run().0
    }

    /// What is said, and what is left at the end.
    fn run(&self) -> (Vec<Said>, WatchState) {
        let (watch, p) = (watch(), parameters());
        let (mut s, mut onset) = (watch.start(&trained(self.seed)), SinceOnsetState::default());
        if let Some(steps) = self.steps {
            s.tracker.know_steps(steps);
        }
        let mut random = Random::new(self.seed + 500);
        let mut noise = Noise { random: Random::new(self.seed + 1000), e: [0.0; 2] };
        let (mut motion, mut held) = (Motion::steady(40.0), [0.0; 2]);
        let (mut power, mut bit, mut said) = (40.0f32, 5.0, vec![]);
        for k in 0..self.ticks {
            let faulty = (ONSET..self.end).contains(&k);
            let flow = match self.wrong {
                Wrong::Flow(flow) if faulty => flow,
                Wrong::FlowBy(flow) if faulty => flow(k - ONSET),
                _ => 1.0,
            };
            let process = Process::new(Default::default(), &p, flow);
            let heat = match self.wrong {
                Wrong::Power(share) if faulty => share * process.heat(power),
                Wrong::Constant(power) if faulty => power,
                _ => process.heat(power),
            };
            let rises: Rises = process.step(&mut motion, heat);
            let e = noise.tick();
            let offsets = [p.get(Parameter::Offset1), p.get(Parameter::Offset2)];
            let mut y: [f32; 2] = core::array::from_fn(|m| rises.y[m] + offsets[m] + e[m]);
            if k + 1 == ONSET {
                held = y;
            }
            if let (Wrong::Readings(change), true) = (self.wrong, faulty) {
                y = change(y, k - ONSET);
                y = [0, 1].map(|m| if y[m] == HELD { held[m] } else { y[m] });
            }
            if k % 2 == 0 {
                bit = if random.uniform() > 0.5 { 5.0 } else { -5.0 };
            }
            power = 40.0 + bit;
            let missing = random.uniform() < self.missing;
            let seen = y.map(|y| if missing { None } else { Some(y) });
            said.push(watch.step(&mut s, &mut onset, &input(k as u32, seen, power)));
        }
        (said, s)
    }
}

/// Stands for what was read before the onset.
const HELD: f32 = -1e6;

/// A fault with what it is called, within how many s that is said, and its size with the error allowed.
type Case = (&'static str, Wrong, FaultClass, f32, Option<(f32, f32)>);

const CASES: [Case; 15] = [
    ("T1 +1.5", Wrong::Readings(|y, _| [y[0] + 1.5, y[1]]), FaultClass::T1Offset, 2.0, Some((1.5, 0.3))),
    ("T1 -1.5", Wrong::Readings(|y, _| [y[0] - 1.5, y[1]]), FaultClass::T1Offset, 16.0, Some((-1.5, 0.3))),
    ("T2 +1.5", Wrong::Readings(|y, _| [y[0], y[1] + 1.5]), FaultClass::T2Offset, 1.0, Some((1.5, 0.2))),
    ("T2 -1.5", Wrong::Readings(|y, _| [y[0], y[1] - 1.5]), FaultClass::T2Offset, 1.0, Some((-1.5, 0.2))),
    ("T0 +1.5", Wrong::Readings(|y, _| [y[0] - 1.5, y[1] - 1.5]), FaultClass::T0Fault, 2.0, Some((1.5, 0.3))),
    (
        "T1 clogged",
        Wrong::Readings(|y, _| [0.8 * y[0], y[1]]),
        FaultClass::T1Clogged,
        10.0,
        Some((-20.0, 3.0)),
    ),
    ("less air", Wrong::Flow(0.75), FaultClass::AirFlow, 5.0, Some((-25.0, 5.0))),
    ("more air", Wrong::Flow(1.3), FaultClass::AirFlow, 5.0, Some((30.0, 6.0))),
    ("less power", Wrong::Power(0.75), FaultClass::HeaterPower, 18.0, Some((-25.0, 3.0))),
    ("T2 stuck", Wrong::Readings(|y, _| [y[0], HELD]), FaultClass::Stuck(Channel::T2), 6.0, None),
    ("T1 out", Wrong::Readings(|y, _| [0.1 * y[0], y[1]]), FaultClass::T1Detached, 2.0, Some((-90.0, 8.0))),
    ("T2 out", Wrong::Readings(|y, _| [y[0], 0.1 * y[1]]), FaultClass::T2Detached, 2.0, Some((-90.0, 8.0))),
    ("T1, T2 swapped", Wrong::Readings(|y, _| [y[1], y[0]]), FaultClass::Swapped(Pair::T1T2), 2.0, None),
    (
        "T0, T1 swapped",
        Wrong::Readings(|y, _| [-y[0], y[1] - y[0]]),
        FaultClass::Swapped(Pair::T0T1),
        2.0,
        None,
    ),
    (
        "T0, T2 swapped",
        Wrong::Readings(|y, _| [y[0] - y[1], -y[1]]),
        FaultClass::Swapped(Pair::T0T2),
        2.0,
        None,
    ),
];

/// Faults that leave the tube's wall cold, or hot: after their end it takes a minute to be as it was.
const THOROUGH: [Case; 2] = [
    ("no power", Wrong::Power(0.0), FaultClass::HeaterPower, 10.0, Some((-100.0, 3.0))),
    ("all power", Wrong::Constant(100.0), FaultClass::HeaterPower, 10.0, None),
];

/// What is wrong with what is said of a fault: quiet before it; named in time, until its end, with its size; over in time, s.
fn complaint(
    (name, wrong, class, latest, size): Case,
    seed: u64,
    over_within: f32,
    missing: f64,
) -> Option<String> {
    let said = Run { missing, ..Run::new(wrong, seed) }.said();
    let named = |said: &Said| said.by_models().is_some_and(|finding| finding.class == class);
    let quiet = said[..ONSET].iter().all(|said| !said.alarm());
    let delay = said[ONSET..].iter().position(named).map(|k| k as f32 * TS);
    let last = said[END - 1].by_models();
    let value = last.and_then(|finding| finding.magnitude).map(|magnitude| magnitude.value);
    let sized = size.is_none_or(|(truth, error)| value.is_some_and(|value| (value - truth).abs() <= error));
    let held = last.is_some_and(|finding| finding.class == class && finding.confidence > 0.9);
    let heard = said[END..].iter().rposition(|said| said.alarm());
    let over = heard.map_or(0.0, |k| (k + 1) as f32 * TS);
    let right = quiet && delay.is_some_and(|delay| delay <= latest) && sized && held && over < over_within;
    (!right).then(|| {
        std::format!("{name}, seed {seed}: quiet {quiet}, after {delay:?} s, {last:?}, over {over} s")
    })
}

#[test]
fn each_fault_is_named_sized_and_over_when_it_is() {
    let complaints = |cases: &[Case], over_within: f32| -> Vec<String> {
        let runs = cases.iter().flat_map(|case| (1..4).map(move |seed| (*case, seed)));
        runs.filter_map(|(case, seed)| complaint(case, seed, over_within, 0.0)).collect()
    };
    let all = [complaints(&CASES, 8.0), complaints(&THOROUGH, 70.0)].concat();
    assert!(all.is_empty(), "{all:#?}");
}

/// One tick in ten without samples: the same is said.
#[test]
fn missing_samples_change_nothing_that_is_said() {
    let runs = CASES.iter().map(|case| complaint(*case, 4, 10.0, 0.1));
    let all: Vec<String> = runs.flatten().collect();
    assert!(all.is_empty(), "{all:#?}");
}

/// Rises as thermistors can say them, any power, any fan, samples that come and go: what is said is made of numbers, and so is the state.
#[test]
fn garbage_leaves_numbers() {
    let watch = watch();
    for seed in 1..4 {
        let mut random = Random::new(seed);
        let (mut s, mut onset) = (watch.start(&trained(seed)), SinceOnsetState::default());
        for tick in 0..20_000 {
            let wild = random.uniform() < 0.5;
            let mut reading = || {
                let (low, high) = if wild { (-130.0, 130.0) } else { (11.0, 13.0) };
                (random.uniform() > 0.1).then_some(random.between(low, high) as f32)
            };
            let [y1, y2, t0, b1, b2] = [reading(), reading(), reading(), reading(), reading()];
            let u = [0.0, 100.0, 40.0, 45.0, 35.0][(5.0 * random.uniform()) as usize % 5];
            let fan = if tick % 3000 < 2900 { 1.0 } else { random.between(0.05, 2.0) as f32 };
            let now = Input { believed: [b1, b2], t0, fan, ..input(tick, [y1, y2], u) };
            let said = watch.step(&mut s, &mut onset, &now);
            if let Some(finding) = said.by_models() {
                assert!((0.0..=1.0).contains(&finding.confidence), "tick {tick}, seed {seed}: {finding:?}");
                let numbers = finding.magnitude.map_or([0.0; 2], |size| [size.value, size.half_width]);
                assert!(numbers.iter().all(|x| x.is_finite()), "tick {tick}, seed {seed}: {finding:?}");
            }
            assert!((s.sum() + onset.sum()).is_finite(), "tick {tick}, seed {seed}");
        }
    }
}

/// Half an hour of a rig as it was learnt: not a word.
#[test]
fn nothing_is_said_of_nothing() {
    for seed in 11..16 {
        let said = Run::new(Wrong::Power(1.0), seed).said();
        assert!(said.iter().all(|said| !said.alarm()), "seed {seed}");
    }
}

/// A sag of the mains by 3 % is nobody's fault: nothing is said, and the tracker has it after some minutes.
#[test]
fn a_sag_is_followed_without_a_word() {
    for seed in 21..24 {
        let said = Run::new(Wrong::Power(0.97), seed).said();
        assert!(said.iter().all(|said| !said.alarm()), "seed {seed}");
    }
}

/// A thermistor without samples during a fault: what was said of it stands, and T2 goes on to correct the virtual T1.
#[test]
fn without_samples_the_verdict_stands() {
    let watch = watch();
    let (mut s, mut onset) = (watch.start(&trained(9)), SinceOnsetState::default());
    let mut noise = Noise { random: Random::new(9), e: [0.0; 2] };
    let mut said = Said::default();
    let mut step = |s: &mut WatchState, noise: &mut Noise, tick: u32, offset: f32, missing: bool| {
        let e = noise.tick();
        let y2 = s.rises()[1] - 0.1 + e[1] + offset;
        let y = [(!missing).then_some(s.rises()[0] + 0.2 + e[0]), Some(y2)];
        watch.step(s, &mut onset, &input(tick, y, 40.0))
    };
    for tick in 0..1100 {
        said = step(&mut s, &mut noise, tick, if tick < 1000 { 0.0 } else { 1.5 }, false);
    }
    let class = said.by_models().map(|finding| finding.class);
    assert_eq!(class, Some(FaultClass::T2Offset));
    for tick in 1100..1200 {
        let held = step(&mut s, &mut noise, tick, 1.5, true);
        assert_eq!(held.by_models().map(|finding| finding.class), class);
    }
    let (virtual_t1, expected) = (s.virtual_t1().unwrap(), s.expected()[0]);
    assert!((virtual_t1 - expected - 1.5 / 0.92).abs() < 0.2, "{virtual_t1} {expected}");
    for tick in 1200..1400 {
        step(&mut s, &mut noise, tick, -10.0, true);
    }
    assert_eq!(s.virtual_t1(), None, "T2 and the models disagree");
}

/// What nuisances explain goes to the tracker, and the whitened residuals are those that they would be had it always been known.
#[test]
fn what_the_tracker_takes_over_leaves_no_step() {
    let mut s = watch().start(&trained(7));
    let e = [0.4, 0.3];
    let mut row = [[0.0; 2]; LASTING];
    row[Regressor::Offset1 as usize] = [1.0, 0.0];
    row[Regressor::Offset2 as usize] = [0.0, 1.0];
    row[Regressor::Power as usize] = s.rises();
    for _ in 0..60 {
        s.innovations.step(e, e, [0.0; 2]);
    }
    let (mut onset, values) = (SinceOnsetState::default(), [0.0, 0.0, 0.3, 0.25]);
    watch().carry_out(&mut s, &mut onset, Outcome::Usual(values), e, &row);
    let known = s.tracker.expected(&row);
    assert_eq!(known, [0.3, 0.25]);
    let left = [e[0] - known[0], e[1] - known[1]];
    let mut always = InnovationsState::new(Tuned::default(), *s.innovations.filter());
    for _ in 0..60 {
        always.step(left, e, [0.0; 2]);
    }
    let (now, wanted) = (s.innovations.step(left, e, [0.0; 2]), always.step(left, e, [0.0; 2]));
    for m in 0..2 {
        assert!((now.z[m] - wanted.z[m]).abs() < 1e-3 && (now.clipped[m] - wanted.clipped[m]).abs() < 1e-3);
    }
}

/// However far the model may be off while the temperature swings, a thermistor that jumps by more than that is charted within two ticks.
#[test]
fn a_jump_shows_in_a_swing() {
    let (watch, mut s) = (watch(), watch().start(&trained(5)));
    let inlet = 0.0;
    // A rise that swings from 12 to 60 degC: 2 % of that are ten standard deviations and more.
    let mut charted = |e: [f32; 2]| {
        let widened = watch.charts.widened(&mut s.charts, &s.times, s.innovations.filter(), 60.0);
        assert!(widened[0] > 10.0, "{widened:?}");
        let innovations = s.innovations.step(e, e, widened);
        watch.charts.step(&mut s.charts, &s.times, s.innovations.filter(), &innovations, widened, inlet)
    };
    for _ in 0..20 {
        assert!(charted([0.0; 2]).fast <= 0.0);
    }
    let jumped = [charted([8.0, 0.0]), charted([8.0, 0.0])];
    assert!(jumped[1].fast > 1.0, "{jumped:?}");
}

/// Who looks after the tick sees the same regressors as the watch did within it.
#[test]
fn a_tick_can_be_looked_at_again() {
    let (watch, mut s) = (watch(), watch().start(&trained(3)));
    let (mut within, mut after) = (Onset::default(), Onset::default());
    for k in 0..120 {
        let power = if (k / 7) % 3 == 0 { 45.0 } else { 30.0 };
        let simulated = watch.simulation.step(&mut s.simulation, &s.times, &input(k, [None; 2], power));
        let filter = s.innovations.filter();
        let step = |onset: &mut Onset, simulated: &Simulated| {
            onset.step(&s.times.onset, filter, &s.simulation.nominal(simulated))
        };
        if k > 40 {
            assert_eq!(step(&mut within, &simulated), step(&mut after, &s.simulation.last()), "{k}");
        }
    }
    assert!(after.age > 70);
}

/// Dirt that takes a quarter of the air within ten minutes, and is cleaned away at once a minute later: the alarm that was right ends, and none takes
/// its place, though the tracker had taken a part of it for what is usual.
#[test]
fn a_slow_fault_that_is_mended_leaves_no_alarm() {
    const SLOW: usize = 5454;
    const MENDED: usize = ONSET + SLOW + 545;
    for seed in 31..34 {
        let clogs = Wrong::FlowBy(|age| 1.0 - 0.25 * (age as f32 / SLOW as f32).min(1.0));
        let run = Run { end: MENDED, ticks: MENDED + 2000, ..Run::new(clogs, seed) };
        let said = run.said();
        assert!(said[ONSET..MENDED].iter().any(Said::alarm), "seen, seed {seed}");
        let last = said[MENDED..].iter().rposition(Said::alarm).map_or(0.0, |k| (k + 1) as f32 * TS);
        assert!(last < 90.0, "an alarm {last} s after it was mended, seed {seed}");
    }
}
