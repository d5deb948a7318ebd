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
//! It only says which power it wants, and ends by itself where anything is unclear. The supervisor has a mode for it, in which all trips
//! but for the one that holds the power against the set-point's; it ends in off, however it ends ([`crate::Command::Tune`]).

pub mod lag;
pub mod search;
mod signal;
mod standing;

use core::f32::consts::TAU;

use crate::bounds::{larger, smaller};
use crate::units::{Celsius, Percent, Seconds};
pub use lag::{Lag, Margins, StepResponse, Tuned};
pub use search::Search;
use signal::{Block, Harmonics, Relay};
pub use standing::{Standing, Unclear};

/// Ticks at rest, from which noise and beginning are known.
const REST: u32 = 64;
/// Ticks of a block whose mean is held against that of the one before, and blocks in a row that must agree.
const BLOCK: u32 = 24;
const CALM_BLOCKS: u32 = 3;
/// Blocks that a rig may take to stand still.
const MOST_BLOCKS: u32 = 60;
/// Means agree within this share of the rise, or the deviation within a block: what shakes T1 is slow, and hardly less in the mean of a block.
const SAME: f32 = 0.01;
/// What the relay adds, as a share of the mean power.
const SWING: f32 = 0.6;
/// Rises in degC: the least that is an answer, and the most that is allowed.
const LEAST_RISE: f32 = 2.0;
const MOST_RISE: f32 = 35.0;
/// Hysteresis of the relay in standard deviations of the noise, and the least of it, degC.
const HYSTERESIS: f32 = 2.5;
const LEAST_HYSTERESIS: f32 = 0.1;
/// Periods of the relay that pass unmeasured, and that tell the period.
const SETTLING: u32 = 2;
const TIMED: u32 = 4;
/// So often a relay that does not keep its period is measured anew with the one that it had.
const TRIES: u32 = 10;
/// Ticks between two switches of the relay, at most.
const MOST_HALF: u32 = 500;
/// While the relay swings T1 stays above this share of its rise: the lower power alone keeps two fifths of it. A T1 that falls further is out of the air, and
/// would have the relay stay at the higher power.
const LEFT: f32 = 0.2;
/// Ticks of the whole experiment, at most.
const MOST_TICKS: u32 = 20_000;
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

/// An experiment that is under way.
#[derive(Clone, Copy, Debug)]
pub struct Tuning {
    powers: Powers,
    sample_time: f32,
    stage: Stage,
    /// T1 as last believed, and ticks since.
    held: (f32, u32),
    ticks: u32,
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
    Measure { relay: Relay, harmonics: Harmonics, tries: u32 },
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
            ticks: 0,
            rest: 0.0,
            noise: 0.0,
            gain: 0.0,
        }
    }

    /// One tick: from T1, where it is to be believed, the power until the next; none once it is over.
    pub fn step(&mut self, t1: Option<Celsius>) -> Percent {
        self.held = t1.map_or((self.held.0, self.held.1.saturating_add(1)), |t1| (t1.0, 0));
        self.ticks = self.ticks.saturating_add(1);
        self.stage = match self.held {
            _ if self.ticks > MOST_TICKS => Stage::Over(self.result().unwrap_or(Err(Unclear::NoSwing))),
            (t1, 0..=HELD) => self.follow(t1),
            _ => Stage::Over(self.result().unwrap_or(Err(Unclear::NoSample))),
        };
        match &self.stage {
            Stage::Rest(_) | Stage::Over(_) => Percent(0.0),
            _ => Percent(self.powers.mean.0 + self.excitation().0),
        }
    }

    /// What of the power moves, %: a live thermistor must move with it.
    pub fn excitation(&self) -> Percent {
        match &self.stage {
            Stage::Swing { relay, .. } | Stage::Measure { relay, .. } => {
                Percent(relay.sign() * self.powers.swing.0)
            }
            _ => Percent(0.0),
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
        if let Stage::Swing { relay, .. } | Stage::Measure { relay, .. } = &self.stage
            && y - self.rest < LEFT * (relay.level - self.rest)
        {
            return Stage::Over(Err(Unclear::Fell));
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
                Stage::Measure { relay, harmonics: Harmonics::new(period), tries: 1 }
            }
            Stage::Measure { mut relay, mut harmonics, tries } => {
                harmonics.add_answer(y - relay.level);
                let rose = relay.step(y);
                harmonics.add_power(relay.sign() * self.powers.swing.0, rose);
                if relay.since > MOST_HALF {
                    return Stage::Over(Err(Unclear::NoSwing));
                }
                if !harmonics.is_complete() {
                    return Stage::Measure { relay, harmonics, tries };
                }
                if !harmonics.is_kept(self.powers.swing.0) {
                    return match harmonics.period() {
                        Some(period) if tries < TRIES => {
                            Stage::Measure { relay, harmonics: Harmonics::new(period), tries: tries + 1 }
                        }
                        _ => Stage::Over(Err(Unclear::NoSwing)),
                    };
                }
                let frequency = TAU / (harmonics.expected * self.sample_time);
                let answer = harmonics.answer();
                Stage::Over(Lag::through(self.gain, frequency, answer).ok_or(Unclear::NoLag))
            }
            Stage::Over(result) => Stage::Over(result),
        }
    }

    fn end_block(&mut self, block: &Block, before: f32, calm: u32, blocks: u32) -> Stage {
        let (mean, rise) = (block.mean(), block.mean() - self.rest);
        let same = larger(SAME * rise.abs(), block.deviation());
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

#[cfg(test)]
mod tests;
