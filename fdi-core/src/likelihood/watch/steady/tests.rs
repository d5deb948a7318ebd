extern crate std;

use std::vec::Vec;

use super::super::innovations::InnovationsState;
use super::super::simulation::{Simulation, SimulationState};
use super::super::tests::{TS, input};
use super::super::times::Times;
use super::*;
use crate::likelihood::class::FaultClass;
use crate::likelihood::hypothesis::{HYPOTHESES, SINCE_TRAINING};
use crate::likelihood::posterior::Posterior;
use crate::likelihood::process::Motion;
use crate::likelihood::process::Parameters;
use crate::likelihood::reference::Random;
use crate::likelihood::regressor::Regressor;
use crate::likelihood::second_heater::SecondHeater;
use crate::likelihood::training::Trained;
use crate::likelihood::usual::Usual;
use crate::likelihood::whitening::WhiteningFilter;

/// Innovations of both residuals, degC.
const SIGMA: f32 = 0.05;
/// Ticks until the fast band has its reference.
const REFERENCE: u32 = 800;

fn constants() -> SteadyConstants {
    SteadyConstants {
        keep: 1.0 - 1.0 / 545.0,
        reference: REFERENCE,
        split: LowPass::over(45.0),
        mean: LowPass::over(227.0),
    }
}

/// A rig that is excited as while it monitors, its model, and what is gathered of it.
struct Run {
    simulation: Simulation,
    state: SimulationState,
    times: Times,
    innovations: InnovationsState,
    steady: Steady,
    random: Random,
    bit: f32,
    ticks: usize,
    /// Of the gain's error now, and as `steady` says for what is gathered.
    curvature: [f32; 2],
    gathered: [f32; 2],
}

impl Run {
    fn new(seed: u64) -> Self {
        let tuning = Tuned::default();
        let rise = 40.0 * libm::expf(-1.2);
        let mut whitening = WhiteningFilter::default();
        (whitening.sigma, whitening.inv_sigma) = ([SIGMA; 2], [1.0 / SIGMA; 2]);
        let trained = Trained {
            parameters: Parameters([-1.2, 1.4, 1.0, -0.5, 0.0, 0.92, 0.9, 1.3, 0.0, 5.6, 0.0, 0.0, 0.0]),
            motion: Motion::steady(40.0),
            whitening,
            mean: [0.0; 2],
            beside: SecondHeater::default(),
            power: 40.0,
            rise,
            curvature_error: 0.0,
        };
        let simulation = Simulation { inputs: Inputs::ALL, tuning };
        Self {
            state: simulation.start(&trained),
            simulation,
            times: Times::new(tuning, &trained, Inputs::ALL, TS),
            innovations: InnovationsState::new(tuning, whitening),
            steady: Steady::new(tuning),
            random: Random::new(seed),
            bit: 5.0,
            ticks: 0,
            curvature: [0.0; 2],
            gathered: [0.0; 2],
        }
    }

    /// So many ticks whose residuals are noise and what is given of each tick's regressors, by the tick of this call.
    fn ticks(&mut self, n: usize, residual: impl Fn(usize, &Regressors<LASTING>) -> [f32; 2]) {
        let c = constants();
        for k in 0..n {
            if self.ticks.is_multiple_of(2) {
                self.bit = if self.random.uniform() > 0.5 { 5.0 } else { -5.0 };
            }
            self.ticks += 1;
            let now = input(self.ticks as u32, [None; 2], 40.0 + self.bit);
            let row = self.simulation.step(&mut self.state, &self.times, &now).regressors;
            let e = residual(k, &row).map(|e| e + SIGMA * self.random.gaussian() as f32);
            let z = self.innovations.step(e, e, [0.0; 2]).z_trained;
            let mut whitened = [[0.0; 2]; LASTING];
            self.innovations.whiten(&row, &mut whitened);
            self.gathered = self.steady.gather(&c, &row, &whitened, e, z, self.curvature);
        }
    }

    /// The likeliest class, the gain of the best hypothesis, and the size of the likeliest.
    fn judged(&self) -> (FaultClass, f32, f32) {
        self.judged_with(&SINCE_TRAINING)
    }

    fn judged_with(&self, nuisances: &[Nuisance]) -> (FaultClass, f32, f32) {
        let mut estimate = [Estimate::default(); hypothesis::COUNT];
        self.steady.judge(nuisances, &mut estimate, Inputs::ALL);
        let posterior = Posterior::new(&estimate);
        let h = posterior.likeliest;
        (HYPOTHESES[h].class, posterior.best_gain, self.steady.size(nuisances, h, Inputs::ALL).value)
    }
}

fn nothing(_: usize, _: &Regressors<LASTING>) -> [f32; 2] {
    [0.0; 2]
}

fn of(regressor: Regressor, size: f32) -> impl Fn(usize, &Regressors<LASTING>) -> [f32; 2] {
    move |_, row| row[regressor as usize].map(|value| size * value)
}

/// What comes within two minutes, and stays: its name and its size, against a residual that says no more than its regressors.
#[test]
fn what_changed_slowly_is_named_with_its_size() {
    let cases = [
        (Regressor::Power, -0.15, FaultClass::HeaterPower),
        (Regressor::Power, 0.2, FaultClass::HeaterPower),
        (Regressor::LessFlow, 0.2, FaultClass::AirFlow),
        (Regressor::MoreFlow, -0.18, FaultClass::AirFlow),
        (Regressor::Offset1, 1.5, FaultClass::T1Offset),
        (Regressor::Offset2, -1.5, FaultClass::T2Offset),
        (Regressor::Gain1, -0.2, FaultClass::T1Clogged),
    ];
    for (regressor, size, class) in cases {
        for seed in 1..4 {
            let mut run = Run::new(seed);
            run.ticks(REFERENCE as usize + 10, nothing);
            run.ticks(1100, |k, row| row[regressor as usize].map(|value| size * k as f32 / 1100.0 * value));
            run.ticks(1500, of(regressor, size));
            let (named, gain, estimate) = run.judged();
            assert!(
                named == class && gain > 5.0,
                "{regressor:?} by {size}: {named:?}, gain {gain}, seed {seed}"
            );
            let error = (estimate / size - 1.0).abs();
            assert!(error < 0.12, "{regressor:?} by {size}: {estimate}, seed {seed}");
        }
    }
}

#[test]
fn nothing_gains_nothing() {
    for seed in 1..11 {
        let mut run = Run::new(seed);
        run.ticks(REFERENCE as usize + 2000, nothing);
        let (_, gain, _) = run.judged();
        assert!(gain < 1.5, "gain {gain}, seed {seed}");
    }
}

/// A model whose answer comes too early by a share of a tick, always: that is what the reference takes away, and the means do not see it.
#[test]
fn the_reference_takes_a_constant_model_error_away() {
    let fast_error = of(Regressor::Shift, 0.5);
    for seed in 1..4 {
        let mut run = Run::new(seed);
        run.ticks(REFERENCE as usize + 2000, &fast_error);
        let (class, gain, _) = run.judged();
        assert!(gain < 1.5, "{class:?} gains {gain}, seed {seed}");
        let learnt = run.steady.reference[Regressor::Shift as usize];
        assert!((learnt - 0.5).abs() < 0.1, "{learnt} ticks, seed {seed}");
    }
}

/// After a change on purpose what is there counts as trained; a change later is held against that.
#[test]
fn what_was_changed_on_purpose_counts_as_trained() {
    let mut run = Run::new(1);
    run.ticks(REFERENCE as usize + 500, nothing);
    run.steady.rebase();
    assert!(!run.steady.is_ready(0.0));
    let level = |offset: f32| move |_: usize, _: &Regressors<LASTING>| [1.2 + offset, 0.9];
    run.ticks(REFERENCE as usize + 2000, level(0.0));
    let (class, gain, _) = run.judged();
    assert!(gain < 1.5, "{class:?} gains {gain}");
    run.ticks(1500, level(1.5));
    let (class, gain, size) = run.judged();
    assert!(
        class == FaultClass::T1Offset && gain > 5.0 && (size - 1.5).abs() < 0.2,
        "{class:?} {gain} {size}"
    );
}

/// A step of the mains, after which the minute is gathered anew: what answers is more power, and not a T0 that reads wrong because the fast band has
/// the step and not what it did to the answers.
#[test]
fn a_step_of_the_power_is_no_error_of_t0() {
    for seed in 1..6 {
        let mut run = Run::new(seed);
        run.ticks(REFERENCE as usize + 1500, nothing);
        run.ticks(90, of(Regressor::Power, 0.12));
        run.steady.forget([1.4, 1.3]);
        run.ticks(240, of(Regressor::Power, 0.12));
        let (class, gain, size) = run.judged();
        assert!(class == FaultClass::HeaterPower, "{class:?} gains {gain}, {size}, seed {seed}");
    }
}

/// A set-point far away, where the gain is known less well, and back: the means remember what was measured there, and the error of the gain with it.
#[test]
fn what_was_gathered_far_from_the_trained_power_stays_as_uncertain_as_it_was_there() {
    for seed in 1..6 {
        let mut run = Run::new(seed);
        run.ticks(REFERENCE as usize + 1500, nothing);
        run.curvature = [0.25 * 0.25, 3.0 * 3.0];
        run.ticks(350, of(Regressor::Power, 0.25));
        run.curvature = [0.0; 2];
        run.ticks(45, nothing);
        let usual =
            |[curvature, offset]: [f32; 2]| Usual { curvature, ..Usual::calm() }.since_training(offset);
        let raise = Tuned::default().since_training.raise;
        let (class, gain, _) = run.judged_with(&usual(run.gathered));
        assert!(gain < raise, "{class:?} gains {gain}, seed {seed}");
        let (class, gain, _) = run.judged_with(&usual(run.curvature));
        assert!(gain > raise, "as if it had never been there: {class:?} gains {gain}, seed {seed}");
    }
}

/// A wild tick now and then, as the first of each abrupt fault is, is no change: neither for the sums nor for the means.
#[test]
fn outliers_do_not_carry_a_verdict() {
    for seed in 1..6 {
        let mut run = Run::new(seed);
        run.ticks(REFERENCE as usize + 1500, nothing);
        for _ in 0..3 {
            let before = run.steady.mean_e;
            run.ticks(1, |_, _| [-25.0, -12.0]);
            assert!(
                (0..2).all(|m| (run.steady.mean_e[m] - before[m]).abs() < 0.01),
                "{:?}",
                run.steady.mean_e
            );
            run.ticks(60, nothing);
            let (class, gain, _) = run.judged();
            assert!(gain < 1.5, "{class:?} gains {gain}, seed {seed}");
        }
    }
}

/// It judges every thirtieth tick, and not before there is a reference and so much since.
#[test]
fn it_waits_for_its_reference() {
    let mut run = Run::new(3);
    run.ticks(REFERENCE as usize - 1, nothing);
    assert!(!run.steady.is_ready(0.0));
    run.ticks(1, nothing);
    let ready: Vec<bool> = (0..100)
        .map(|_| {
            run.ticks(1, nothing);
            run.steady.is_ready(20.0)
        })
        .collect();
    let at: Vec<usize> = (0..100).filter(|k| ready[*k]).map(|k| k + 1).collect();
    assert_eq!(at, [30, 60, 90]);
}
