//! Tuning of the PID from a short experiment: heat at a constant power gives the gain, a relay around it (Astrom and Hagglund,
//! Automatica 20, 1984; the paper's reference 1) the answer at the frequency where the loop would oscillate. A model of first order with
//! dead time goes through both ([`Lag`]), and rules give PID settings with their margins.
//!
//! ```text
//!  Rest ─────▶ Warm ───────────────▶ Swing ─────────────▶ Measure ──▶ over
//!  no power,   constant power until  relay with            the same, period known:
//!  noise       T1 stands still       hysteresis: period    first harmonics of power and T1
//! ```
//!
//! It only says which power it wants, and ends by itself where anything is unclear. The supervisor has a mode for it, in which everything
//! that trips goes on tripping; it ends in off, however it ends ([`crate::Command::Tune`]).

pub mod lag;
pub mod search;

use crate::bounds::{larger, smaller};
use crate::units::{Celsius, Percent, Seconds};
pub use lag::{Lag, Margins, StepResponse, Tuned};
pub use search::Search;

/// Ticks at rest, from which noise and beginning are known.
const REST: u32 = 64;
/// Ticks of a block whose mean is held against that of the one before, and blocks in a row that must agree.
const BLOCK: u32 = 24;
const CALM_BLOCKS: u32 = 3;
/// Blocks that a rig may take to stand still.
const MOST_BLOCKS: u32 = 60;
/// Means agree within this share of the rise, or this many times their noise.
const SAME: f32 = 0.01;
const NOISE: f32 = 2.0;
/// What the relay adds, as a share of the mean power.
const SWING: f32 = 0.6;
/// Rises in degC: the least that is an answer, and the most that is allowed.
const LEAST_RISE: f32 = 2.0;
const MOST_RISE: f32 = 35.0;
/// Hysteresis of the relay in standard deviations of the noise, and the least of it, degC.
const HYSTERESIS: f32 = 2.5;
const LEAST_HYSTERESIS: f32 = 0.1;
/// Periods of the relay that pass unmeasured, that tell the period, and that are measured.
const SETTLING: u32 = 2;
const TIMED: u32 = 4;
const MEASURED: f32 = 12.0;
/// Ticks between two switches of the relay, at most.
const MOST_HALF: u32 = 500;
/// Ticks in a row for which a reading that is not to be believed is held.
const HELD: u32 = 3;

/// Powers of the experiment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Powers {
    /// Constant power, %.
    pub mean: Percent,
    /// What the relay adds to it and takes away, %.
    pub swing: Percent,
}

impl Powers {
    /// For a rig of about this gain, in degC per %: some 9 degC above the room, never above 40 %, and with the swing never above `most`.
    pub fn for_gain(gain: f32, most: Percent) -> Self {
        let mean = smaller(larger(9.0 / larger(0.01, gain), 2.0), 40.0);
        let mean = smaller(mean, most.0 / (1.0 + SWING));
        Self { mean: Percent(mean), swing: Percent(SWING * mean) }
    }
}

/// Why an experiment ended without a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unclear {
    /// A stop or a trip ended it.
    Stopped,
    /// T1 gave nothing to believe for some ticks.
    NoSample,
    /// T1 did not rise by 2 degC.
    NoAnswer,
    /// T1 rose by more than 35 degC.
    TooHot,
    /// T1 did not stand still under constant power.
    NotStill,
    /// The relay did not make it oscillate.
    NoSwing,
    /// What was measured is no lag with dead time.
    NoLag,
}

impl Unclear {
    /// The reason in words, for people.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Stopped => "it was stopped, or tripped",
            Self::NoSample => "T1 gave no valid sample",
            Self::NoAnswer => {
                "T1 did not rise by 2 degC: is the heater connected, is identification.y_scale right?"
            }
            Self::TooHot => "T1 rose by more than 35 degC: is identification.y_scale right?",
            Self::NotStill => {
                "T1 did not come to a stand under constant power: is it still warm, does the room or the air change?"
            }
            Self::NoSwing => "switching the power did not make T1 swing",
            Self::NoLag => "the answer of T1 is that of no lag with dead time",
        }
    }
}

/// How far an experiment has come.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Standing {
    /// No power: noise and beginning.
    Rest,
    /// Constant power, until T1 stands still.
    Warm,
    /// The relay: its period.
    Swing,
    /// The relay: the answer at that period.
    Measure,
    /// It has ended, with a model or without.
    Over(Result<Lag, Unclear>),
}

impl Standing {
    /// What is done, for people.
    pub const fn words(&self) -> &'static str {
        match self {
            Self::Rest => "at rest",
            Self::Warm => "constant power until T1 stands still",
            Self::Swing => "power switched up and down: the period",
            Self::Measure => "power switched up and down: the answer",
            Self::Over(Ok(_)) => "done",
            Self::Over(Err(unclear)) => unclear.words(),
        }
    }
}

/// An experiment that is under way.
#[derive(Clone, Copy, Debug)]
pub struct Tuning {
    powers: Powers,
    sample_time: f32,
    stage: Stage,
    /// T1 as last believed, and ticks since.
    held: (f32, u32),
    /// T1 at rest, the standard deviation of its noise, and the gain.
    rest: f32,
    noise: f32,
    gain: f32,
}

#[derive(Clone, Copy, Debug)]
enum Stage {
    Rest(Block),
    Warm { block: Block, before: f32, calm: u32, blocks: u32 },
    Swing { relay: Relay, ticks: u32, timed: u32 },
    Measure { relay: Relay, harmonics: Harmonics },
    Over(Result<Lag, Unclear>),
}

impl Tuning {
    /// Begins with the heater off.
    pub fn new(powers: Powers, sample_time: Seconds) -> Self {
        let stage = Stage::Rest(Block::default());
        Self {
            powers,
            sample_time: sample_time.0,
            stage,
            held: (0.0, HELD),
            rest: 0.0,
            noise: 0.0,
            gain: 0.0,
        }
    }

    /// One tick: from T1, where it is to be believed, the power until the next; none once it is over.
    pub fn step(&mut self, t1: Option<Celsius>) -> Percent {
        self.held = t1.map_or((self.held.0, self.held.1.saturating_add(1)), |t1| (t1.0, 0));
        self.stage = match self.held {
            (t1, 0..=HELD) => self.follow(t1),
            _ => Stage::Over(self.result().unwrap_or(Err(Unclear::NoSample))),
        };
        let Powers { mean, swing } = self.powers;
        match &self.stage {
            Stage::Rest(_) | Stage::Over(_) => Percent(0.0),
            Stage::Warm { .. } => mean,
            Stage::Swing { relay, .. } | Stage::Measure { relay, .. } => {
                Percent(mean.0 + relay.sign() * swing.0)
            }
        }
    }

    /// How far it has come.
    pub fn standing(&self) -> Standing {
        match self.stage {
            Stage::Rest(_) => Standing::Rest,
            Stage::Warm { .. } => Standing::Warm,
            Stage::Swing { .. } => Standing::Swing,
            Stage::Measure { .. } => Standing::Measure,
            Stage::Over(result) => Standing::Over(result),
        }
    }

    /// How it has ended, if it has.
    pub fn result(&self) -> Option<Result<Lag, Unclear>> {
        match self.stage {
            Stage::Over(result) => Some(result),
            _ => None,
        }
    }

    fn follow(&mut self, y: f32) -> Stage {
        if !(y - self.rest <= MOST_RISE) && !matches!(self.stage, Stage::Rest(_)) {
            return Stage::Over(Err(Unclear::TooHot));
        }
        match self.stage {
            Stage::Rest(mut block) => {
                block.add(y);
                if block.ticks < REST {
                    return Stage::Rest(block);
                }
                (self.rest, self.noise) = (block.mean(), block.deviation());
                Stage::Warm { block: Block::default(), before: block.mean(), calm: 0, blocks: 0 }
            }
            Stage::Warm { mut block, before, calm, blocks } => {
                block.add(y);
                if block.ticks < BLOCK {
                    return Stage::Warm { block, before, calm, blocks };
                }
                self.end_block(&block, before, calm, blocks)
            }
            Stage::Swing { mut relay, ticks, timed } => {
                let counts = relay.rises > SETTLING;
                let rose = relay.step(y);
                if relay.since > MOST_HALF {
                    return Stage::Over(Err(Unclear::NoSwing));
                }
                let (ticks, timed) = (ticks + u32::from(counts), timed + u32::from(rose && counts));
                if timed < TIMED {
                    return Stage::Swing { relay, ticks, timed };
                }
                let period = ticks as f32 / timed as f32;
                Stage::Measure { relay, harmonics: Harmonics::new(period) }
            }
            Stage::Measure { mut relay, mut harmonics } => {
                harmonics.add_answer(y - relay.level);
                relay.step(y);
                harmonics.add_power(relay.sign() * self.powers.swing.0);
                if relay.since > MOST_HALF {
                    return Stage::Over(Err(Unclear::NoSwing));
                }
                if !harmonics.is_complete() {
                    return Stage::Measure { relay, harmonics };
                }
                let frequency = harmonics.turn / self.sample_time;
                let answer = harmonics.answer();
                Stage::Over(Lag::through(self.gain, frequency, answer).ok_or(Unclear::NoLag))
            }
            Stage::Over(result) => Stage::Over(result),
        }
    }

    fn end_block(&mut self, block: &Block, before: f32, calm: u32, blocks: u32) -> Stage {
        let (mean, rise) = (block.mean(), block.mean() - self.rest);
        let same = (SAME * rise.abs()).max(NOISE * self.noise / libm::sqrtf(BLOCK as f32));
        let calm = if (mean - before).abs() < same { calm + 1 } else { 0 };
        if calm < CALM_BLOCKS {
            let blocks = blocks + 1;
            return match blocks < MOST_BLOCKS {
                true => Stage::Warm { block: Block::default(), before: mean, calm, blocks },
                false => Stage::Over(Err(Unclear::NotStill)),
            };
        }
        if rise < LEAST_RISE {
            return Stage::Over(Err(Unclear::NoAnswer));
        }
        self.gain = rise / self.powers.mean.0;
        let hysteresis = (HYSTERESIS * self.noise).max(LEAST_HYSTERESIS);
        Stage::Swing { relay: Relay::new(mean, hysteresis), ticks: 0, timed: 0 }
    }
}

/// Mean and deviation of some samples.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    ticks: u32,
    first: f32,
    sum: f32,
    squares: f32,
}

impl Block {
    fn add(&mut self, y: f32) {
        if self.ticks == 0 {
            self.first = y;
        }
        let x = y - self.first;
        (self.ticks, self.sum, self.squares) = (self.ticks + 1, self.sum + x, self.squares + x * x);
    }

    fn mean(&self) -> f32 {
        self.first + self.sum / self.ticks.max(1) as f32
    }

    fn deviation(&self) -> f32 {
        let n = self.ticks.max(1) as f32;
        libm::sqrtf((self.squares / n - self.sum * self.sum / (n * n)).max(0.0))
    }
}

/// A relay with hysteresis around a level.
#[derive(Clone, Copy, Debug)]
struct Relay {
    level: f32,
    hysteresis: f32,
    high: bool,
    /// Ticks since it switched, and how often it has switched to high.
    since: u32,
    rises: u32,
}

impl Relay {
    fn new(level: f32, hysteresis: f32) -> Self {
        Self { level, hysteresis, high: true, since: 0, rises: 0 }
    }

    /// Whether it has just switched to high.
    fn step(&mut self, y: f32) -> bool {
        let edge =
            if self.high { y > self.level + self.hysteresis } else { y < self.level - self.hysteresis };
        self.since += 1;
        if edge {
            self.high = !self.high;
            self.since = 0;
            self.rises += u32::from(self.high);
        }
        edge && self.high
    }

    fn sign(&self) -> f32 {
        if self.high { 1.0 } else { -1.0 }
    }
}

/// First harmonics of power and answer, over whole periods.
#[derive(Clone, Copy, Debug)]
struct Harmonics {
    /// Angle of a tick, and ticks to measure.
    turn: f32,
    ticks: u32,
    done: u32,
    power: [f32; 2],
    answer: [f32; 2],
}

impl Harmonics {
    fn new(period: f32) -> Self {
        let ticks = (MEASURED * period + 0.5) as u32;
        Self { turn: core::f32::consts::TAU / period, ticks, done: 0, power: [0.0; 2], answer: [0.0; 2] }
    }

    fn phase(&self) -> (f32, f32) {
        let angle = self.turn * self.done as f32;
        (libm::cosf(angle), libm::sinf(angle))
    }

    fn add_answer(&mut self, y: f32) {
        let (c, s) = self.phase();
        self.answer = [self.answer[0] + c * y, self.answer[1] - s * y];
    }

    fn add_power(&mut self, u: f32) {
        let (c, s) = self.phase();
        self.power = [self.power[0] + c * u, self.power[1] - s * u];
        self.done += 1;
    }

    fn is_complete(&self) -> bool {
        self.done >= self.ticks
    }

    /// Answer over power: size in degC per %, and how far it lags behind, rad.
    fn answer(&self) -> (f32, f32) {
        let [[yr, yi], [ur, ui]] = [self.answer, self.power];
        let (re, im) = (yr * ur + yi * ui, yi * ur - yr * ui);
        let size = libm::sqrtf((yr * yr + yi * yi) / (ur * ur + ui * ui));
        let ahead = libm::atan2f(im, re);
        (size, if ahead > 0.0 { core::f32::consts::TAU - ahead } else { -ahead })
    }
}

#[cfg(test)]
mod tests;
