//! `check`: the board's self-test. At rest it looks at the thermistors; then it heats a little, in a way that tells the
//! contactor from the MOSFET and one thermistor from another, and leaves the heater off.
//!
//! ```text
//!  Rest ──▶ MosfetOff ─────▶ Pulses ───────▶ Order ──────▶ Settle ──▶ ContactorOpen ──▶ over
//!  no heat  contactor only,  both, stepped   the same for             power, but the
//!           no power         up until one    4 cycles: who            contactor open
//!                            answers         answers first
//! ```
//!
//! Whatever is found ends it, but for notes; so do a stop, a hazard, a thermistor that is lost or rises too far, and at the
//! latest its longest duration. It only says what it wants; the control loop drives the output.

mod answers;
mod cycles;
pub mod finding;
mod lock_in;
pub mod progress;
mod rest;
pub mod stage;
#[cfg(test)]
mod tests;

use fdi_core::control::Plant;
use fdi_core::likelihood::Channel;
use fdi_core::{Percent, RawSample, Reading, Sample, TripReason, Validity};
use heapless::Vec;

pub use finding::{CheckFinding, Ending};
pub use lock_in::CYCLE;
use lock_in::{Answer, Cycle, Noise};
pub use progress::{News, Progress};
use rest::Resting;
pub use stage::{Output, Proof, Stage};

/// The thermistors in the order of all arrays here.
const CHANNELS: [Channel; 3] = [Channel::T0, Channel::T1, Channel::T2];
/// Most that one check can find: three of each thermistor, the interlock, the contactor, what ended it.
pub const MAX_FINDINGS: usize = 8;

/// Cycles at rest that must be calm, one after the other: they measure the noise, too.
const CALM_CYCLES: u32 = 3;
/// A step is a tick, or as many as make so many steps of the rig's answer.
const STEPS: u32 = 40;
/// Cycles (of 4.4 s where a step is a tick of 110 ms) that a rig may take to come to rest: 2 minutes.
const WAITING_CYCLES: u32 = 27;
/// Ticks for which the contactor is closed with no power asked for: a shorted MOSFET then gives all of it. 0.11 s shows on a
/// strong rig and warms it by 22 degC at most; only what has not shown then, on a weaker one, is given 0.66 and 2.2 s.
const CLOSED_TICKS: [u32; 3] = [1, 6, 20];
/// Powers of the pulses in %, stepped up until one is answered: the rig's gain may be anywhere from 0.05 to 1 degC per %. Of a rig
/// that is said to be stronger they are divided by its gain.
pub const LEVELS: [f32; 4] = [2.5, 5.0, 10.0, 20.0];
/// Cycles by which order and silence are judged; at the largest power so many more where the noise asks for it.
const ORDER_CYCLES: u32 = 4;
const MOST_CYCLES: u32 = 12;
/// Rise in degC above the beginning at which the check ends: well above the answer of the strongest rig to the smallest
/// pulse, 2.5 degC, and below the 5 degC that the supervisor takes for a heater that is stuck on.
pub const MAX_RISE: f32 = 4.5;
/// Ticks in a row, while heating, that a thermistor may give nothing to believe.
const MAX_LOST: u32 = 5;
/// Ticks of a cycle at rest that may give nothing to believe: a spike now and then is no fault.
const MAX_DOUBTS: u32 = CYCLE / 10;
/// Codes this close are no movement: half of the converter's step, on the mean of many.
const STILL: f32 = 0.5;
/// Steps that no check can exceed.
pub const LONGEST: u32 = CYCLE
    * (WAITING_CYCLES
        + CALM_CYCLES
        + CLOSED_TICKS.len() as u32
        + LEVELS.len() as u32 * (1 + ORDER_CYCLES)
        + MOST_CYCLES
        + 1
        + MOST_CYCLES);

/// Ticks of a step, where the rig's answer takes `answer_ticks`.
pub fn step_ticks(answer_ticks: u32) -> u32 {
    (answer_ticks / STEPS).max(1)
}

/// A check that is under way.
#[derive(Clone, Debug)]
pub struct SelfTest {
    stage: Stage,
    /// Ticks of a step, and what the powers are divided by.
    step_ticks: u32,
    gain: f32,
    /// Tick of the step, step of the cycle, cycles of the stage, ticks of all.
    tick: u32,
    step: u32,
    cycles: u32,
    elapsed: u32,
    /// Cycles without heat, at the beginning.
    waited: u32,
    /// What T1 has answered to each per cent, degC; 0 for not yet.
    measured_gain: f32,
    /// Index of the pulse's power, and the cycles by which it was judged.
    level: usize,
    judged_cycles: u32,
    /// The last reading of each that can be believed, in degC, and the ticks since.
    last: [f32; 3],
    lost: [u32; 3],
    /// Temperatures at the beginning of the heat; before that, of a cycle.
    start: [f32; 3],
    /// Extremes of the codes since the beginning.
    codes: [(f32, f32); 3],
    resting: [Resting; 3],
    cycle: [Cycle; 3],
    noises: [Noise; 3],
    answers: [Answer; 3],
    findings: Vec<CheckFinding, MAX_FINDINGS>,
    ending: Option<Ending>,
    reported: Reported,
}

/// What has been reported to the other half.
#[derive(Clone, Copy, Debug)]
struct Reported {
    stage: Option<Stage>,
    findings: usize,
    ended: bool,
}

impl SelfTest {
    /// Begins with what the interlock's proof gave, on a rig of which the settings say this.
    pub fn new(proof: Proof, plant: &Plant) -> Self {
        let mut findings = Vec::new();
        let found = match proof {
            Proof::OpenHolds => Some(CheckFinding::InterlockOpen),
            Proof::OpenButEnabled => Some(CheckFinding::OpenButEnabled),
            Proof::DoesNotCut => Some(CheckFinding::DoesNotCut),
            Proof::Cuts { seen: false } => Some(CheckFinding::CutNotSeen),
            Proof::Cuts { seen: true } => None,
        };
        if let Some(found) = found {
            let _ = findings.push(found);
        }
        Self {
            stage: Stage::Rest,
            step_ticks: step_ticks(plant.answer_ticks),
            gain: plant.gain.max(1.0),
            tick: 0,
            step: 0,
            cycles: 0,
            elapsed: 0,
            waited: 0,
            measured_gain: 0.0,
            level: 0,
            judged_cycles: 0,
            last: [f32::NAN; 3],
            lost: [0; 3],
            start: [0.0; 3],
            codes: [(f32::INFINITY, f32::NEG_INFINITY); 3],
            resting: [Resting::UNKNOWN; 3],
            cycle: [Cycle::default(); 3],
            noises: [Noise::default(); 3],
            answers: [Answer::default(); 3],
            findings,
            ending: None,
            reported: Reported { stage: None, findings: 0, ended: false },
        }
    }

    /// How it ended; `None` while it has not.
    pub fn ending(&self) -> Option<Ending> {
        self.ending
    }

    /// The rig's gain, degC of T1 per %, of a check that has passed; on the simulated rigs within a quarter.
    pub fn measured_gain(&self) -> Option<f32> {
        (self.ending == Some(Ending::Passed)).then_some(self.measured_gain)
    }

    /// Where it stands.
    #[cfg(test)]
    pub(crate) fn stage(&self) -> Stage {
        self.stage
    }

    /// Ends it early.
    pub fn abort(&mut self, ending: Ending) {
        self.ending.get_or_insert(ending);
        self.stage = Stage::Over;
    }

    /// What has not been reported yet, a piece at a time.
    pub fn news(&mut self) -> Option<News> {
        if self.reported.stage.is_none()
            || (self.reported.stage != Some(self.stage) && self.stage != Stage::Over)
        {
            self.reported.stage = Some(self.stage);
            return Some(News::Stage(self.stage));
        }
        if let Some(finding) = self.findings.get(self.reported.findings) {
            self.reported.findings += 1;
            return Some(News::Found(*finding));
        }
        let ending = self.ending.filter(|_| !self.reported.ended)?;
        self.reported.ended = true;
        Some(News::Ended(ending))
    }

    /// Whether all has been reported.
    pub fn is_reported(&self) -> bool {
        self.reported.ended
    }

    /// One tick: from what was sampled what the output is to be until the next. `hazard` is what would trip.
    pub fn step(&mut self, sample: &Sample, raw: &RawSample, hazard: Option<TripReason>) -> Output {
        if self.stage == Stage::Over {
            return Output::Off;
        }
        self.elapsed += 1;
        self.look(sample, raw);
        if let Some(finding) = self.danger(sample, hazard) {
            self.fail(finding);
        } else if self.is_too_long() {
            self.end();
        } else {
            self.tick += 1;
            if self.tick >= self.step_ticks {
                self.end_step(hazard);
            }
        }
        self.output()
    }

    fn is_too_long(&self) -> bool {
        self.elapsed > LONGEST.saturating_mul(self.step_ticks)
    }

    fn end_step(&mut self, hazard: Option<TripReason>) {
        self.tick = 0;
        self.step += 1;
        if self.step >= CYCLE {
            self.step = 0;
            self.end_cycle(hazard);
            self.cycle = [Cycle::default(); 3];
        }
    }

    /// Follows readings and codes.
    fn look(&mut self, sample: &Sample, raw: &RawSample) {
        let readings = [sample.t0, sample.t1, sample.t2];
        let codes = [raw.t0.0, raw.t1.0, raw.t2.0];
        let (first, step, fresh) = (self.tick == 0, self.step, self.elapsed == 1);
        let seen = readings.iter().zip(codes).zip(&mut self.last).zip(&mut self.lost).zip(&mut self.codes);
        for ((((reading, code), last), lost), extremes) in seen {
            if reading.validity == Validity::Good {
                *last = reading.celsius.0;
                *lost = 0;
                *extremes = (extremes.0.min(code), extremes.1.max(code));
            } else {
                *lost += 1;
            }
        }
        let at_rest = matches!(self.stage, Stage::Rest | Stage::Cooling);
        let each = self.cycle.iter_mut().zip(&mut self.resting).zip(&mut self.start).zip(self.last);
        for ((((cycle, resting), start), last), reading) in each.zip(readings) {
            if fresh || !start.is_finite() {
                *start = last;
            }
            if at_rest {
                resting.see(reading.celsius.0, reading.validity);
            }
            // Not a number until the first good reading: that cycle counts for nothing, as its doubts are too many.
            if first {
                cycle.add(step, if last.is_finite() { last - *start } else { 0.0 });
            }
        }
    }

    /// What makes it dangerous, or pointless, to go on heating.
    fn danger(&self, sample: &Sample, hazard: Option<TripReason>) -> Option<CheckFinding> {
        if matches!(self.stage, Stage::Rest | Stage::Cooling) {
            return None;
        }
        let readings: [Reading; 3] = [sample.t0, sample.t1, sample.t2];
        let each = CHANNELS.into_iter().zip(readings).zip(self.start).zip(self.lost);
        let found = |(((channel, reading), start), lost): (((Channel, Reading), f32), u32)| {
            let rise = reading.celsius.0 - start;
            match reading.validity {
                Validity::Open | Validity::Short => Some(CheckFinding::Broken(channel, reading.validity)),
                // A reading that jumped may be true: hot is hot.
                _ if !(rise <= MAX_RISE) => Some(self.too_hot(channel, rise)),
                doubt if lost > MAX_LOST => Some(CheckFinding::Broken(channel, doubt)),
                _ => None,
            }
        };
        each.into_iter().find_map(found).or(hazard.map(CheckFinding::Hazard))
    }

    fn too_hot(&self, channel: Channel, rise: f32) -> CheckFinding {
        if self.stage == Stage::MosfetOff {
            CheckFinding::MosfetShorted
        } else {
            CheckFinding::TooHot(channel, rise)
        }
    }

    fn fail(&mut self, finding: CheckFinding) {
        let _ = self.findings.push(finding);
        self.end();
    }

    fn end(&mut self) {
        let failures = self.findings.iter().filter(|finding| !finding.is_note()).count();
        let passed = failures == 0 && !self.is_too_long();
        self.abort(if passed { Ending::Passed } else { Ending::Failed(failures as u8) });
    }

    fn enter(&mut self, stage: Stage) {
        (self.stage, self.cycles) = (stage, 0);
    }

    /// Power of a pulse, %.
    fn pulse(&self) -> f32 {
        let level = LEVELS.get(self.level).copied().unwrap_or(0.0);
        (level / self.gain).min(level) // whatever has become of the gain
    }

    /// What the output is to be at this tick of this cycle.
    fn output(&self) -> Output {
        let heated = self.step < CYCLE / 2;
        let power = Percent(if heated { self.pulse() } else { 0.0 });
        let closed_ticks = CLOSED_TICKS.get(self.cycles as usize).copied().unwrap_or(0);
        match self.stage {
            Stage::Rest | Stage::Cooling | Stage::Settle | Stage::Over => Output::Off,
            Stage::MosfetOff => Output::On {
                power: Percent(0.0),
                contactor: self.step * self.step_ticks + self.tick < closed_ticks,
            },
            Stage::Pulses | Stage::Order => Output::On { power, contactor: true },
            Stage::ContactorOpen => Output::On { power, contactor: false },
        }
    }
}
