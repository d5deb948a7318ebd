//! Poles of a discrete-time model: the roots of `z^n + a1 z^(n-1) + .. + an`.

use std::ops::{Add, Div, Mul, Sub};

use serde::Serialize;

/// A complex number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// Absolute value.
    pub fn abs(self) -> f64 {
        self.re.hypot(self.im)
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, z: Self) -> Self {
        Self { re: self.re + z.re, im: self.im + z.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, z: Self) -> Self {
        Self { re: self.re - z.re, im: self.im - z.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, z: Self) -> Self {
        Self { re: self.re * z.re - self.im * z.im, im: self.re * z.im + self.im * z.re }
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, z: Self) -> Self {
        let size = z.re * z.re + z.im * z.im;
        Self { re: (self.re * z.re + self.im * z.im) / size, im: (self.im * z.re - self.re * z.im) / size }
    }
}

const ONE: Complex = Complex { re: 1.0, im: 0.0 };
/// Far more than eighth order needs; a root of multiplicity eight closes in by 1/8 an iteration.
const MAX_ITERATIONS: usize = 500;

/// All roots, the largest first, by the Durand-Kerner iteration: `z_i <- z_i - p(z_i) / prod_(j != i) (z_i - z_j)`.
pub fn roots(a: &[f64]) -> Vec<Complex> {
    let polynomial = |z: Complex| a.iter().fold(ONE, |p, &re| p * z + Complex { re, im: 0.0 });
    // On a spiral within the bound of Cauchy: no symmetry that the iteration could be caught in.
    let radius = 1.0 + a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let turn = Complex { re: 0.4, im: 0.9 };
    let mut next = Complex { re: radius, im: 0.0 };
    let mut z: Vec<Complex> = Vec::with_capacity(a.len());
    for _ in a {
        z.push(next);
        next = next * turn;
    }
    for _ in 0..MAX_ITERATIONS {
        let mut moved: f64 = 0.0;
        for i in 0..z.len() {
            let others = (0..z.len()).filter(|&j| j != i).fold(ONE, |p, j| p * (z[i] - z[j]));
            let step = polynomial(z[i]) / others;
            if step.abs().is_finite() {
                z[i] = z[i] - step;
                moved = moved.max(step.abs());
            }
        }
        if moved < 1e-15 * radius {
            break;
        }
    }
    z.sort_by(|p, q| q.abs().total_cmp(&p.abs()));
    z
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients a1 .. an of the product of (z - r).
    fn coefficients(roots: &[Complex]) -> Vec<f64> {
        let mut p = vec![ONE];
        for &r in roots {
            p.push(Complex { re: 0.0, im: 0.0 });
            for i in (1..p.len()).rev() {
                p[i] = p[i] - p[i - 1] * r;
            }
        }
        p[1..].iter().map(|c| c.re).collect()
    }

    fn assert_roots(expected: &[(f64, f64)], tolerance: f64) {
        let expected: Vec<Complex> = expected.iter().map(|&(re, im)| Complex { re, im }).collect();
        let found = roots(&coefficients(&expected));
        assert_eq!(found.len(), expected.len());
        for (e, f) in expected.iter().zip(&found) {
            let nearest = found.iter().map(|f| (*f - *e).abs()).fold(f64::INFINITY, f64::min);
            assert!(
                nearest < tolerance && (f.abs() - e.abs()).abs() < tolerance,
                "{found:?}, expected {expected:?}"
            );
        }
    }

    #[test]
    fn finds_real_complex_and_unstable_roots_largest_first() {
        assert_roots(&[(0.5, 0.0)], 1e-12);
        assert_roots(&[(0.99, 0.0), (-0.3, 0.0)], 1e-12);
        assert_roots(&[(1.2, 0.0), (0.6, 0.5), (0.6, -0.5), (0.0, 0.0)], 1e-12);
        assert_roots(
            &[
                (0.99, 0.0),
                (0.95, 0.0),
                (-0.8, 0.0),
                (0.5, 0.4),
                (0.5, -0.4),
                (0.4, 0.0),
                (0.2, 0.0),
                (0.1, 0.0),
            ],
            1e-9,
        );
    }

    #[test]
    fn survives_multiple_roots() {
        assert_roots(&[(0.9, 0.0), (0.9, 0.0)], 1e-6);
        assert_roots(&[(0.0, 0.0); 8], 1e-6);
    }
}
