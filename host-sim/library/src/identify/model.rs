//! An ARX model in double precision: what it predicts, what it simulates, and how well either fits.

use std::str::FromStr;

use fdi_core::identify::transfer::Transfer;

/// Largest NA and NB.
pub const ORDER_MAX: usize = 8;
/// Largest NK.
pub const DELAY_MAX: usize = 100;

/// Orders of `y[k] + a1 y[k-1] + .. + aNA y[k-NA] = b1 u[k-NK] + .. + bNB u[k-NK-NB+1]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Order {
    /// Number of past outputs, 1..=8.
    pub na: usize,
    /// Number of inputs, 1..=8.
    pub nb: usize,
    /// Samples from the input to the output, 1..=100.
    pub nk: usize,
}

impl Order {
    /// Number of parameters.
    pub fn parameters(self) -> usize {
        self.na + self.nb
    }

    /// Samples that must have gone by before the model can speak.
    pub fn memory(self) -> usize {
        self.na.max(self.nb + self.nk - 1)
    }

    /// `a1` .. `aNA`, `b1` .. `bNB`.
    pub fn names(self) -> impl Iterator<Item = String> {
        (1..=self.na).map(|i| format!("a{i}")).chain((1..=self.nb).map(|i| format!("b{i}")))
    }
}

impl FromStr for Order {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Vec<Option<usize>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
        let order = match numbers[..] {
            [Some(na), Some(nb), Some(nk)] => Self { na, nb, nk },
            _ => return Err("expected three whole numbers NA,NB,NK, for example 2,2,1".into()),
        };
        let fits = |n, max| (1..=max).contains(&n);
        if fits(order.na, ORDER_MAX) && fits(order.nb, ORDER_MAX) && fits(order.nk, DELAY_MAX) {
            Ok(order)
        } else {
            Err(format!("expected NA and NB from 1 to {ORDER_MAX} and NK from 1 to {DELAY_MAX}"))
        }
    }
}

/// A stretch of a recording: input and output, row by row, equally long.
#[derive(Clone, Debug, PartialEq)]
pub struct Signals {
    /// Input.
    pub u: Vec<f64>,
    /// Output.
    pub y: Vec<f64>,
}

impl Signals {
    /// The same stretch with `u` and `y` taken off each row.
    pub fn minus(&self, u: f64, y: f64) -> Self {
        Self { u: self.u.iter().map(|x| x - u).collect(), y: self.y.iter().map(|x| x - y).collect() }
    }
}

/// Mean of a signal; of a constant one, exactly that constant.
pub fn mean(x: &[f64]) -> f64 {
    let first = x.first().copied().unwrap_or(0.0);
    first + x.iter().map(|x| x - first).sum::<f64>() / x.len() as f64
}

/// Root of the mean square of a signal.
pub fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt()
}

/// An ARX model in the units of the recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Its orders.
    pub order: Order,
    /// a1 .. aNA.
    pub a: Vec<f64>,
    /// b1 .. bNB, in units of y per unit of u.
    pub b: Vec<f64>,
}

/// Smallest A(1) for which there is a static gain.
const INTEGRATOR: f64 = 1e-9;

impl Model {
    /// A(1).
    pub fn a_at_1(&self) -> f64 {
        1.0 + self.a.iter().sum::<f64>()
    }

    /// B(1) / A(1); `None` on an integrator. In double precision: A(1) of a process sampled fast is a small difference.
    pub fn static_gain(&self) -> Option<f64> {
        let a = self.a_at_1();
        (a.abs() > INTEGRATOR).then(|| self.b.iter().sum::<f64>() / a)
    }

    /// y[k] from what went before it; `k` must be at least [`Order::memory`].
    fn output(&self, y: &[f64], u: &[f64], k: usize) -> f64 {
        let inputs: f64 = (0..).zip(&self.b).map(|(i, b)| b * u[k - self.order.nk - i]).sum();
        let outputs: f64 = (1..).zip(&self.a).map(|(i, a)| a * y[k - i]).sum();
        inputs - outputs
    }

    /// Each y predicted from the measured rows before it; the first [`Order::memory`] rows have no prediction.
    pub fn predict(&self, s: &Signals) -> Vec<f64> {
        (self.order.memory()..s.y.len()).map(|k| self.output(&s.y, &s.u, k)).collect()
    }

    /// y from the measured input alone, started from the first [`Order::memory`] measured rows, which are left out.
    pub fn simulate(&self, s: &Signals) -> Vec<f64> {
        let start = self.order.memory();
        let mut y = s.y[..start].to_vec();
        for k in start..s.y.len() {
            y.push(self.output(&y, &s.u, k));
        }
        y.split_off(start)
    }

    /// Fit in % of a prediction or simulation of `s`: `100 (1 - |y - model| / |y - mean(y)|)`. 100 is perfect, 0 no
    /// better than the mean; `None` if y never moves or the model's output is beyond all numbers.
    pub fn fit(&self, s: &Signals, output: &[f64]) -> Option<f64> {
        let y = &s.y[self.order.memory()..];
        let average = mean(y);
        let error: f64 = y.iter().zip(output).map(|(y, o)| (y - o) * (y - o)).sum();
        let spread: f64 = y.iter().map(|y| (y - average) * (y - average)).sum();
        let fit = 100.0 * (1.0 - (error / spread).sqrt());
        fit.is_finite().then_some(fit)
    }

    /// The model as the core reads its step response; unused coefficients are zero.
    pub fn transfer(&self) -> Transfer<ORDER_MAX, ORDER_MAX> {
        let padded = |c: &[f64]| std::array::from_fn(|i| c.get(i).map_or(0.0, |&c| c as f32));
        Transfer { a: padded(&self.a), b: padded(&self.b), nk: self.order.nk }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lag() -> Model {
        Model { order: Order { na: 1, nb: 1, nk: 2 }, a: vec![-0.5], b: vec![3.0] }
    }

    #[test]
    fn orders_are_read_and_bounded() {
        assert_eq!("2, 3,1".parse(), Ok(Order { na: 2, nb: 3, nk: 1 }));
        for text in
            ["", "2,2", "2,2,1,1", "a,2,1", "-1,2,1", "0,2,1", "9,2,1", "2,0,1", "2,9,1", "2,2,0", "2,2,101"]
        {
            assert!(text.parse::<Order>().is_err(), "{text}");
        }
        let order = Order { na: 2, nb: 3, nk: 4 };
        assert_eq!((order.parameters(), order.memory()), (5, 6));
        assert_eq!(order.names().collect::<Vec<_>>(), ["a1", "a2", "b1", "b2", "b3"]);
    }

    #[test]
    fn predicts_from_measured_and_simulates_from_simulated_rows() {
        // y[k] = 0.5 y[k-1] + 3 u[k-2]; the last y is off by 1.
        let s = Signals { u: vec![1.0, 0.0, 0.0, 0.0, 0.0], y: vec![0.0, 0.0, 3.0, 2.5, 1.25] };
        assert_eq!(lag().predict(&s), [3.0, 1.5, 1.25]);
        assert_eq!(lag().simulate(&s), [3.0, 1.5, 0.75]);
    }

    #[test]
    fn a_constant_signal_has_exactly_no_movement_about_its_mean() {
        let x = [0.1; 1002];
        assert_ne!(x.iter().sum::<f64>() / 1002.0, 0.1); // why the sum alone will not do
        assert_eq!(mean(&x), 0.1);
        assert_eq!(mean(&[1.0, 2.0, 6.0]), 3.0);
    }

    #[test]
    fn fit_is_100_when_perfect_0_for_the_mean_and_none_without_movement() {
        let s = Signals { u: vec![0.0; 4], y: vec![9.0, 9.0, 1.0, 3.0] };
        assert_eq!(lag().fit(&s, &[1.0, 3.0]), Some(100.0));
        assert_eq!(lag().fit(&s, &[2.0, 2.0]), Some(0.0));
        assert_eq!(lag().fit(&s, &[f64::INFINITY, 2.0]), None);
        assert_eq!(lag().fit(&s.minus(0.0, 1.0), &[0.0, 2.0]), Some(100.0));
        assert_eq!(lag().fit(&Signals { u: vec![0.0; 4], y: vec![1.0; 4] }, &[1.0, 1.0]), None);
    }

    #[test]
    fn padding_does_not_change_what_the_core_reads_off() {
        let padded = lag().transfer();
        let plain = Transfer { a: [-0.5], b: [3.0], nk: 2 };
        assert_eq!(padded.static_gain(), plain.static_gain());
        assert_eq!(padded.rise_time(5.7, 50), plain.rise_time(5.7, 50));
        assert_eq!(padded.residence_time(), plain.residence_time());
        assert!(padded.is_stable());
    }
}
