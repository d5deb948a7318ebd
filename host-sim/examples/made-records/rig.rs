//! A made record: an incubator, or another box with a heater, a thermistor and a lid. Its physics is its own, not that of the diagnosis.

use std::fmt::Write as _;
use std::ops::Range;

/// Samples that are learnt from, and of the whole record.
pub(crate) const LEARNT: usize = 2500;
pub(crate) const COUNT: usize = LEARNT + 5600;
/// Openings of a lid in a record.
const OPENINGS: usize = 7;
/// Steps of the integration in a sample.
const STEPS: usize = 4;

/// What is wrong for a while behind what is learnt from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Fault {
    /// Nothing, ever.
    None,
    /// The lid is opened seven times: heat is lost, and some of the air is exchanged at once.
    Lid,
    /// A fifth to two fifths of the power are missing.
    Weak,
    /// The heater gives so much more.
    Strong,
    /// The thermistor reads 1 to 3 degC too high or too low.
    Offset,
    /// The heater is on while it is asked for nothing.
    On,
    /// The heater gives the same whatever is asked for.
    Stuck,
}

/// A record, and when something was wrong.
pub(crate) struct Made {
    pub(crate) csv: String,
    pub(crate) faults: Vec<Range<usize>>,
    /// The rig, for people.
    pub(crate) rig: String,
}

/// Numbers that are the same each time.
pub(crate) struct Dice(u64);

impl Dice {
    pub(crate) fn of(seed: u64) -> Self {
        let mut dice = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        (0..8).for_each(|_| _ = dice.next());
        dice
    }

    pub(crate) fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// As likely between 1 and 2 as between 2 and 4.
    pub(crate) fn scale(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }
}

/// What does not change in a record. Times in s, temperatures in degC above the mean room, powers in %.
struct Rig {
    sample_time: f64,
    /// Time constants of walls and air, and degC a %.
    slow: f64,
    fast: f64,
    gain: f64,
    noise: f64,
    controller: Controller,
    /// How long the room remembers.
    room_time: f64,
    lid: Lid,
    faults: Vec<Range<usize>>,
    /// Share of the power, error of the thermistor, power that nobody asks for.
    share: f64,
    off: f64,
    given: f64,
}

/// How much more heat walls and air lose than usual while it is open, and the share of the air's heat that goes at once.
struct Lid {
    walls: f64,
    air: f64,
    at_once: f64,
}

#[derive(Clone, Copy)]
enum Controller {
    Pi,
    Thermostat,
    /// None: levels of the power.
    Levels,
}

impl Rig {
    fn drawn(dice: &mut Dice, fault: Fault) -> Self {
        let ts = [1.0, 2.0, 5.0, 10.0][dice.below(4)];
        let slow = dice.scale(100.0_f64.max(15.0 * ts), 2000.0_f64.min(300.0 * ts));
        let fast = dice.scale((1.5 * ts).max(slow / 40.0), slow / 6.0);
        let (gain, noise) = (dice.between(0.25, 0.6), dice.scale(0.02, 0.12));
        let controller = [Controller::Pi, Controller::Thermostat, Controller::Levels][dice.below(3)];
        let room_time = dice.between(1000.0, 6000.0);
        let lid =
            Lid { walls: dice.scale(0.5, 4.0), air: dice.scale(0.1, 1.0), at_once: dice.between(0.0, 0.4) };
        let opened = ((dice.between(0.25, 1.0) * slow / ts).max(12.0) as usize).min(120);
        let faults = match fault {
            Fault::None => Vec::new(),
            Fault::Lid => (0..OPENINGS)
                .map(|i| LEARNT + 400 + i * 730 + dice.below(100))
                .map(|from| from..from + opened)
                .collect(),
            _ => {
                let from = LEARNT + 1000 + dice.below(400);
                let lasts = (3.0 * slow / ts).clamp(200.0, 1500.0) as usize;
                std::iter::once(from..from + lasts).collect()
            }
        };
        let share = dice.between(0.2, 0.4);
        let off = dice.between(1.0, 3.0) * if dice.next() < 0.5 { -1.0 } else { 1.0 };
        let given = dice.between(25.0, 70.0);
        Self {
            sample_time: ts,
            slow,
            fast,
            gain,
            noise,
            controller,
            room_time,
            lid,
            faults,
            share,
            off,
            given,
        }
    }
}

/// What moves.
#[derive(Default)]
struct State {
    walls: f64,
    air: f64,
    room: f64,
    /// What is wanted of the air, degC, or of the power, %, and for how many samples more.
    wanted: f64,
    level: f64,
    hold: usize,
    /// Of the controllers.
    sum: f64,
    on: bool,
}

impl State {
    fn asks(&mut self, rig: &Rig, reads: f64) -> f64 {
        let left = self.wanted - reads;
        let asked = match rig.controller {
            Controller::Pi => {
                let kp = 0.5 * rig.slow / rig.fast / rig.gain / 3.0;
                let share = kp * rig.sample_time / rig.slow;
                self.sum =
                    if self.wanted > 0.0 { (self.sum + share * left).clamp(-20.0, 100.0) } else { 0.0 };
                if self.wanted > 0.0 { (kp * left + self.sum).clamp(0.0, 100.0) } else { 0.0 }
            }
            Controller::Thermostat => {
                self.on = left > 0.4 || (left >= -0.4 && self.on);
                if self.on && self.wanted > 0.0 { 85.0 } else { 0.0 }
            }
            Controller::Levels => self.level,
        };
        (10.0 * asked).round() / 10.0
    }

    /// A sample with this power, and what the lid loses on top.
    fn goes_on(&mut self, rig: &Rig, power: f64, [walls, air]: [f64; 2]) {
        let dt = rig.sample_time / STEPS as f64;
        for _ in 0..STEPS {
            self.walls += dt * (rig.gain * power - (1.0 + walls) * self.walls) / rig.slow;
            self.air += dt * (self.walls - (1.0 + air) * self.air) / rig.fast;
        }
    }
}

impl Made {
    /// The record of a seed, in a room that wanders with this standard deviation, degC.
    pub(crate) fn new(seed: u64, fault: Fault, wanders: f64) -> Self {
        let dice = &mut Dice::of(seed);
        let rig = Rig::drawn(dice, fault);
        let mut state = State::default();
        let mut csv = String::from("time,temp,power\n");
        let mut was_open = false;
        for k in 0..COUNT {
            if state.hold == 0 {
                state.hold = (dice.between(0.4, 2.0) * rig.slow / rig.sample_time) as usize + 20;
                let mut level = |low, high, of: f64| {
                    if fault == Fault::On && dice.next() < 0.4 { 0.0 } else { dice.between(low, high) * of }
                };
                state.wanted = level(0.3, 0.8, 80.0 * rig.gain);
                state.level = level(15.0, 85.0, 1.0);
            }
            state.hold -= 1;
            let now = if rig.faults.iter().any(|span| span.contains(&k)) { fault } else { Fault::None };
            let off = if now == Fault::Offset { rig.off } else { 0.0 };
            let reads = state.air + state.room + rig.noise * dice.normal() + off;
            let asked = state.asks(&rig, reads);
            let _ = writeln!(csv, "{},{:.3},{asked}", k as f64 * rig.sample_time, 21.0 + reads);
            let power = match now {
                Fault::Weak => asked * (1.0 - rig.share),
                Fault::Strong => asked * (1.0 + rig.share),
                Fault::On if asked == 0.0 => rig.given,
                Fault::Stuck => rig.given,
                _ => asked,
            };
            let open = now == Fault::Lid;
            if open && !was_open {
                state.air *= 1.0 - rig.lid.at_once;
            }
            was_open = open;
            state.goes_on(&rig, power, if open { [rig.lid.walls, rig.lid.air] } else { [0.0; 2] });
            let share = rig.sample_time / rig.room_time;
            state.room += wanders * (2.0 * share).sqrt() * dice.normal() - share * state.room;
        }
        let told = format!(
            "seed {seed}: {} s a sample, walls {:.0} s, air {:.0} s ({:.0} and {:.1} samples), {:.2} degC/%, noise {:.3} degC, {}",
            rig.sample_time,
            rig.slow,
            rig.fast,
            rig.slow / rig.sample_time,
            rig.fast / rig.sample_time,
            rig.gain,
            rig.noise,
            ["PI", "thermostat", "levels"][rig.controller as usize],
        );
        Self { csv, faults: rig.faults, rig: told }
    }
}
