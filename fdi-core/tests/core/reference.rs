//! The same quantities as in `fdi-core`, computed another way and in f64: these say "right" where a golden says "unchanged".

/// Least squares with exponential forgetting in information form: `R <- lambda R + phi phi'`, `f <- lambda f + phi y`,
/// solved when asked. It shares no recurrence with the factored covariance form, and cannot wind up.
#[derive(Clone, Debug)]
pub(crate) struct InformationLeastSquares {
    lambda: f64,
    r: Vec<Vec<f64>>,
    f: Vec<f64>,
}

impl InformationLeastSquares {
    /// `prior` is the information on each parameter at the start: 1 / D of the covariance form.
    pub(crate) fn new(n: usize, lambda: f64, prior: f64) -> Self {
        let r = (0..n).map(|i| (0..n).map(|j| if i == j { prior } else { 0.0 }).collect()).collect();
        Self { lambda, r, f: vec![0.0; n] }
    }

    /// One sample.
    pub(crate) fn push(&mut self, phi: &[f64], y: f64) {
        for (i, row) in self.r.iter_mut().enumerate() {
            for (j, r) in row.iter_mut().enumerate() {
                *r = self.lambda * *r + phi[i] * phi[j];
            }
            self.f[i] = self.lambda * self.f[i] + phi[i] * y;
        }
    }

    /// The parameters: Gaussian elimination with partial pivoting.
    pub(crate) fn solve(&self) -> Vec<f64> {
        solve(self.r.clone(), self.f.clone())
    }

    /// Diagonal of the inverse information: variances in units of the noise variance.
    pub(crate) fn variances(&self) -> Vec<f64> {
        let n = self.f.len();
        let unit = |i: usize| (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
        (0..n).map(|i| solve(self.r.clone(), unit(i))[i]).collect()
    }
}

/// Solves `a x = b`.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for c in 0..n {
        let pivot = (c..n).max_by(|&i, &j| a[i][c].abs().total_cmp(&a[j][c].abs())).expect("n > c");
        a.swap(c, pivot);
        b.swap(c, pivot);
        for i in c + 1..n {
            let factor = a[i][c] / a[c][c];
            for j in c..n {
                a[i][j] -= factor * a[c][j];
            }
            b[i] -= factor * b[c];
        }
    }
    for c in (0..n).rev() {
        let rest: f64 = (c + 1..n).map(|j| a[c][j] * b[j]).sum();
        b[c] = (b[c] - rest) / a[c][c];
    }
    b
}

/// The PID as the paper writes it, on the control error, summed in f64.
#[derive(Clone, Debug)]
pub(crate) struct PaperPid {
    /// Kp in % per degC, Ti, Td and Ts in s.
    pub(crate) gains: (f64, f64, f64, f64),
    output: f64,
    errors: Option<(f64, f64)>,
}

impl PaperPid {
    /// At rest.
    pub(crate) fn new(kp: f64, ti: f64, td: f64, ts: f64) -> Self {
        Self { gains: (kp, ti, td, ts), output: 0.0, errors: None }
    }

    /// One step on the error; the output is clamped to 0..100 %.
    pub(crate) fn step(&mut self, e: f64) -> f64 {
        let (kp, ti, td, ts) = self.gains;
        let (e1, e2) = self.errors.unwrap_or((e, e));
        self.output += kp * ((e - e1) + ts / ti * e + td / ts * (e - 2.0 * e1 + e2));
        self.output = self.output.clamp(0.0, 100.0);
        self.errors = Some((e, e1));
        self.output
    }
}

/// Beta equation, from the textbook: temperature in degC of an NTC of `r` ohm.
pub(crate) fn beta_equation(r: f64, r25: f64, beta: f64) -> f64 {
    1.0 / (1.0 / 298.15 + (r / r25).ln() / beta) - 273.15
}

/// Mean and standard deviation (divisor n), in two passes.
pub(crate) fn mean_and_sigma(x: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    (mean, (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt())
}

/// A small generator of its own for test signals: uniform in -1..1 (a linear congruence, good enough for noise).
#[derive(Clone, Debug)]
pub(crate) struct TestNoise(pub(crate) u64);

impl TestNoise {
    /// The next value.
    pub(crate) fn draw(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
