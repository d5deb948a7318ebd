//! How far the residuals of one fault are from those of another: the Kullback-Leibler distance of two Gaussian sequences.
//!
//! Both faults shift the mean of the same sequence: by `Phi c` and `Phi c'`, with the whitened columns `Phi` and what the faults make of
//! each column, c and c'. Its covariance is `kappa I + Phi N Phi'` with the nuisances' prior variances N. With the columns' products
//! `G = Phi' Phi`:
//!
//! ```text
//! D(theta) = min (c - c')' M (c - c') / 2,      M = G / kappa - G' (N^-1 + G / kappa)^-1 G / kappa^2
//! ```
//!
//! The least is over whatever the other fault may be (Eriksson, Frisk, Krysander 2013).

use fdi_core::likelihood::signatures::{Candidate, REGRESSORS, Term};

/// A value a column.
pub type Columns = [f64; REGRESSORS];

/// Products of the columns, summed.
#[derive(Clone, Debug)]
pub struct Products([Columns; REGRESSORS]);

impl Default for Products {
    fn default() -> Self {
        Self([[0.0; REGRESSORS]; REGRESSORS])
    }
}

impl Products {
    /// The columns of a tick in T1 and T2.
    pub fn add(&mut self, row: &[[f32; 2]; REGRESSORS]) {
        let wide = row.map(|values| values.map(f64::from));
        for (sums, a) in self.0.iter_mut().zip(&wide) {
            for (sum, b) in sums.iter_mut().zip(&wide) {
                *sum += a[0] * b[0] + a[1] * b[1];
            }
        }
    }
}

/// What the residuals tell of the columns when some directions may move by themselves.
#[derive(Clone, Debug)]
pub struct Information([Columns; REGRESSORS]);

impl Information {
    /// With nuisances of these standard deviations, and the evidence divided by `kappa`, as in the bank.
    pub fn new(products: &Products, nuisances: &[Term], kappa: f32) -> Self {
        let all = Self(products.0.map(|row| row.map(|sum| sum / f64::from(kappa))));
        nuisances.iter().fold(all, |information, nuisance| information.without(nuisance))
    }

    /// When one more may move: what it explains is taken away, as far as its prior lets it move.
    fn without(mut self, nuisance: &Term) -> Self {
        let q = weights(nuisance);
        let shared = self.times(&q);
        let sd = f64::from(nuisance.sd);
        let scale = sd * sd / (1.0 + sd * sd * dot(&q, &shared));
        for (row, a) in self.0.iter_mut().zip(&shared) {
            for (value, b) in row.iter_mut().zip(&shared) {
                *value -= scale * a * b;
            }
        }
        self
    }

    fn times(&self, x: &Columns) -> Columns {
        self.0.map(|row| dot(&row, x))
    }
}

/// The distance of a fault of any magnitude from another, or from none.
#[derive(Clone, Copy, Debug)]
pub struct Distance {
    /// Of the fault: theta a + r is what it moves beyond the other's mean.
    aa: f64,
    ar: f64,
    rr: f64,
    /// The other's direction b, and the bounds of its magnitude.
    ab: f64,
    rb: f64,
    bb: f64,
    range: (f64, f64),
}

impl Distance {
    /// From nothing but nuisances.
    pub fn from_nothing(fault: &Candidate, information: &Information) -> Self {
        Self::between(fault, information, &[0.0; REGRESSORS], &[0.0; REGRESSORS], (0.0, 0.0))
    }

    /// From another fault, whatever its magnitude and whatever else it changes.
    pub fn from_other(fault: &Candidate, other: &Candidate, information: &Information) -> Self {
        let range = (f64::from(other.range.0), f64::from(other.range.1));
        let direction = weights(&other.first);
        match &other.second {
            None => Self::between(fault, information, &[0.0; REGRESSORS], &direction, range),
            Some(second) => {
                let freed = information.clone().without(second);
                Self::between(fault, &freed, &constant_part(second), &direction, range)
            }
        }
    }

    fn between(
        fault: &Candidate,
        information: &Information,
        mean: &Columns,
        b: &Columns,
        range: (f64, f64),
    ) -> Self {
        let a = weights(&fault.first);
        let mut r = fault.second.as_ref().map_or([0.0; REGRESSORS], constant_part);
        r.iter_mut().zip(mean).for_each(|(r, mean)| *r -= mean);
        let [of_a, of_b, of_r] = [&a, b, &r].map(|x| information.times(x));
        Self {
            aa: dot(&a, &of_a),
            ar: dot(&a, &of_r),
            rr: dot(&r, &of_r),
            ab: dot(&a, &of_b),
            rb: dot(&r, &of_b),
            bb: dot(b, &of_b),
            range,
        }
    }

    /// With the magnitude `theta`.
    pub fn at(&self, theta: f64) -> f64 {
        let shared = theta * self.ab + self.rb;
        let best = if self.bb > 0.0 { shared / self.bb } else { 0.0 };
        let other = best.clamp(self.range.0, self.range.1);
        let own = theta * (theta * self.aa + 2.0 * self.ar) + self.rr;
        0.5 * (own - other * (2.0 * shared - other * self.bb)).max(0.0)
    }

    /// The magnitude, its sign apart, from which on the distance is above `least`; none where it is not at `most`. It is convex, so
    /// that it is below between two magnitudes at most.
    pub fn first_above(&self, least: f64, sign: f64, from: f64, most: f64) -> Option<f64> {
        if self.at(sign * most) < least {
            return None;
        }
        let nearest = bisect(from, most, |x| self.at(sign * (x + STEP)) > self.at(sign * x));
        if self.at(sign * nearest) >= least {
            return Some(from);
        }
        Some(bisect(nearest, most, |x| self.at(sign * x) >= least))
    }
}

/// What a slope is taken over.
const STEP: f64 = 1e-6;

/// Where something that is not so at `low` becomes so.
fn bisect(mut low: f64, mut high: f64, is_so: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if is_so(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

fn weights(term: &Term) -> Columns {
    term.weights.map(f64::from)
}

/// What a term moves when its factor is the mean.
fn constant_part(term: &Term) -> Columns {
    weights(term).map(|weight| weight * f64::from(term.mean))
}

fn dot(a: &Columns, b: &Columns) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use fdi_core::FaultClass;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::*;

    const TICKS: usize = 12;
    const N: usize = 2 * TICKS;

    fn term(column: usize, mean: f32, sd: f32) -> Term {
        let mut weights = [0.0; REGRESSORS];
        weights[column] = 1.0;
        weights[column + 1] = -0.5;
        Term { weights, mean, sd }
    }

    fn candidate(first: Term, second: Option<Term>, range: (f32, f32)) -> Candidate {
        Candidate { class: FaultClass::Drift, which: "", first, second, range, prior: 0.0, sized: true }
    }

    /// The sequence that some factors on the columns give.
    fn sequence(rows: &[[[f32; 2]; REGRESSORS]], c: &Columns) -> [f64; N] {
        std::array::from_fn(|k| (0..REGRESSORS).map(|i| c[i] * f64::from(rows[k / 2][i][k % 2])).sum())
    }

    /// `C^-1 x` by Gauss and Jordan.
    fn solve(mut c: [[f64; N]; N], mut x: [f64; N]) -> [f64; N] {
        for i in 0..N {
            for k in (0..N).filter(|k| *k != i) {
                let factor = c[k][i] / c[i][i];
                (0..N).for_each(|j| c[k][j] -= factor * c[i][j]);
                x[k] -= factor * x[i];
            }
        }
        std::array::from_fn(|i| x[i] / c[i][i])
    }

    const KAPPA: f32 = 1.5;

    /// The least value of a convex function.
    fn least(low: f64, high: f64, f: &dyn Fn(f64) -> f64) -> f64 {
        let (mut low, mut high) = (low, high);
        for _ in 0..200 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if f(a) < f(b) { high = b } else { low = a }
        }
        f(0.5 * (low + high))
    }

    /// Against the distance of two Gaussian sequences as it is defined: covariances written out and inverted, the other fault's magnitude
    /// and what else it changes searched for.
    #[test]
    fn the_distance_is_that_of_the_sequences() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(26);
        let rows: Vec<[[f32; 2]; REGRESSORS]> = (0..TICKS)
            .map(|_| std::array::from_fn(|_| std::array::from_fn(|_| random.random_range(-1.0..1.0))))
            .collect();
        let mut products = Products::default();
        rows.iter().for_each(|row| products.add(row));
        let nuisances = [term(0, 0.0, 0.3), term(4, 0.0, 2.0)];
        let information = Information::new(&products, &nuisances, KAPPA);

        let mut covariance = [[0.0; N]; N];
        for nuisance in &nuisances {
            let q = sequence(&rows, &weights(nuisance));
            let variance = f64::from(nuisance.sd).powi(2);
            (0..N).for_each(|i| (0..N).for_each(|j| covariance[i][j] += variance * q[i] * q[j]));
        }
        (0..N).for_each(|i| covariance[i][i] += f64::from(KAPPA));

        let fault = candidate(term(1, 0.0, 1.0), Some(term(7, 0.8, 0.1)), (-3.0, 3.0));
        let other = candidate(term(2, 0.0, 1.0), Some(term(9, -0.4, 0.5)), (-0.3, 0.2));
        let [a, own, b, q] =
            [&fault.first, fault.second.as_ref().unwrap(), &other.first, other.second.as_ref().unwrap()];
        let (mean, sd) = (f64::from(q.mean), f64::from(q.sd));
        let kullback_leibler = |theta: f64, f: f64, g: f64| {
            let c: Columns = std::array::from_fn(|i| {
                let own = f64::from(own.mean * own.weights[i]) + theta * f64::from(a.weights[i]);
                own - f * f64::from(b.weights[i]) - g * f64::from(q.weights[i])
            });
            let shift = sequence(&rows, &c);
            let solved = solve(covariance, shift);
            0.5 * shift.iter().zip(&solved).map(|(x, y)| x * y).sum::<f64>()
        };
        let nothing = Distance::from_nothing(&fault, &information);
        let another = Distance::from_other(&fault, &other, &information);
        for theta in [-2.0, -0.3, 0.0, 0.4, 1.7] {
            let wanted = kullback_leibler(theta, 0.0, 0.0);
            assert!((nothing.at(theta) - wanted).abs() < 1e-6 * (1.0 + wanted), "{theta} {wanted}");
            // A quadratic function of f and g is known from six values of it.
            let at = |f: f64, g: f64| kullback_leibler(theta, f, g);
            let zero = at(0.0, 0.0);
            let (ff, gg) =
                (0.5 * (at(1.0, 0.0) + at(-1.0, 0.0)) - zero, 0.5 * (at(0.0, 1.0) + at(0.0, -1.0)) - zero);
            let (f1, g1) = (at(1.0, 0.0) - zero - ff, at(0.0, 1.0) - zero - gg);
            let fg = at(1.0, 1.0) - zero - ff - gg - f1 - g1;
            let penalised = |f: f64, g: f64| {
                zero + f * (f1 + f * ff) + g * (g1 + g * gg) + f * g * fg + 0.5 * ((g - mean) / sd).powi(2)
            };
            let (low, high) = (f64::from(other.range.0), f64::from(other.range.1));
            let wanted = least(low, high, &|f| least(-20.0, 20.0, &|g| penalised(f, g)));
            assert!((another.at(theta) - wanted).abs() < 1e-6 * (1.0 + wanted), "{theta} {wanted}");
        }
    }

    /// The size is where the distance is crossed; where it is above everywhere there is no least one, where nowhere none.
    #[test]
    fn a_fault_is_told_from_where_the_distance_is_crossed() {
        let d = Distance { aa: 2.0, ar: -1.0, rr: 0.5, ab: 0.0, rb: 0.0, bb: 0.0, range: (0.0, 0.0) };
        // D = (theta - 1/2)^2
        assert!(d.at(0.5).abs() < 1e-12 && (d.at(2.5) - 4.0).abs() < 1e-12);
        let size = d.first_above(4.0, 1.0, 0.0, 9.0).unwrap();
        assert!((size - 2.5).abs() < 1e-6, "{size}");
        let other_way = d.first_above(4.0, -1.0, 0.0, 9.0).unwrap();
        assert!((other_way - 1.5).abs() < 1e-6, "{other_way}");
        assert_eq!(d.first_above(4.0, 1.0, 3.0, 9.0), Some(3.0));
        assert_eq!(d.first_above(4.0, 1.0, 0.0, 2.0), None);
    }
}
