//! Plain references in f64 that the parts are held against: the generalised likelihood ratio computed directly over the window, by the
//! residual sum of squares with and without each signature; Yule-Walker by elimination; ranking by brute force.

extern crate std;

use std::vec;
use std::vec::Vec;

use super::bank::{ADVANCE, Bank, BankInput, Filters, LAGS, ResponseTime};
use super::class::FaultClass;
use super::fit::{Models, NB, Simulations};
use super::hypothesis::{HYPOTHESES, PROCESS, Scale, Signature};
use super::noise::NoiseModel;
use super::ranking::Ranking;
use super::whitening::{ORDER, Past, Whitener};
use crate::identify::transfer::Transfer;

const TS: f32 = 0.11;
const ONSET: usize = 200;
/// Autocovariances of the noise of both residuals, degC^2.
const R: [[f32; ORDER + 1]; 2] = [[0.010, 0.006, 0.003, 0.001], [0.004, 0.002, 0.0015, 0.001]];

/// `r0 c1 + r1 c2 + r2 c3 = r1` and so on by Gaussian elimination: coefficients, and the standard deviation of the innovation.
pub(super) fn yule_walker(r: &[f32; ORDER + 1]) -> ([f64; ORDER], f64) {
    let r = r.map(f64::from);
    let mut rows: [[f64; ORDER + 1]; ORDER] = core::array::from_fn(|i| {
        core::array::from_fn(|j| if j == ORDER { r[i + 1] } else { r[i.abs_diff(j)] })
    });
    for i in 0..ORDER {
        for k in i + 1..ORDER {
            let factor = rows[k][i] / rows[i][i];
            for j in i..=ORDER {
                rows[k][j] -= factor * rows[i][j];
            }
        }
    }
    let mut c = [0.0; ORDER];
    for i in (0..ORDER).rev() {
        let known: f64 = (i + 1..ORDER).map(|j| rows[i][j] * c[j]).sum();
        c[i] = (rows[i][ORDER] - known) / rows[i][i];
    }
    let explained: f64 = (0..ORDER).map(|i| c[i] * r[i + 1]).sum();
    (c, (r[0] - explained).sqrt())
}

/// What is filtered by a difference equation that starts at rest.
fn simulate<const NA: usize, const NB: usize>(model: &Transfer<NA, NB>, u: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; u.len()];
    for k in 0..u.len() {
        let forced: f64 = (0..=k.min(NB - 1)).map(|i| f64::from(model.b[i]) * u[k - i]).sum();
        let free: f64 = (1..=k.min(NA)).map(|i| f64::from(model.a[i - 1]) * y[k - i]).sum();
        y[k] = forced - free;
    }
    y
}

fn models() -> Models {
    Models {
        heater_to_t1: Transfer { a: [-0.8, 0.0, 0.0], b: [0.0, 0.02, 0.03, 0.0, 0.0, 0.0], nk: 1 },
        t1_to_t2: Transfer { a: [-0.6, 0.0], b: [0.1, 0.2, 0.06, 0.0], nk: 0 },
    }
}

/// What happens from the onset on: how y1 and y2, as they should be (from a tick before the onset on), are changed on the tick.
type Fault = fn(&[[f64; 2]], usize) -> [f64; 2];

/// A run: everything that the bank is given, from the onset on, and what it makes of it.
struct Run {
    /// A tick before the onset comes first.
    expected: Vec<[f64; 2]>,
    measured: Vec<[f64; 2]>,
    z: Vec<[f64; 2]>,
    weight: Vec<f64>,
    /// Power that acted on each tick of the run, from its beginning on.
    power: Vec<f64>,
    dead_ticks: usize,
}

fn noise() -> [NoiseModel; 3] {
    let model =
        |r| NoiseModel { whitener: Whitener::from_autocovariance(r).unwrap(), ..NoiseModel::default() };
    [model(&R[0]), model(&R[1]), model(&R[1])]
}

fn run(fault: Fault, ticks: usize, seed: u32) -> Run {
    let models = models();
    let (mut simulations, mut past) = (Simulations::default(), [Past::default(); 2]);
    let (mut seed, mut e) = (seed, [[0.0f64; ORDER]; 2]);
    let mut uniform = || {
        seed = seed.wrapping_mul(1664525).wrapping_add(1013904223);
        f64::from(seed >> 8) / f64::from(1u32 << 24) - 0.5
    };
    let mut run = Run {
        expected: vec![],
        measured: vec![],
        z: vec![],
        weight: vec![],
        power: vec![],
        dead_ticks: models.dead_ticks(),
    };
    for k in 0..ONSET + ticks {
        run.power.push(f64::from(simulations.y1.u[0]));
        let u = if uniform() > 0.0 { 45.0 } else { 35.0 };
        let [y1, y2, _] = models.step(&mut simulations, 0.0, u);
        if k + 1 < ONSET {
            continue;
        }
        run.expected.push([y1, y2].map(f64::from));
        let changed = if k < ONSET { [0.0; 2] } else { fault(&run.expected, k - ONSET) };
        for m in 0..2 {
            let (c, sigma) = yule_walker(&R[m]);
            let gaussian: f64 = (0..12).map(|_| uniform()).sum();
            let now = (0..ORDER).map(|i| c[i] * e[m][i]).sum::<f64>() + sigma * gaussian;
            e[m] = [now, e[m][0], e[m][1]];
        }
        let residual = [changed[0] + e[0][0], changed[1] + e[1][0]];
        let z: [f32; 2] =
            core::array::from_fn(|m| noise()[m].whitener.step(&mut past[m], residual[m] as f32));
        run.measured.push([f64::from(y1) + residual[0], f64::from(y2) + residual[1]]);
        if k >= ONSET {
            run.z.push(z.map(f64::from));
            run.weight.push(if k % 7 == 3 { 0.5 } else { 1.0 });
        }
    }
    run
}

/// Fixed and scaled part of what the residuals of y1 and y2 are under a hypothesis, from the onset on.
struct Parts {
    fixed: [Vec<f64>; 2],
    scaled: [Vec<f64>; 2],
}

impl Run {
    fn ticks(&self) -> usize {
        self.z.len()
    }

    /// What the bank makes of it.
    fn bank(&self) -> Bank {
        let (models, noise) = (models(), noise());
        let (filters, response) = (Filters::new(TS), ResponseTime::new(&models));
        let mut bank = Bank::default();
        for k in 0..self.ticks() {
            let input = BankInput {
                models: &models,
                noise: &noise,
                response,
                dead_ticks: self.dead_ticks,
                z: self.z[k].map(|z| z as f32),
                weight: self.weight[k] as f32,
                power: &core::array::from_fn(|i| self.power[ONSET + k - i] as f32),
                expected: self.expected[k + 1].map(|y| y as f32),
                expected_before: self.expected[k][0] as f32,
                measured_before: self.measured[k].map(|y| y as f32),
            };
            filters.step(&mut bank, &input);
        }
        bank
    }

    /// A value a tick, from what y1 and y2 should be.
    fn each(&self, value: impl Fn(usize, [f64; 2]) -> f64) -> Vec<f64> {
        (0..self.ticks()).map(|k| value(k, self.expected[k + 1])).collect()
    }

    /// The answer of y1 and y2 to an input that begins as many ticks before the onset as there is dead time.
    fn answers(&self, input: impl Fn(f64) -> f64) -> [Vec<f64>; 2] {
        let models = models();
        let u: Vec<f64> = self.power[ONSET - self.dead_ticks + 1..].iter().map(|u| input(*u)).collect();
        // The state starts at the onset; before it only the taps hold something.
        let mut y1 = vec![0.0; self.ticks()];
        for k in 0..self.ticks() {
            let at = k + self.dead_ticks - 1;
            let forced: f64 =
                (0..=at.min(NB - 1)).map(|i| f64::from(models.heater_to_t1.b[i]) * u[at - i]).sum();
            let free: f64 = (1..=k.min(3)).map(|i| f64::from(models.heater_to_t1.a[i - 1]) * y1[k - i]).sum();
            y1[k] = forced - free;
        }
        let y2 = simulate(&models.t1_to_t2, &y1);
        [y1, y2]
    }

    fn parts(&self, signature: Signature, lag: f32) -> Parts {
        let none = || self.each(|_, _| 0.0);
        let one = || self.each(|_, _| 1.0);
        let minus = |x: Vec<f64>| x.into_iter().map(|x| -x).collect::<Vec<f64>>();
        let scaled = |y1: Vec<f64>, y2: Vec<f64>| Parts { fixed: [none(), none()], scaled: [y1, y2] };
        let fixed = |y1: Vec<f64>, y2: Vec<f64>| Parts { fixed: [y1, y2], scaled: [none(), none()] };
        let ramp = || self.each(|k, _| k as f64);
        let stuck = |m: usize| self.each(|_, y| self.measured[0][m] - y[m]);
        match signature {
            Signature::T1Offset => scaled(one(), none()),
            Signature::T2Offset => scaled(none(), one()),
            Signature::T0Offset => scaled(minus(one()), minus(one())),
            Signature::T1Drift => scaled(ramp(), none()),
            Signature::T2Drift => scaled(none(), ramp()),
            Signature::T0Drift => scaled(minus(ramp()), minus(ramp())),
            Signature::T2Detached => scaled(none(), self.each(|_, y| -y[1])),
            Signature::T1Stuck => fixed(stuck(0), none()),
            Signature::T2Stuck => fixed(none(), stuck(1)),
            Signature::T1StuckNearby => Parts { fixed: [stuck(0), none()], scaled: [one(), none()] },
            Signature::T2StuckNearby => Parts { fixed: [none(), stuck(1)], scaled: [none(), one()] },
            Signature::SwappedT1T2 => fixed(self.each(|_, y| y[1] - y[0]), self.each(|_, y| y[0] - y[1])),
            Signature::SwappedT0T1 => fixed(self.each(|_, y| -2.0 * y[0]), self.each(|_, y| -y[0])),
            Signature::SwappedT0T2 => fixed(self.each(|_, y| -y[1]), self.each(|_, y| -2.0 * y[1])),
            Signature::Power => {
                let [y1, y2] = self.answers(|u| u);
                scaled(y1, y2)
            }
            Signature::ConstantPower => {
                let [[y1, y2], [c1, c2]] = [self.answers(|u| u), self.answers(|_| 1.0)];
                Parts { fixed: [minus(y1), minus(y2)], scaled: [c1, c2] }
            }
            Signature::T1Clogged => {
                let pole = if lag > 0.0 { (-f64::from(TS) / f64::from(lag)).exp() } else { 0.0 };
                let (mut lagged, mut lost) = (self.expected[0][0], 0.0);
                let both: Vec<[f64; 2]> = (0..self.ticks())
                    .map(|k| {
                        let now = self.expected[k + 1][0];
                        lagged = now + pole * (lagged - now);
                        lost = now + pole * (lost - now);
                        [lagged - now, -lost]
                    })
                    .collect();
                let [f, s] = [0, 1].map(|i| both.iter().map(|x| x[i]).collect());
                Parts { fixed: [f, none()], scaled: [s, none()] }
            }
            Signature::AirFlow => {
                let models = models();
                let ticks = f64::from(models.heater_to_t1.residence_time().unwrap());
                let (share, mut lag) = (1.0 - (-1.0 / ticks).exp(), 0.0);
                let advance = self.each(|k, y| f64::from(ADVANCE) * ticks * (y[0] - self.expected[k][0]));
                let advance: Vec<f64> = advance
                    .iter()
                    .map(|x| {
                        lag += share * (x - lag);
                        lag
                    })
                    .collect();
                let loss = 1.0 / f64::from(models.t1_to_t2.gain()) - 1.0;
                let lost = self.each(|k, y| loss * y[0] + advance[k]);
                let at_t2 = simulate(&models.t1_to_t2, &lost);
                let [p1, p2] = self.answers(|u| u);
                let less = |x: &[f64], p: &[f64]| x.iter().zip(p).map(|(x, p)| x - p).collect();
                scaled(less(&advance, &p1), less(&at_t2, &p2))
            }
        }
    }

    /// The residual sum of squares and the magnitude of least squares, within bounds, computed over the whole window.
    fn least_squares(&self, signature: Signature, lag: f32) -> (f64, f64) {
        let row = &HYPOTHESES[signature as usize];
        let unit = if row.scale == Scale::Drift { f64::from(TS) } else { 1.0 };
        let (low, high) = (f64::from(row.bounds.0) * unit, f64::from(row.bounds.1) * unit);
        let Parts { fixed, scaled } = self.parts(signature, lag);
        let [f, s] = [fixed, scaled].map(|x| [whiten(&x[0], 0), whiten(&x[1], 1)]);
        let sum = |term: &dyn Fn(usize, usize) -> f64| -> f64 {
            (0..self.ticks()).map(|k| self.weight[k] * (term(0, k) + term(1, k))).sum()
        };
        let energy = sum(&|m, k| s[m][k] * s[m][k]);
        let cross = sum(&|m, k| s[m][k] * (self.z[k][m] - f[m][k]));
        let magnitude = if energy > 0.0 { (cross / energy).max(low).min(high) } else { 0.0 };
        (sum(&|m, k| (self.z[k][m] - f[m][k] - magnitude * s[m][k]).powi(2)), magnitude)
    }

    /// The same for each hypothesis; of a clogged T1 with the best lag.
    fn all(&self) -> Vec<(f64, f64)> {
        let lags = |signature| if signature == Signature::T1Clogged { &LAGS[..] } else { &LAGS[..1] };
        let least = |row: &super::hypothesis::Hypothesis| {
            let tried = lags(row.signature).iter().map(|lag| self.least_squares(row.signature, *lag));
            tried.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
        };
        HYPOTHESES.iter().map(least).collect()
    }
}

/// Through the whitener of residual m, from rest.
fn whiten(x: &[f64], m: usize) -> Vec<f64> {
    let (c, sigma) = yule_walker(&R[m]);
    let before = |k: usize| (0..ORDER.min(k)).map(|i| c[i] * x[k - 1 - i]).sum::<f64>();
    (0..x.len()).map(|k| (x[k] - before(k)) / sigma).collect()
}

fn nothing(_: &[[f64; 2]], _: usize) -> [f64; 2] {
    [0.0; 2]
}

/// Faults that the signatures describe exactly, and what they are.
const FAULTS: [(Signature, Fault); 7] = [
    (Signature::T1Offset, |_, _| [1.5, 0.0]),
    (Signature::T2Offset, |_, _| [0.0, -1.0]),
    (Signature::T0Offset, |_, _| [-2.0, -2.0]),
    (Signature::T1Clogged, |y, k| [-0.15 * y[k + 1][0], 0.0]),
    (Signature::T1Stuck, |y, k| [y[0][0] - y[k + 1][0], 0.0]),
    (Signature::T2Detached, |y, k| [0.0, -0.9 * y[k + 1][1]]),
    (Signature::SwappedT1T2, |y, k| [y[k + 1][1] - y[k + 1][0], y[k + 1][0] - y[k + 1][1]]),
];

/// Every hypothesis, after 1, 20 and 80 ticks, without a fault and with each: what the sums say is what the window says.
#[test]
fn the_bank_is_the_likelihood_ratio_over_the_window() {
    let faults = FAULTS.iter().map(|(_, fault)| *fault).chain([nothing as Fault]);
    for (number, fault) in faults.enumerate() {
        for ticks in [1, 20, 80] {
            let run = run(fault, ticks, 17 + number as u32);
            let ranking = Ranking::new(&run.bank(), TS);
            for (row, (rss, magnitude)) in HYPOTHESES.iter().zip(run.all()) {
                let (found, at) = ranking.rss_and_magnitude(row.signature);
                let energy = run.z.iter().flatten().map(|z| z * z).sum::<f64>();
                let what = (row.signature, number, ticks);
                assert!(
                    (f64::from(found) - rss).abs() < 2e-3 * (energy + rss) + 0.05,
                    "{what:?}: {found}, {rss}"
                );
                if ticks == 1 && row.signature == Signature::T1Clogged {
                    continue; // every lag explains one sample
                }
                assert!(
                    (f64::from(at) - magnitude).abs() < 1e-2 * magnitude.abs() + 2e-3,
                    "{what:?}: {at}, {magnitude}"
                );
            }
        }
    }
}

/// The best by comparing all with all, and what it leads by.
#[test]
fn the_ranking_is_that_of_brute_force() {
    for seed in 1..6 {
        for (signature, fault) in FAULTS {
            let run = run(fault, 60, seed);
            let ranking = Ranking::new(&run.bank(), TS);
            let all = run.all();
            let rss = |of: &dyn Fn(usize) -> bool| {
                let those = (0..all.len()).filter(|h| of(*h)).map(|h| (all[h].0, h));
                those.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
            };
            let likely = |h: usize| HYPOTHESES[h].handicap == 0.0;
            let (best_likely, best_misplaced) = (rss(&likely), rss(&|h| !likely(h)));
            let misplaced = best_misplaced.0 + 20.0 < best_likely.0;
            let (best, h) = if misplaced { best_misplaced } else { best_likely };
            let kind = |h: usize| match HYPOTHESES[h].class {
                FaultClass::AirFlow | FaultClass::HeaterPower => PROCESS,
                other => other.number(),
            };
            let (rival, _) = rss(&|other| (misplaced || likely(other)) && kind(other) != kind(h));
            let misfit = ((best + 8.0) / (2.0 * 60.0 + 8.0)).max(1.0);
            let what = (signature, seed);
            assert_eq!(HYPOTHESES[h].class, HYPOTHESES[signature as usize].class, "{what:?}");
            assert_eq!(ranking.choice(20.0), HYPOTHESES[h].signature, "{what:?}");
            let margin = (rival - best) / misfit;
            assert!(
                (f64::from(ranking.margin()) - margin).abs() < 0.01 * margin + 0.2,
                "{what:?}: {} {margin}",
                ranking.margin()
            );
            assert!(ranking.fits() && !ranking.is_strange(), "{what:?}");
        }
    }
}

/// A change of power is a sag as long as it is a tolerated one, and no offset is.
#[test]
fn only_a_small_change_of_power_is_a_sag() {
    let is_sag = |run: &Run| {
        let bank = run.bank();
        Ranking::new(&bank, TS).is_sag(&bank, 0.045)
    };
    // The answer to the power is linear: added to the residuals of a run without a fault it gives those of one with.
    for (share, expected) in [(-0.03, true), (0.04, true), (-0.2, false)] {
        let mut run = run(nothing, 60, 3);
        let [y1, y2] = run.answers(|u| share * u);
        let [z1, z2] = [whiten(&y1, 0), whiten(&y2, 1)];
        for (z, (z1, z2)) in run.z.iter_mut().zip(z1.iter().zip(&z2)) {
            *z = [z[0] + z1, z[1] + z2];
        }
        assert_eq!(is_sag(&run), expected, "{share}");
    }
    assert!(!is_sag(&run(FAULTS[0].1, 60, 3)));
}
