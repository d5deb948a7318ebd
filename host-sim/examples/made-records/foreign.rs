//! Heaters of other people: hotends, incubators, floors, labs. Two thermal lags, a dead time, a wall, one of four controllers, by a physics of its own; a
//! fault stays up to the end of the record (docs/evidence/records.md).

use std::collections::VecDeque;
use std::fmt::Write as _;

use pt326_host::recording::run::Diagnosed;

use crate::rig::{COUNT, Dice, Fault, LEARNT, Made};
use crate::score::names;

/// Steps of the integration in a sample.
const STEPS: usize = 8;
/// Sample times, s.
const SAMPLE_TIMES: [f64; 7] = [0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0];
/// A heater answers over so many samples.
const ANSWERS: (f64, f64) = (8.0, 300.0);
/// A fault is seen soon within so many samples.
const SOON: usize = 100;

/// What people heat: the slower time constant, s, and the rise at full power, degC.
struct Kind {
    name: &'static str,
    slow: (f64, f64),
    rise: (f64, f64),
}

const KINDS: [Kind; 5] = [
    Kind { name: "dryer", slow: (10.0, 40.0), rise: (30.0, 80.0) },
    Kind { name: "hotend", slow: (60.0, 250.0), rise: (200.0, 400.0) },
    Kind { name: "lab", slow: (100.0, 220.0), rise: (30.0, 65.0) },
    Kind { name: "incubator", slow: (300.0, 1800.0), rise: (15.0, 40.0) },
    Kind { name: "floor", slow: (900.0, 3600.0), rise: (10.0, 30.0) },
];

#[derive(Clone, Copy, Debug)]
enum Controller {
    Pi,
    Pid,
    Relay,
    /// None: steps of the power.
    Steps,
}

/// What does not change in a record. Times in s, temperatures in degC, powers in %.
struct Rig {
    kind: &'static str,
    sample_time: f64,
    slow: f64,
    fast: f64,
    dead: f64,
    /// The share of the rise that comes with the wall, and its time constant.
    wall: (f64, f64),
    /// degC a %.
    gain: f64,
    noise: f64,
    /// T1 is logged in steps of so much.
    step: f64,
    controller: Controller,
    /// What is wrong from this sample on: error of T1, degC, and the share of the power that is lost.
    from: usize,
    off: f64,
    lost: f64,
}

impl Rig {
    fn drawn(dice: &mut Dice, fault: Fault) -> Self {
        let kind = &KINDS[dice.below(KINDS.len())];
        let slow = dice.scale(kind.slow.0, kind.slow.1);
        let fits = |ts: &f64| (ANSWERS.0..ANSWERS.1).contains(&(slow / ts));
        let times: Vec<f64> = SAMPLE_TIMES.into_iter().filter(fits).collect();
        let sample_time = times[dice.below(times.len())];
        let rise = dice.between(kind.rise.0, kind.rise.1);
        let noise = rise * dice.scale(0.0003, 0.003);
        let sign = if dice.next() < 0.5 { -1.0 } else { 1.0 };
        let off = sign * (rise * dice.between(0.02, 0.08)).max(12.0 * noise);
        let lost = dice.between(0.15, 0.4);
        Self {
            kind: kind.name,
            sample_time,
            slow,
            fast: slow * dice.scale(0.03, 0.25),
            dead: slow * dice.between(0.0, 0.12),
            wall: (dice.between(0.0, 0.2), slow * dice.between(4.0, 12.0)),
            gain: rise / 100.0,
            noise,
            step: [0.01, 0.0625, 0.1][dice.below(3)],
            controller: [Controller::Pi, Controller::Pid, Controller::Relay, Controller::Steps]
                [dice.below(4)],
            from: if fault == Fault::None { COUNT } else { LEARNT + 1000 + dice.below(2000) },
            off: if fault == Fault::Offset { off } else { 0.0 },
            lost: if fault == Fault::Weak { lost } else { 0.0 },
        }
    }
}

/// What moves: heats of block, thermistor and wall as rises, degC, what is on its way, and the controller.
#[derive(Default)]
struct State {
    heat: f64,
    thermistor: f64,
    wall: f64,
    way: VecDeque<f64>,
    wanted: f64,
    sum: f64,
    last: f64,
    on: bool,
}

impl State {
    /// The power that is asked for, %; `wanted` is a rise, or without a controller a power as a rise in the end.
    fn asks(&mut self, rig: &Rig, reads: f64) -> f64 {
        let left = self.wanted - reads;
        let kp = rig.slow / rig.gain / (3.0 * (rig.fast + rig.dead) + 0.3 * rig.slow);
        let slope = (reads - std::mem::replace(&mut self.last, reads)) / rig.sample_time;
        let asked = match rig.controller {
            Controller::Steps => self.wanted / rig.gain,
            Controller::Relay => {
                let band = (0.01 * 100.0 * rig.gain).max(4.0 * rig.noise);
                self.on = left > band || (left > -band && self.on);
                if self.on { 100.0 } else { 0.0 }
            }
            Controller::Pi | Controller::Pid => {
                let by_slope =
                    if matches!(rig.controller, Controller::Pid) { 0.5 * rig.fast * slope } else { 0.0 };
                let asked = kp * (left - by_slope) + self.sum;
                if (0.0..100.0).contains(&asked) {
                    self.sum += kp * rig.sample_time / rig.slow * left;
                }
                asked
            }
        };
        (10.0 * asked.clamp(0.0, 100.0)).round() / 10.0
    }

    fn goes_on(&mut self, rig: &Rig, power: f64) {
        let dt = rig.sample_time / STEPS as f64;
        for _ in 0..STEPS {
            self.heat += dt / rig.slow * (rig.gain * power - self.heat);
            self.way.push_back(self.heat);
            let arrived = if self.way.len() as f64 * dt > rig.dead { self.way.pop_front() } else { None };
            self.thermistor += dt / rig.fast * (arrived.unwrap_or(0.0) - self.thermistor);
            self.wall += dt / rig.wall.1 * (self.thermistor - self.wall);
        }
    }

    fn rise(&self, rig: &Rig) -> f64 {
        self.thermistor + rig.wall.0 * (self.wall - self.thermistor)
    }
}

/// The record of a seed, in a room that wanders with this standard deviation, degC; and the true size of its fault, degC or %.
pub(crate) fn made(seed: u64, fault: Fault, wanders: f64) -> (Made, f64) {
    let dice = &mut Dice::of(seed);
    let rig = Rig::drawn(dice, fault);
    let (mut state, mut csv) = (State::default(), String::from("time,temp,power\n"));
    let (mut hold, mut room) = (0, 0.0);
    let share = rig.sample_time / (5.0 * rig.slow).max(1000.0);
    for k in 0..COUNT {
        if hold == 0 {
            hold = (dice.between(0.7, 4.0) * rig.slow / rig.sample_time) as usize + 20;
            state.wanted = dice.between(0.2, 0.75) * 100.0 * rig.gain;
        }
        hold -= 1;
        let is_wrong = k >= rig.from;
        let off = if is_wrong { rig.off } else { 0.0 };
        let reads = state.rise(&rig) + room + rig.noise * dice.normal() + off;
        let asked = state.asks(&rig, reads);
        let logged = ((21.0 + reads) / rig.step).round() * rig.step;
        let _ = writeln!(csv, "{},{logged:.3},{asked}", k as f64 * rig.sample_time);
        state.goes_on(&rig, asked * if is_wrong { 1.0 - rig.lost } else { 1.0 });
        room += wanders * (2.0 * share).sqrt() * dice.normal() - share * room;
    }
    let told = format!(
        "seed {seed}: {}, {:?}, {} s a sample, lags {:.0} and {:.1} s, dead time {:.1} s, wall {:.0} % with {:.0} s, {:.2} degC/%, noise {:.3} degC; \
         T1 off by {:.2} degC, {:.0} % less power",
        rig.kind,
        rig.controller,
        rig.sample_time,
        rig.slow,
        rig.fast,
        rig.dead,
        100.0 * rig.wall.0,
        rig.wall.1,
        rig.gain,
        rig.noise,
        rig.off,
        100.0 * rig.lost,
    );
    let faults = std::iter::once(rig.from..COUNT).filter(|span| !span.is_empty()).collect();
    (Made { csv, faults, rig: told }, rig.off - 100.0 * rig.lost)
}

/// What was said of a record.
pub(crate) struct Said {
    has_fault: bool,
    /// In alarm within [`SOON`], by its own name when the last alarm ended, and in alarm at the end of the record.
    soon: bool,
    named: bool,
    to_the_end: bool,
    /// Alarms that began without a fault.
    raised: usize,
    /// What the last size that was told errs by, %, where the name was right.
    error: Option<f64>,
}

impl Said {
    pub(crate) fn of(made: &Made, fault: Fault, size: f64, done: &Diagnosed) -> Self {
        let names = names(done);
        let from = made.faults.first().map_or(COUNT, |span| span.start);
        let last = names[from..].iter().rev().flatten().next();
        let named = last.is_some_and(|name| name == fault.name());
        let findings = done.record.rows.iter().rev().filter_map(|row| row.report.likelihood.finding);
        let told = findings.filter_map(|finding| finding.magnitude).next().filter(|_| named);
        Self {
            has_fault: from < COUNT,
            soon: names[from..].iter().take(SOON).any(Option::is_some),
            named,
            to_the_end: from < COUNT && names[COUNT - 1].is_some(),
            raised: (LEARNT..from).filter(|k| names[*k].is_some() && names[*k - 1].is_none()).count(),
            error: told.map(|told| 100.0 * (f64::from(told.value) / size - 1.0).abs()),
        }
    }
}

/// Cells of a table.
pub(crate) fn cells(said: &[Said]) -> String {
    let count = |of: fn(&Said) -> bool| said.iter().filter(|said| of(said)).count();
    let mut errors: Vec<f64> = said.iter().filter_map(|said| said.error).collect();
    errors.sort_by(f64::total_cmp);
    let median = errors.get(errors.len() / 2).map_or(String::new(), |error| format!("{error:.0} %"));
    let raised: usize = said.iter().map(|said| said.raised).sum();
    let soon = format!("{} | {} of {}", said.len(), count(|said| said.soon), count(|said| said.has_fault));
    let [named, to_the_end] = [count(|said| said.named), count(|said| said.to_the_end)];
    format!("{soon} | {named} | {to_the_end} | {median} | {raised}")
}
