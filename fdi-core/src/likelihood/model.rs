//! Output-error simulation: what a frozen model makes of its input alone, with no look at the measured output.
//!
//! An offset of a sensor stays in full in the residual of a simulation; a one-step prediction, fed with the faulty
//! output itself, would hide all of it but A(1).

/// `y[k] = -a1 y[k-1] - .. - aNA y[k-NA] + b1 u[k] + .. + bNB u[k-NB+1]`, where u\[k\] is the newest input given.
#[derive(Clone, Copy, Debug)]
pub(super) struct Model<const NA: usize, const NB: usize> {
    pub(super) a: [f32; NA],
    pub(super) b: [f32; NB],
}

/// The memory of a [`Model`]: past outputs and inputs, newest first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Simulation<const NA: usize, const NB: usize> {
    pub(super) y: [f32; NA],
    pub(super) u: [f32; NB],
}

impl<const NA: usize, const NB: usize> Default for Simulation<NA, NB> {
    fn default() -> Self {
        Self { y: [0.0; NA], u: [0.0; NB] }
    }
}

impl<const NA: usize, const NB: usize> Model<NA, NB> {
    /// Takes in the newest input, gives the output that follows from it.
    #[inline(never)]
    pub(super) fn step(&self, s: &mut Simulation<NA, NB>, u: f32) -> f32 {
        shift(&mut s.u, u);
        let y = self.output(s);
        shift(&mut s.y, y);
        y
    }

    /// Static gain.
    pub(super) fn gain(&self) -> f32 {
        self.b.iter().sum::<f32>() / (1.0 + self.a.iter().sum::<f32>())
    }

    /// Mean residence time in ticks, half a tick of holding included: with the input named u\[k\] one tick old.
    pub(super) fn residence(&self) -> f32 {
        let weighted = |x: &[f32]| x.iter().enumerate().map(|(i, x)| (i + 1) as f32 * x).sum::<f32>();
        let (a, b) = (1.0 + self.a.iter().sum::<f32>(), self.b.iter().sum::<f32>());
        weighted(&self.b) / b - weighted(&self.a) / a
    }

    /// The output that follows from the past.
    #[inline(never)]
    pub(super) fn output(&self, s: &Simulation<NA, NB>) -> f32 {
        dot(&self.b, &s.u) - dot(&self.a, &s.y)
    }
}

/// Puts `x` in front of what was there.
#[inline]
pub(super) fn shift<const N: usize>(past: &mut [f32; N], x: f32) {
    for i in (1..N).rev() {
        past[i] = past[i - 1];
    }
    past[0] = x;
}

/// Inner product.
#[inline]
pub(super) fn dot<const N: usize>(a: &[f32; N], b: &[f32; N]) -> f32 {
    let mut sum = 0.0;
    for i in 0..N {
        sum += a[i] * b[i];
    }
    sum
}
