//! Does the estimator survive what kills textbook forms: millions of samples with little or no excitation?

use fdi_core::identify::arx::Arx;
use fdi_core::identify::{Adaptation, IdentificationConfig};
use fdi_core::{Celsius, Percent};

use crate::reference::{InformationLeastSquares, TestNoise};

/// What the input does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pattern {
    /// Input and output constant to the last bit.
    Constant,
    /// Ten minutes of PRBS, fifty of a constant input, again and again.
    TenInSixty,
    /// A constant input, and an output that chatters by one ADC count (0.025 degC).
    Chatter,
}

/// All patterns.
pub(crate) const PATTERNS: [Pattern; 3] = [Pattern::Constant, Pattern::TenInSixty, Pattern::Chatter];

/// Forgetting factors tried.
pub(crate) const LAMBDAS: [f32; 3] = [0.95, 0.99, 0.999];

/// Samples of the excitation at the end: several memories of the slowest estimator.
const RECOVERY: u64 = 20_000;
/// Sample time, s.
const TS: f64 = 0.11;
/// Typical rise and power.
const SCALES: (f64, f64) = (12.5, 41.7);

/// How a run ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outcome {
    /// First sample at which the estimator said something that is no finite number.
    pub(crate) first_not_finite: Option<u64>,
    /// Resets of a diverged estimator.
    pub(crate) resets: u32,
    /// Static gain after the excitation came back.
    pub(crate) static_gain: f32,
    /// The same from the f64 reference over the same samples.
    pub(crate) reference: f64,
}

impl Outcome {
    /// Relative error of the static gain.
    pub(crate) fn error(&self) -> f64 {
        (f64::from(self.static_gain) / self.reference - 1.0).abs()
    }
}

/// Runs `samples` of a pattern, then excites again, beside the f64 reference.
pub(crate) fn run(pattern: Pattern, lambda: f32, samples: u64) -> Outcome {
    let config = IdentificationConfig {
        adaptation: Adaptation::Forgetting { lambda },
        d_initial: 1e4,
        d_max: 1e5,
        y_scale: Celsius(SCALES.0 as f32),
        u_scale: Percent(SCALES.1 as f32),
        ..IdentificationConfig::default()
    };
    let arx = Arx::<3, 3, 1, 6>::new(&config).expect("valid");
    let mut state = arx.start();
    let mut reference = InformationLeastSquares::new(6, f64::from(lambda), 1e-4);
    let mut plant = Plant::new();
    let mut first_not_finite = None;
    let total = samples + RECOVERY;
    for k in 0..total {
        let y = plant.output(pattern, k < samples) as f32;
        let u = plant.input(pattern, k, k < samples) as f32;
        if k >= 3 {
            reference.push(&plant.regressor(), f64::from(y) / SCALES.0);
        }
        let step = arx.step(&mut state, Some(y), u);
        let finite =
            step.prediction.unwrap_or(0.0).is_finite() && state.rls.theta.iter().all(|t| t.is_finite());
        if !finite && first_not_finite.is_none() {
            first_not_finite = Some(k);
        }
        plant.advance(f64::from(y), f64::from(u));
    }
    let theta = reference.solve();
    let gain = (theta[3] + theta[4] + theta[5]) / (1.0 + theta[0] + theta[1] + theta[2]);
    Outcome {
        first_not_finite,
        resets: state.rls.resets,
        static_gain: arx.transfer(&state).static_gain().unwrap_or(f32::NAN),
        reference: gain * SCALES.0 / SCALES.1,
    }
}

/// First-order plant of gain 0.3 and time constant 0.5 s with one sample of dead time.
struct Plant {
    y: f64,
    past_y: [f64; 3],
    past_u: [f64; 3],
    noise: TestNoise,
}

impl Plant {
    fn new() -> Self {
        Self { y: 12.51, past_y: [12.51; 3], past_u: [41.7; 3], noise: TestNoise(1) }
    }

    /// What is measured.
    fn output(&mut self, pattern: Pattern, quiet_phase: bool) -> f64 {
        let noise = self.noise.draw();
        match pattern {
            Pattern::Constant if quiet_phase => 12.51,
            Pattern::Chatter if quiet_phase => 12.51 + if noise > 0.0 { 0.025 } else { 0.0 },
            _ => self.y + 0.05 * noise,
        }
    }

    fn input(&mut self, pattern: Pattern, k: u64, quiet_phase: bool) -> f64 {
        let minute = (k as f64 * TS / 60.0) as u64;
        let excited = !quiet_phase || (pattern == Pattern::TenInSixty && minute % 60 < 10);
        let bit = self.noise.draw() > 0.0;
        match (excited, bit) {
            (false, _) => 41.7,
            (true, true) => 41.7 + 5.1,
            (true, false) => 41.7 - 5.1,
        }
    }

    /// Scaled like the estimator's.
    fn regressor(&self) -> [f64; 6] {
        let y = self.past_y.map(|y| -y / SCALES.0);
        let u = self.past_u.map(|u| u / SCALES.1);
        [y[0], y[1], y[2], u[0], u[1], u[2]]
    }

    fn advance(&mut self, y: f64, u: f64) {
        let a = (-TS / 0.5f64).exp();
        self.y = a * self.y + (1.0 - a) * 0.3 * self.past_u[0];
        self.past_y = [y, self.past_y[0], self.past_y[1]];
        self.past_u = [u, self.past_u[0], self.past_u[1]];
    }
}
