//! How each thermistor answers to the power: impulse responses without trained models, gains or settings.
//!
//! Power and readings are high-passed alike. To each reading least squares with forgetting fits an impulse response that
//! is constant over bands of lags:
//!
//! ```text
//! y[k] = h1 x1[k] + .. + h4 x4[k] + noise         xb[k]: the power of the lags of band b, summed
//! ```
//!
//! The regressors are the same for all readings, so there is one normal matrix R, and a right-hand side p for each. The
//! area of a response, `A = w' R^-1 p`, says whether a thermistor answers; its centroid `(w t)' R^-1 p / A` how late. w is how
//! many ticks a band has, t where its middle is.

use super::tuning::Tuned;
use crate::bounds::larger;
use crate::root::sqrt;
use crate::vector::{dot, shift, sum};

/// Bands of lags: 1, 2 and 3, 4 to 6, 7 to 12 steps. The first lag is that of the power that acted until now.
const BANDS: usize = 4;
const ENDS: [usize; BANDS + 1] = [0, 1, 3, 6, 12];
const LAGS: usize = ENDS[BANDS];
/// Steps in a band, and these times the middle of the band.
const AREA: [f32; BANDS] = [1.0, 2.0, 3.0, 6.0];
const MOMENT: [f32; BANDS] = [1.0, 5.0, 15.0, 57.0];

/// Ticks of a step, and the shares that are kept from step to step.
#[derive(Clone, Copy, Debug)]
pub(super) struct ImpulseResponse {
    ticks: u32,
    high_pass: f32,
    keep: f32,
    pub(super) tuning: Tuned,
}

/// The sums, and what they are made of.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ImpulseResponseState {
    /// High-passed power, newest first, and that of the last step, %.
    power: [f32; LAGS],
    power_before: f32,
    /// Ticks of the step that is under way, and the sum of their powers, %.
    ticks: u32,
    power_sum: f32,
    /// High-passed readings of T0, T1, T2, and the last good ones, degC.
    swing: [f32; 3],
    before: [Option<f32>; 3],
    r: [[f32; BANDS]; BANDS],
    p: [[f32; BANDS]; 3],
    energy: [f32; 3],
    samples: f32,
}

/// How one thermistor answers. The standard deviations count every sample in full; forgetting would make them smaller by
/// the square root of two, which covers what correlation the high-passed noise has left.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    /// Area of the response, degC per %, with its standard deviation.
    pub(super) area: f32,
    pub(super) area_sd: f32,
    /// Its centroid with its standard deviation, ticks.
    pub(super) late: f32,
    pub(super) late_sd: f32,
}

impl ImpulseResponse {
    pub(super) fn new(tuning: Tuned, sample_time: f32, answer_time: f32) -> Self {
        let t = &tuning.impulse;
        let ticks = (answer_time / (t.steps * sample_time)).max(1.0) as u32;
        let keep = |times: f32| libm::expf(-sample_time * ticks as f32 / (times * answer_time));
        Self { ticks, high_pass: keep(t.high_pass), keep: keep(t.memory), tuning }
    }

    /// Ticks of a step.
    pub(super) fn ticks(&self) -> u32 {
        self.ticks
    }

    /// One tick: the readings where there are any, and the power applied from now on, %. A step has the readings at its
    /// beginning, and the mean power.
    pub(super) fn step(&self, s: &mut ImpulseResponseState, readings: [Option<f32>; 3], power: f32) {
        if s.ticks == 0 {
            self.answer(s, readings);
        }
        s.ticks += 1;
        s.power_sum += power;
        if s.ticks >= self.ticks {
            let mean = s.power_sum / self.ticks as f32;
            let swing = self.high_pass * s.power[0] + mean - s.power_before;
            shift(&mut s.power, swing);
            (s.power_before, s.ticks, s.power_sum) = (mean, 0, 0.0);
        }
    }

    /// The readings as an answer to the power of the steps before.
    fn answer(&self, s: &mut ImpulseResponseState, readings: [Option<f32>; 3]) {
        let x: [f32; BANDS] = core::array::from_fn(|b| s.power[ENDS[b]..ENDS[b + 1]].iter().sum::<f32>());
        for (m, reading) in readings.into_iter().enumerate() {
            let change = reading.zip(s.before[m]).map_or(0.0, |(now, before)| now - before);
            s.swing[m] = self.high_pass * s.swing[m] + change;
            s.before[m] = reading.or(s.before[m]);
        }
        let least = self.tuning.impulse.least_power;
        if dot(&x, &x) > least * least {
            self.gather(s, &x);
        }
    }

    #[inline(never)]
    fn gather(&self, s: &mut ImpulseResponseState, x: &[f32; BANDS]) {
        for i in 0..BANDS {
            for j in 0..=i {
                s.r[i][j] = self.keep * s.r[i][j] + x[i] * x[j];
            }
        }
        for m in 0..3 {
            let y = s.swing[m];
            for i in 0..BANDS {
                s.p[m][i] = self.keep * s.p[m][i] + x[i] * y;
            }
            s.energy[m] = self.keep * s.energy[m] + y * y;
        }
        s.samples = self.keep * s.samples + 1.0;
    }
}

impl ImpulseResponseState {
    /// Finite as long as all of it is that stays.
    pub(super) fn sum(&self) -> f32 {
        let matrices = sum(self.r.as_flattened()) + sum(self.p.as_flattened());
        let lists = sum(&self.energy) + sum(&self.swing) + sum(&self.power);
        matrices + lists + self.power_before + self.power_sum + self.samples
    }

    /// How T0, T1 and T2 answer.
    #[inline(never)]
    pub(super) fn moments(&self, response: &ImpulseResponse) -> [Moments; 3] {
        let factors = Factors::new(&self.r, response.tuning.impulse.ridge);
        let [area, moment] = [factors.solve(&AREA), factors.solve(&MOMENT)];
        let [aa, am, mm] = [dot(&area, &AREA), dot(&area, &MOMENT), dot(&moment, &MOMENT)];
        let freedom = larger(1.0, self.samples - BANDS as f32);
        core::array::from_fn(|m| {
            let p = &self.p[m];
            let explained = dot(&factors.solve(p), p);
            let variance = larger(0.0, self.energy[m] - explained) / freedom;
            let (total, moment) = (dot(&area, p), dot(&moment, p));
            let late = moment / total;
            let late_sd = sqrt(variance * (mm - 2.0 * late * am + late * late * aa)) / total.abs();
            let ticks = response.ticks as f32;
            Moments {
                area: total,
                area_sd: sqrt(variance * aa),
                late: late * ticks,
                late_sd: late_sd * ticks,
            }
        })
    }
}

/// R = L D L': no square roots, and the diagonal of D cannot come too near to zero.
struct Factors {
    l: [[f32; BANDS]; BANDS],
    d: [f32; BANDS],
    inv_d: [f32; BANDS],
}

impl Factors {
    fn new(r: &[[f32; BANDS]; BANDS], ridge: f32) -> Self {
        let mut f = Self { l: [[0.0; BANDS]; BANDS], d: [0.0; BANDS], inv_d: [0.0; BANDS] };
        for j in 0..BANDS {
            let left =
                |f: &Self, i: usize| (0..j).fold(r[i][j], |left, k| left - f.l[i][k] * f.l[j][k] * f.d[k]);
            f.d[j] = larger(ridge, left(&f, j) + ridge);
            f.inv_d[j] = 1.0 / f.d[j];
            for i in j + 1..BANDS {
                f.l[i][j] = left(&f, i) * f.inv_d[j];
            }
        }
        f
    }

    /// R^-1 p.
    fn solve(&self, p: &[f32; BANDS]) -> [f32; BANDS] {
        let mut x = *p;
        for i in 1..BANDS {
            for k in 0..i {
                x[i] -= self.l[i][k] * x[k];
            }
        }
        for i in 0..BANDS {
            x[i] *= self.inv_d[i];
        }
        for i in (0..BANDS).rev() {
            for k in i + 1..BANDS {
                x[i] -= self.l[k][i] * x[k];
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// First-order lags of gain 0.3 and 0.2 degC per %, the second two ticks later, and a T0 that does nothing.
    #[test]
    fn known_responses_are_found() {
        let (response, mut s) =
            (ImpulseResponse::new(Tuned::default(), 0.11, 2.0), ImpulseResponseState::default());
        let (mut seed, mut power) = (1u32, [0.0f32; 3]);
        let (mut t1, mut t2) = (0.0, 0.0);
        for _ in 0..400 {
            seed = seed.wrapping_mul(1664525).wrapping_add(1013904223);
            t1 += 0.2 * (0.3 * power[0] - t1);
            t2 += 0.2 * (0.2 * power[2] - t2);
            shift(&mut power, 40.0 + if seed >> 31 == 0 { 5.0 } else { -5.0 });
            response.step(&mut s, [Some(20.0), Some(20.0 + t1), Some(20.0 + t2)], power[0]);
        }
        let [a0, a1, a2] = s.moments(&response);
        assert!(a0.area.abs() < 1e-4 && a0.area_sd < 1e-3, "{a0:?}");
        // Of the first lag 93 % lie within twelve ticks, of the second 89 %.
        assert!((a1.area / (0.3 * 0.93) - 1.0).abs() < 0.1, "{a1:?}");
        assert!((a2.area / (0.2 * 0.89) - 1.0).abs() < 0.1, "{a2:?}");
        assert!((0.9..2.1).contains(&(a2.late - a1.late)), "{a1:?} {a2:?}");
    }

    /// Sampled ten times as often as its answer takes, a rig answers alike, and as many ticks later.
    #[test]
    fn a_slow_rig_answers_as_a_fast_one() {
        let answers = |often: u32| {
            let (response, mut s) = (
                ImpulseResponse::new(Tuned::default(), 0.1, 2.0 * often as f32),
                ImpulseResponseState::default(),
            );
            let (mut seed, mut t1, mut power) = (1u32, 0.0f32, 40.0f32);
            for tick in 0..400 * often {
                response.step(&mut s, [Some(20.0), Some(20.0 + t1), None], power);
                t1 += 0.2 / often as f32 * (0.3 * power - t1);
                if tick % (2 * often) == 2 * often - 1 {
                    seed = seed.wrapping_mul(1664525).wrapping_add(1013904223);
                    power = 40.0 + if seed >> 31 == 0 { 5.0 } else { -5.0 };
                }
            }
            s.moments(&response)[1]
        };
        let (fast, slow) = (answers(1), answers(10));
        assert!((slow.area / fast.area - 1.0).abs() < 0.1, "{fast:?} {slow:?}");
        assert!((slow.late / fast.late / 10.0 - 1.0).abs() < 0.2, "{fast:?} {slow:?}");
    }

    #[test]
    fn nothing_seen_gives_no_answer_and_wild_input_no_panic() {
        let (response, mut s) =
            (ImpulseResponse::new(Tuned::default(), 0.11, 2.0), ImpulseResponseState::default());
        assert!(s.moments(&response).iter().all(|a| !(a.area > 6.0 * a.area_sd)));
        for power in [f32::NAN, 1e30, -1e30, 0.0] {
            response.step(&mut s, [None, Some(f32::MAX), Some(f32::NAN)], power);
            let _ = s.moments(&response);
        }
    }
}
