//! Output-error simulation: what a model makes of its input alone, with no look at the measured output.

use super::transfer::Transfer;
use crate::vector::{dot, shift};

/// The memory of a simulated [`Transfer`]: past outputs and inputs, newest first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simulation<const NA: usize, const NB: usize> {
    pub(crate) y: [f32; NA],
    pub(crate) u: [f32; NB],
}

impl<const NA: usize, const NB: usize> Default for Simulation<NA, NB> {
    fn default() -> Self {
        Self { y: [0.0; NA], u: [0.0; NB] }
    }
}

impl<const NA: usize, const NB: usize> Transfer<NA, NB> {
    /// The output that follows from the newest input, `u[k-NK]`, and the past.
    #[inline(never)]
    pub(crate) fn simulate(&self, s: &mut Simulation<NA, NB>, u: f32) -> f32 {
        shift(&mut s.u, u);
        let y = self.output(s);
        shift(&mut s.y, y);
        y
    }

    /// The output that follows from the past.
    #[inline(never)]
    pub(crate) fn output(&self, s: &Simulation<NA, NB>) -> f32 {
        dot(&self.b, &s.u) - dot(&self.a, &s.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The difference equation written out, in f64, on an input that is no pattern.
    #[test]
    fn it_is_the_difference_equation() {
        let model = Transfer { a: [-1.1, 0.35, -0.02], b: [0.0, 0.02, 0.07, 0.01], nk: 1 };
        let (mut s, mut seed) = (Simulation::default(), 1u32);
        let (mut y, mut u) = ([0.0f64; 3], [0.0f64; 4]);
        for _ in 0..500 {
            seed = seed.wrapping_mul(1664525).wrapping_add(1013904223);
            let input = (seed >> 24) as f32;
            u = [f64::from(input), u[0], u[1], u[2]];
            let forced: f64 = model.b.iter().zip(u).map(|(b, u)| f64::from(*b) * u).sum();
            let free: f64 = model.a.iter().zip(y).map(|(a, y)| -f64::from(*a) * y).sum();
            y = [forced + free, y[0], y[1]];
            let output = f64::from(model.simulate(&mut s, input));
            assert!((output - y[0]).abs() < 1e-3, "{output} instead of {}", y[0]);
        }
        assert!(y[0] > 10.0, "the test has moved something");
    }

    /// A constant input ends at the static gain; an impulse has its centroid at the residence time.
    #[test]
    fn gain_and_residence_time_are_those_of_the_simulation() {
        let model = Transfer { a: [-0.8, 0.0, 0.0], b: [0.1, 0.2], nk: 1 };
        let (mut step, mut impulse) = (Simulation::default(), Simulation::default());
        let (mut last, mut area, mut moment) = (0.0, 0.0, 0.0);
        for k in 0..200u16 {
            last = model.simulate(&mut step, 1.0);
            let h = model.simulate(&mut impulse, f32::from(k == 0));
            area += h;
            moment += h * f32::from(k + 1); // the input was that of a sample ago
        }
        assert!((last - model.static_gain().unwrap()).abs() < 1e-4);
        assert!((moment / area - model.residence_time().unwrap()).abs() < 1e-3);
    }
}
