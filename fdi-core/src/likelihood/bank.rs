//! Which fault explains the residuals best? A matched filter for each hypothesis, all from the same assumed onset.
//!
//! A hypothesis says what the residuals of y1 and y2 do from the onset: a fixed part f, and a part s that scales with
//! the unknown magnitude. Whitened as the residuals z are, least squares is maximum likelihood:
//!
//! ```text
//! magnitude = sum s (z - f) / sum s s          bounded to what is possible
//! RSS       = sum (z - f)^2 - magnitude (2 sum s (z - f) - magnitude sum s s)
//! ```
//!
//! RSS is the residual sum of squares that the hypothesis leaves; the difference of two is twice a log-likelihood ratio
//! (generalised likelihood ratio; Willsky and Jones 1976). Only sums are kept, so cost and memory are constant.

use super::fit::{HA, HB, Models, NA, NB};
use super::hypothesis::{COUNT, HYPOTHESES, Signature};
use super::noise::NoiseModel;
use super::whitening::Past;
use crate::bounds::bounded;
use crate::filter::LowPass;
use crate::identify::simulation::Simulation;
use crate::units::Seconds;
use crate::vector::shift;

/// Extra lags of a clogged T1 that are tried, s. The first is none: only the gain has gone. Tuned
/// (docs/diagnosis.md, section 6).
pub(super) const LAGS: [f32; 3] = [0.0, 0.35, 1.0];

/// Time advance of the answer with the flow at f times normal, as a share of its residence time for each `1 - 1/f`. By theory it is
/// `c ln f / f` with c from 0.8 (time constants) to 1 (dead times): 0.65 at f = 1.5, 1 at f = 0.67.
pub(super) const ADVANCE: f32 = 0.7;
/// The residence time is taken for no less and no more, ticks: the models cannot show more.
const RESIDENCE: (f32, f32) = (1.0, 1000.0);

/// What y1 and y2 are with two wires swapped, as combinations of what they should be: T1 and T2, T0 and T1, T0 and T2.
const SWAPPED: [[[f32; 2]; 2]; 3] =
    [[[0.0, 1.0], [1.0, 0.0]], [[-1.0, 0.0], [-1.0, 1.0]], [[1.0, -1.0], [0.0, -1.0]]];

/// Constants of the filters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filters {
    /// Poles of [`LAGS`].
    poles: [f32; LAGS.len()],
}

/// One tick, as the filters see it.
pub(super) struct BankInput<'a> {
    /// The models.
    pub(super) models: &'a Models,
    /// What is normal for the residuals of y1 and y2.
    pub(super) noise: &'a [NoiseModel; 3],
    /// How soon T1 answers.
    pub(super) response: ResponseTime,
    /// Ticks from a change of the power to the first sample that shows it.
    pub(super) dead_ticks: usize,
    /// Whitened residuals of y1 and y2.
    pub(super) z: [f32; 2],
    /// Weight of this tick, 0..=1.
    pub(super) weight: f32,
    /// Power that acted on this tick, newest first, %.
    pub(super) power: &'a [f32; NB],
    /// What y1 and y2 should be now, degC.
    pub(super) expected: [f32; 2],
    /// What y1 should have been, and what y1 and y2 were, a tick ago, degC.
    pub(super) expected_before: f32,
    pub(super) measured_before: [f32; 2],
}

/// How soon T1 answers to the power, and how much of its rise reaches T2.
#[derive(Clone, Copy, Debug)]
pub(super) struct ResponseTime {
    /// [`ADVANCE`] of the mean residence time, ticks.
    advance: f32,
    /// First-order lag of the residence time.
    lag: LowPass,
    /// What is lost between T1 and T2, as a share of what arrives.
    loss: f32,
}

impl ResponseTime {
    pub(super) fn new(models: &Models) -> Self {
        let (shortest, longest) = RESIDENCE;
        let ticks = bounded(models.heater_to_t1.residence_time().unwrap_or(longest), shortest, longest);
        let loss = 1.0 / models.t1_to_t2.gain().min(1.0) - 1.0;
        Self { advance: ADVANCE * ticks, lag: LowPass::new(1.0 / ticks, Seconds(1.0)), loss }
    }
}

/// Correlator of one signature: the sums that its magnitude follows from.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Correlator {
    /// sum s (z - f)
    cross: f32,
    /// sum s s, the signature's energy: the inverse variance of the magnitude.
    pub(super) energy: f32,
}

impl Correlator {
    #[inline(never)]
    fn add(&mut self, z: f32, s: f32, weight: f32) {
        let s_weighted = s * weight;
        self.cross += s_weighted * z;
        self.energy += s_weighted * s;
    }

    /// Both channels together; `sign` is that of s in them.
    fn joined(a: &[Self; 2], sign: f32) -> Self {
        Self { cross: sign * (a[0].cross + a[1].cross), energy: a[0].energy + a[1].energy }
    }

    /// The magnitude that explains most, within bounds.
    pub(super) fn best(&self, (low, high): (f32, f32)) -> f32 {
        if self.energy > 0.0 { bounded(self.cross / self.energy, low, high) } else { 0.0 }
    }

    /// How much a magnitude takes from the residual sum of squares.
    pub(super) fn explained(&self, magnitude: f32) -> f32 {
        magnitude * (2.0 * self.cross - magnitude * self.energy)
    }
}

/// What the bank holds for a signature.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evidence {
    /// Residual sum of squares that its fixed part leaves.
    pub(super) fixed: f32,
    /// Of its scaled part.
    pub(super) correlator: Correlator,
}

/// A clogged T1 with one extra lag.
#[derive(Clone, Copy, Debug, Default)]
struct Clogged {
    /// The rise of T1 behind the lag, and the part of it since the onset.
    lagged: f32,
    lost: f32,
    past_lagged: Past,
    past_lost: Past,
    energy: f32,
    gain: Correlator,
}

/// Two thermistors that are exchanged.
#[derive(Clone, Copy, Debug, Default)]
struct Swapped {
    past: [Past; 2],
    energy: f32,
}

/// The memory of all filters.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bank {
    /// Ticks since the assumed onset.
    pub(super) age: u32,
    /// A drift would have begun so many ticks before that.
    pub(super) ago: u32,
    /// sum z^2 of either channel.
    energy: [f32; 2],
    /// A constant from the onset on, a ramp, in either channel.
    offset: [Correlator; 2],
    ramp: [Correlator; 2],
    /// The answer to the power since the onset, and the same with what a change of air flow does to T2's heat loss.
    power: Correlator,
    flow: Correlator,
    /// A heater that gives the same power whatever is asked for: energy with the asked power taken away, and the answer
    /// to 1 %.
    constant_energy: f32,
    constant: Correlator,
    unit_y1: Simulation<NA, NB>,
    unit_y2: Simulation<HA, HB>,
    past_unit: [Past; 2],
    clogged: [Clogged; LAGS.len()],
    /// sum (z - f)^2 for a sensor that stays where it was a tick before the onset, and the sums for where it stays besides:
    /// that tick had noise.
    stuck_energy: [f32; 2],
    stuck_at: [f32; 2],
    stuck_level: [Correlator; 2],
    /// The share of the rise that T2 has lost.
    t2_out: Correlator,
    past_out: Past,
    swapped: [Swapped; SWAPPED.len()],
    y1: Simulation<NA, NB>,
    y2: Simulation<HA, HB>,
    loss: Simulation<HA, HB>,
    past_offset: [Past; 2],
    past_ramp: [Past; 2],
    past_y: [Past; 2],
    advance: f32,
    past_advance: Past,
    past_loss: Past,
    past_stuck: [Past; 2],
}

impl Filters {
    pub(super) fn new(sample_time: f32) -> Self {
        Self { poles: LAGS.map(|lag| if lag > 0.0 { libm::expf(-sample_time / lag) } else { 0.0 }) }
    }

    /// One tick.
    #[inline(never)]
    pub(super) fn step(&self, bank: &mut Bank, now: &BankInput) {
        let mut constant = [0.0; 2];
        for m in 0..2 {
            bank.energy[m] += now.weight * now.z[m] * now.z[m];
            let whitener = &now.noise[m].whitener;
            constant[m] = whitener.step(&mut bank.past_offset[m], 1.0);
            bank.offset[m].add(now.z[m], constant[m], now.weight);
            let age = (bank.ago + bank.age) as f32;
            bank.ramp[m].add(now.z[m], whitener.step(&mut bank.past_ramp[m], age), now.weight);
        }
        self.process(bank, now);
        self.clogged(bank, now);
        self.stuck(bank, now, constant);
        self.misplaced(bank, now);
        bank.age = bank.age.saturating_add(1);
    }

    /// Heater power and air flow. With the flow at f times normal, the gain goes with 1/f, and so do the heat lost
    /// between T1 and T2 and, nearly, all times: the answer comes earlier by `ln f` of the residence time, which is
    /// taken for one lag. The magnitude is `1 - 1/f` for the flow, the relative change for the power.
    fn process(&self, bank: &mut Bank, now: &BankInput) {
        let [w1, w2] = [&now.noise[0].whitener, &now.noise[1].whitener];
        let on = (bank.age as usize).saturating_add(now.dead_ticks);
        for (i, (u, &power)) in bank.y1.u.iter_mut().zip(now.power).enumerate() {
            *u = if i < on { power } else { 0.0 };
        }
        let y1 = now.models.heater_to_t1.output(&bank.y1);
        shift(&mut bank.y1.y, y1);
        let y2 = now.models.t1_to_t2.simulate(&mut bank.y2, y1);
        let moved = now.expected[0] - now.expected_before;
        now.response.lag.follow(&mut bank.advance, now.response.advance * moved);
        let at_t2 =
            now.models.t1_to_t2.simulate(&mut bank.loss, now.response.loss * now.expected[0] + bank.advance);
        let [s1, s2] = [w1.step(&mut bank.past_y[0], y1), w2.step(&mut bank.past_y[1], y2)];
        let advance = w1.step(&mut bank.past_advance, bank.advance);
        let at_t2 = w2.step(&mut bank.past_loss, at_t2);
        bank.power.add(now.z[0], s1, now.weight);
        bank.power.add(now.z[1], s2, now.weight);
        for (i, u) in bank.unit_y1.u.iter_mut().enumerate() {
            *u = if i < on { 1.0 } else { 0.0 };
        }
        let unit_y1 = now.models.heater_to_t1.output(&bank.unit_y1);
        shift(&mut bank.unit_y1.y, unit_y1);
        let unit_y2 = now.models.t1_to_t2.simulate(&mut bank.unit_y2, unit_y1);
        let [c1, c2] = [w1.step(&mut bank.past_unit[0], unit_y1), w2.step(&mut bank.past_unit[1], unit_y2)];
        for (z, c) in [(now.z[0] + s1, c1), (now.z[1] + s2, c2)] {
            bank.constant_energy += now.weight * z * z;
            bank.constant.add(z, c, now.weight);
        }
        bank.flow.add(now.z[0], advance - s1, now.weight);
        bank.flow.add(now.z[1], at_t2 - s2, now.weight);
    }

    /// T1 behind an extra lag: `y1 = gain * lag(expected)`, from where it was at the onset.
    fn clogged(&self, bank: &mut Bank, now: &BankInput) {
        let whitener = &now.noise[0].whitener;
        for (clogged, &pole) in bank.clogged.iter_mut().zip(&self.poles) {
            if bank.age == 0 {
                clogged.lagged = now.expected_before;
            }
            clogged.lagged = now.expected[0] + pole * (clogged.lagged - now.expected[0]);
            clogged.lost = now.expected[0] + pole * (clogged.lost - now.expected[0]);
            let fixed = whitener.step(&mut clogged.past_lagged, clogged.lagged - now.expected[0]);
            let s = whitener.step(&mut clogged.past_lost, -clogged.lost);
            let z = now.z[0] - fixed;
            clogged.energy += now.weight * z * z;
            clogged.gain.add(z, s, now.weight);
        }
    }

    /// A sensor that stays about where it was a tick before the onset; `constant` is the signature of an offset.
    fn stuck(&self, bank: &mut Bank, now: &BankInput, constant: [f32; 2]) {
        if bank.age == 0 {
            bank.stuck_at = now.measured_before;
        }
        for m in 0..2 {
            let gap = bank.stuck_at[m] - now.expected[m];
            let z = now.z[m] - now.noise[m].whitener.step(&mut bank.past_stuck[m], gap);
            bank.stuck_energy[m] += now.weight * z * z;
            bank.stuck_level[m].add(z, constant[m], now.weight);
        }
    }

    /// A T2 that is out of the tube, and thermistors that are exchanged.
    fn misplaced(&self, bank: &mut Bank, now: &BankInput) {
        let [w1, w2] = [&now.noise[0].whitener, &now.noise[1].whitener];
        let [y1, y2] = now.expected;
        bank.t2_out.add(now.z[1], w2.step(&mut bank.past_out, -y2), now.weight);
        for (swapped, [row1, row2]) in bank.swapped.iter_mut().zip(&SWAPPED) {
            let gap1 = row1[0] * y1 + row1[1] * y2 - y1;
            let gap2 = row2[0] * y1 + row2[1] * y2 - y2;
            let z1 = now.z[0] - w1.step(&mut swapped.past[0], gap1);
            let z2 = now.z[1] - w2.step(&mut swapped.past[1], gap2);
            swapped.energy += now.weight * (z1 * z1 + z2 * z2);
        }
    }
}

impl Bank {
    /// Nothing gathered; a drift would have begun `ago` ticks before.
    #[inline(never)]
    pub(super) fn restart(&mut self, ago: u32) {
        if self.age > 0 {
            *self = Self::default();
        }
        let past = if ago as usize > Past::LENGTH { Past::ramp(ago as f32) } else { Past::default() };
        self.ago = ago;
        self.past_ramp = [past; 2];
    }

    /// Energy of both residuals since the onset.
    pub(super) fn energy(&self) -> f32 {
        self.energy[0] + self.energy[1]
    }

    /// What it holds for each signature, in the order of [`Signature`].
    #[inline(always)]
    pub(super) fn evidence(&self) -> [Evidence; COUNT] {
        let energy = self.energy();
        let none = Correlator::default();
        let mut all = [Evidence { fixed: f32::MAX, correlator: none }; COUNT];
        let mut set = |signature: Signature, fixed: f32, correlator: Correlator| {
            all[signature as usize] = Evidence { fixed, correlator };
        };
        set(Signature::T1Offset, energy, self.offset[0]);
        set(Signature::T2Offset, energy, self.offset[1]);
        set(Signature::T0Offset, energy, Correlator::joined(&self.offset, -1.0));
        set(Signature::AirFlow, energy, self.flow);
        set(Signature::Power, energy, self.power);
        set(Signature::ConstantPower, self.constant_energy, self.constant);
        let clogged = self.clogged(HYPOTHESES[Signature::T1Clogged as usize].bounds);
        set(Signature::T1Clogged, clogged.energy + self.energy[1], clogged.gain);
        set(Signature::T1Stuck, self.stuck(0), none);
        set(Signature::T2Stuck, self.stuck(1), none);
        set(Signature::T1StuckNearby, self.stuck(0), self.stuck_level[0]);
        set(Signature::T2StuckNearby, self.stuck(1), self.stuck_level[1]);
        set(Signature::T0Drift, energy, Correlator::joined(&self.ramp, -1.0));
        set(Signature::T1Drift, energy, self.ramp[0]);
        set(Signature::T2Drift, energy, self.ramp[1]);
        set(Signature::T2Detached, energy, self.t2_out);
        set(Signature::SwappedT1T2, self.swapped[0].energy, none);
        set(Signature::SwappedT0T1, self.swapped[1].energy, none);
        set(Signature::SwappedT0T2, self.swapped[2].energy, none);
        all
    }

    /// Correlator of a change of the heater's power.
    pub(super) fn power(&self) -> &Correlator {
        &self.power
    }

    /// What a T1 (0) or T2 (1) that stays where it was leaves.
    fn stuck(&self, m: usize) -> f32 {
        self.stuck_energy[m] + self.energy[1 - m]
    }

    /// The loss of T1's gain with the lag that fits best.
    fn clogged(&self, bounds: (f32, f32)) -> &Clogged {
        let rss = |c: &Clogged| c.energy - c.gain.explained(c.gain.best(bounds));
        let mut best = &self.clogged[0];
        for clogged in &self.clogged[1..] {
            if rss(clogged) < rss(best) {
                best = clogged;
            }
        }
        best
    }
}
