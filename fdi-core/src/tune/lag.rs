//! A lag of first order with dead time, as the loop sees it in samples, and PID settings for it.

use core::f32::consts::{PI, TAU};

use crate::bounds::smaller;
use crate::root::sqrt;
use crate::turn::cos_sin;
use crate::units::Seconds;

/// `gain e^(-dead s) / (1 + time s)`; the dead time has that of sampling in it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Lag {
    /// degC per %.
    pub gain: f32,
    /// s.
    pub time: f32,
    /// s.
    pub dead: f32,
}

/// PID settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuned {
    /// % per degC.
    pub kp: f32,
    /// Integral time.
    pub ti: Seconds,
    /// Derivative time.
    pub td: Seconds,
}

/// How far a loop is from oscillating.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// Factor on the gain.
    pub gain: f32,
    /// Lag, degrees.
    pub phase: f32,
}

/// What a step of the set-point does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepResponse {
    /// As a share of the step.
    pub overshoot: f32,
    /// Until it stays within 5 % of the step.
    pub settled: Seconds,
}

/// Frequencies that margins are looked for at, from a hundredth of the last.
const STEPS: u32 = 300;
/// 100 to the power of 1 / 300.
const STEP: f32 = 1.015_469;

/// Settled: so far from a step of 1.
const SETTLED: f32 = 0.05;
/// Samples of dead time, and of a step that is looked at, at most.
const DELAY: usize = 64;
const LONGEST: f32 = 20_000.0;

impl Lag {
    /// The lag of a static gain that answers with `(size, lag)` (degC per %, rad) at a frequency in rad/s; `None` where there is none.
    pub(super) fn through(gain: f32, frequency: f32, (size, behind): (f32, f32)) -> Option<Self> {
        let ratio = gain / size;
        let time = sqrt((ratio * ratio - 1.0).max(0.0)) / frequency;
        let dead = (behind - libm::atanf(frequency * time)) / frequency;
        let lag = Self { gain, time, dead };
        (ratio > 1.0 && dead > 0.0 && time.is_finite() && dead.is_finite()).then_some(lag)
    }

    /// By the rule of Skogestad (SIMC, J. Process Control 13, 2003), the closed loop as slow as the dead time: robust, hardly any overshoot.
    pub fn by_model(&self) -> Tuned {
        let closed = self.dead;
        let kp = self.time / (self.gain * (closed + self.dead));
        Tuned { kp, ti: Seconds(self.time.min(4.0 * (closed + self.dead))), td: Seconds(0.0) }
    }

    /// By the gain and period at which the loop would oscillate (Tyreus and Luyben, Ind. Eng. Chem. Res. 31, 1992).
    pub fn by_oscillation(&self, sample_time: Seconds) -> Option<Tuned> {
        let bare = Tuned { kp: 1.0, ti: Seconds(f32::INFINITY), td: Seconds(0.0) };
        let (at, size) = self.crossing(&bare, sample_time)?;
        Some(Tuned { kp: 0.31 / size, ti: Seconds(2.2 * 2.0 * PI / at), td: Seconds(0.0) })
    }

    /// A step of the set-point on this lag, by the PID as it is; `None` where it does not settle.
    pub fn step_response(&self, tuned: &Tuned, sample_time: Seconds) -> Option<StepResponse> {
        let (overshoot, ticks) = self.settling(tuned, sample_time)?;
        Some(StepResponse { overshoot, settled: Seconds(ticks as f32 * sample_time.0) })
    }

    /// Overshoot of a step of the set-point, and ticks until it is settled; `None` where it does not settle.
    pub(super) fn settling(&self, tuned: &Tuned, Seconds(ts): Seconds) -> Option<(f32, u32)> {
        // Half a sample of the dead time is that of the power that is held.
        let delay = ((self.dead / ts - 0.5).max(0.0) + 0.5) as usize;
        if delay >= DELAY {
            return None;
        }
        let share = 1.0 - libm::expf(-ts / self.time.max(1e-3));
        let (mut y, mut y1, mut y2, mut u, mut most, mut settled) = (0.0, 0.0, 0.0, 0.0, 1.0f32, 0);
        let mut waiting = [0.0; DELAY];
        let longest = smaller(20.0 * (self.time + self.dead) / ts, LONGEST) as u32;
        for tick in 0..longest {
            let change = ts / tuned.ti.0 * (1.0 - y) - (y - y1) - tuned.td.0 / ts * (y - 2.0 * y1 + y2);
            u += tuned.kp * change;
            waiting[tick as usize % DELAY] = u;
            (y2, y1) = (y1, y);
            let acting = if (tick as usize) < delay { 0.0 } else { waiting[(tick as usize - delay) % DELAY] };
            y += share * (self.gain * acting - y);
            most = most.max(y);
            if !((y - 1.0).abs() <= SETTLED) {
                settled = tick + 1;
            }
        }
        (settled < longest).then_some((most - 1.0, settled))
    }

    /// The margins with these settings; `None` where the loop has none, as it oscillates by itself.
    pub fn margins(&self, tuned: &Tuned, sample_time: Seconds) -> Option<Margins> {
        let (_, size) = self.crossing(tuned, sample_time)?;
        let mut phase = 180.0;
        for (size, behind) in self.frequencies(sample_time).map(|w| self.open_loop(tuned, sample_time, w)) {
            if size < 1.0 {
                break;
            }
            phase = 180.0 - behind * 180.0 / PI;
        }
        (size < 1.0).then_some(Margins { gain: 1.0 / size, phase })
    }

    /// Where the open loop lags by half a turn: frequency and size.
    fn crossing(&self, tuned: &Tuned, sample_time: Seconds) -> Option<(f32, f32)> {
        let answers = self.frequencies(sample_time).map(|w| (w, self.open_loop(tuned, sample_time, w)));
        let mut beyond = answers.filter(|(_, (_, behind))| *behind >= PI);
        beyond.next().map(|(w, (size, _))| (w, size))
    }

    /// Up to half the rate of the samples, or where the dead time alone is half a turn.
    fn frequencies(&self, sample_time: Seconds) -> impl Iterator<Item = f32> + use<> {
        let last = (PI / sample_time.0).min(PI / self.dead);
        (0..=STEPS).scan(0.01 * last, |w, _| Some(core::mem::replace(w, STEP * *w)))
    }

    /// Size and lag of controller and rig at a frequency; the controller as it is, in samples.
    fn open_loop(&self, tuned: &Tuned, Seconds(ts): Seconds, w: f32) -> (f32, f32) {
        let (c, s) = cos_sin(w * ts / TAU);
        // 1 - 1/z, and Ts/Ti of its inverse.
        let (dr, di) = (1.0 - c, s);
        let weight = ts / tuned.ti.0 / (dr * dr + di * di);
        let derivative = tuned.td.0 / ts;
        let (re, im) = (1.0 + weight * dr + derivative * dr, derivative * di - weight * di);
        let size = tuned.kp * sqrt(re * re + im * im) * self.gain / sqrt(1.0 + w * w * self.time * self.time);
        (size, w * self.dead + libm::atanf(w * self.time) - libm::atan2f(im, re))
    }
}
