//! What a discrete-time model says: static gain, stability, mean residence time.
//!
//! ```
//! use fdi_core::identify::transfer::Transfer;
//!
//! // y[k] = 0.8 y[k-1] + 0.06 u[k-2]
//! let model = Transfer { a: [-0.8], b: [0.06], nk: 2 };
//! assert!(model.is_stable());
//! assert!(model.static_gain().is_some_and(|gain| (gain - 0.3).abs() < 1e-6));
//! assert!(model.residence_time().is_some_and(|samples| (samples - 6.0).abs() < 1e-4)); // 2 of delay, 4 of lag
//! let rise = model.rise_time(0.95 * 0.3, 100); // 0.8^14 < 5 %, and one sample more of delay
//! assert_eq!(rise.map(f32::ceil), Some(15.0));
//! assert!(!Transfer { a: [-1.1], ..model }.is_stable());
//! ```

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

#[cfg(test)]
mod tests {
    use super::*;

    /// A constant input ends at the static gain; an impulse has its centroid at the residence time: by the difference equation, in f64.
    #[test]
    fn gain_and_residence_time_are_those_of_the_difference_equation() {
        let model = Transfer { a: [-0.8, 0.0, 0.0], b: [0.1, 0.2], nk: 1 };
        let (mut step, mut y, mut area, mut moment) = (0.0, 0.0, 0.0, 0.0);
        for k in 0..200 {
            let input = |at: i32| f64::from(u8::from(at == 0));
            step = 0.8 * step + 0.1 + if k > 0 { 0.2 } else { 0.0 };
            y = 0.8 * y + 0.1 * input(k) + 0.2 * input(k - 1);
            area += y;
            moment += y * f64::from(k + 1); // the input was that of a sample ago
        }
        assert!((step - f64::from(model.static_gain().unwrap())).abs() < 1e-4);
        assert!((moment / area - f64::from(model.residence_time().unwrap())).abs() < 1e-3);
    }
}
