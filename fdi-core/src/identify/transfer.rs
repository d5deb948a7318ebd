//! What a discrete-time model says: static gain, stability, mean residence time.

/// `y[k] + a1 y[k-1] + .. + aNA y[k-NA] = b1 u[k-NK] + .. + bNB u[k-NK-NB+1]` (paper, equation 2).
///
/// Coefficients may be zero, so a smaller model fits into a larger type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transfer<const NA: usize, const NB: usize> {
    /// a1 .. aNA.
    pub a: [f32; NA],
    /// b1 .. bNB, in units of y per unit of u.
    pub b: [f32; NB],
    /// Delay from u to y in samples.
    pub nk: usize,
}

/// Smallest A(1) from which a static gain is computed.
const A1_MIN: f32 = 1e-6;
/// The same for B(1), as it divides in the residence time.
const B1_MIN: f32 = 1e-9;

impl<const NA: usize, const NB: usize> Transfer<NA, NB> {
    /// A(1).
    fn a1(&self) -> f32 {
        1.0 + self.a.iter().sum::<f32>()
    }

    /// B(1).
    fn b1(&self) -> f32 {
        self.b.iter().sum()
    }

    /// B(1) / A(1), whatever it may be.
    pub(crate) fn gain(&self) -> f32 {
        self.b1() / self.a1()
    }

    /// G(z = 1) = B(1) / A(1) (paper, equation 10); `None` on an integrator.
    pub fn static_gain(&self) -> Option<f32> {
        let gain = self.gain();
        (self.a1().abs() > A1_MIN && gain.is_finite()).then_some(gain)
    }

    /// Whether all poles lie inside the unit circle: Jury's test, in the form that divides by nothing.
    pub fn is_stable(&self) -> bool {
        let (mut lead, mut a) = (1.0, self.a);
        for m in (1..=NA).rev() {
            let last = a[m - 1];
            let next = lead * lead - last * last;
            if !(next > 0.0) {
                return false;
            }
            let before = a;
            for i in 0..m - 1 {
                a[i] = lead * before[i] - last * before[m - 2 - i];
            }
            lead = next;
        }
        true
    }

    /// Mean residence time of the impulse response in samples, `sum(i b_i) / B(1) - sum(i a_i) / A(1)`, delay included.
    pub fn residence_time(&self) -> Option<f32> {
        let (a1, b1) = (self.a1(), self.b1());
        let first = self.nk as f32 - 1.0;
        let moment = |c: &[f32]| c.iter().zip(1u8..).map(|(c, i)| c * f32::from(i)).sum::<f32>();
        let time = first + moment(&self.b) / b1 - moment(&self.a) / a1;
        (a1.abs() > A1_MIN && b1.abs() > B1_MIN && time.is_finite()).then_some(time)
    }
}
