//! Plain references in f64 that the parts are held against: random numbers with printed seeds, dense Gaussian algebra by elimination, and
//! the rig's differential equations in small steps.

extern crate std;

use std::vec;
use std::vec::Vec;

use super::process::{Parameter, Parameters};

/// A 64-bit congruential generator.
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x2545_F491_4F6C_DD1D)
    }

    /// Uniform between 0 and 1.
    pub(super) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Standard normal: the sum of twelve uniform numbers.
    pub(super) fn gaussian(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// A dense square matrix, by rows.
pub(super) type Matrix = Vec<Vec<f64>>;

pub(super) fn identity(n: usize) -> Matrix {
    (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect()
}

/// The solution of `a x = b`, and the logarithm of the determinant of `a`, by elimination with pivots.
pub(super) fn solve(a: &Matrix, b: &[f64]) -> (Vec<f64>, f64) {
    let n = b.len();
    let (mut a, mut x, mut log_det) = (a.clone(), b.to_vec(), 0.0);
    for i in 0..n {
        let pivot = (i..n).max_by(|&p, &q| a[p][i].abs().total_cmp(&a[q][i].abs())).unwrap();
        a.swap(i, pivot);
        x.swap(i, pivot);
        log_det += a[i][i].abs().ln();
        for k in i + 1..n {
            let factor = a[k][i] / a[i][i];
            for j in i..n {
                let above = a[i][j];
                a[k][j] -= factor * above;
            }
            x[k] -= factor * x[i];
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| a[i][j] * x[j]).sum();
        x[i] = (x[i] - known) / a[i][i];
    }
    (x, log_det)
}

/// The inverse, column by column.
pub(super) fn inverse(a: &Matrix) -> Matrix {
    let n = a.len();
    let mut inverse = vec![vec![0.0; n]; n];
    for (j, unit) in identity(n).iter().enumerate() {
        for (i, x) in solve(a, unit).0.into_iter().enumerate() {
            inverse[i][j] = x;
        }
    }
    inverse
}

/// Steps of the integration in a tick.
const STEPS: usize = 50;
/// Ticks of the air's past that are kept.
const KEPT: usize = 400;

/// The rig in continuous time, by its differential equations.
pub(super) struct Rig {
    p: [f64; super::process::COUNT],
    x: f64,
    m: [f64; 2],
    w: [f64; 2],
    /// What left the heater, newest last, one for each small step.
    air: Vec<f64>,
    /// The model takes what arrives at a tick's end for what arrived during the whole of it: half a tick earlier, once for a
    /// thermistor and once more for its wall.
    pub(super) lead: f64,
}

impl Rig {
    pub(super) fn new(p: &Parameters, lead: f64) -> Self {
        Self { p: p.0.map(f64::from), x: 0.0, m: [0.0; 2], w: [0.0; 2], air: vec![0.0; KEPT * STEPS], lead }
    }

    fn get(&self, which: Parameter) -> f64 {
        self.p[which as usize]
    }

    /// What left the heater so many ticks ago.
    fn earlier(&self, ticks: f64) -> f64 {
        let steps = ((ticks * STEPS as f64).max(0.0)).min((KEPT * STEPS - 2) as f64);
        let place = self.air.len() as f64 - 1.0 - steps;
        let (low, part) = (place.floor() as usize, place.fract());
        let next = (low + 1).min(self.air.len() - 1);
        self.air[low] * (1.0 - part) + self.air[next] * part
    }

    /// A tick with a constant power, %, and air flow: what T1 and T2 read above T0, degC.
    pub(super) fn tick(&mut self, power: f64, flow: f64) -> [f64; 2] {
        use Parameter::{
            Curvature, Delay1, Delay2, Gain, Heater, Lag1, Lag2, Offset1, Offset2, Reaches2, Wall1, Wall2,
            WallTime,
        };
        let dt = 1.0 / STEPS as f64;
        let film = flow.powf(0.8);
        let heat = power * (1.0 + self.get(Curvature) * (power - 30.0) / 20.0);
        let delay1 = self.get(Delay1) * (0.25 + 0.75 / flow) - self.lead;
        let delays = [delay1, delay1 + self.get(Delay2) / flow];
        // Exact for an input that is constant over a small step; midpoints for what varies.
        let share = |time: f64| 1.0 - (-dt / time).exp();
        let [heater, lag1, lag2, wall] = [Heater, Lag1, Lag2, WallTime].map(|which| self.get(which).exp());
        let shares = (share(heater / film), [share(lag1), share(lag2)], share(wall));
        for _ in 0..STEPS {
            self.x += shares.0 * (heat / film - self.x);
            self.air.push(self.x * film / flow);
            for i in 0..2 {
                let air = self.earlier(delays[i] + 0.5 * dt);
                let before = self.m[i];
                self.m[i] += shares.1[i] * (air - before);
                self.w[i] += shares.2 * (0.5 * (before + self.m[i]) - self.w[i]);
            }
        }
        if self.air.len() > 2 * KEPT * STEPS {
            self.air.drain(..KEPT * STEPS);
        }
        let gain = self.get(Gain).exp();
        let reaches = 1.0 - (1.0 - self.get(Reaches2)) / flow;
        let slow = [self.get(Wall1), self.get(Wall1) + self.get(Wall2)];
        let rise = |i: usize| (1.0 - slow[i]) * self.m[i] + slow[i] * self.w[i];
        [self.get(Offset1) + gain * rise(0), self.get(Offset2) + gain * reaches * rise(1)]
    }
}
