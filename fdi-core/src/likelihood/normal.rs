//! Sums of a linear regression: whitened residuals on whitened signatures, `A = sum phi phi'`, `b = sum phi z`.

use super::column::{COUNT, Row};

/// Elements of the lower half of a symmetric matrix.
const HALF: usize = COUNT * (COUNT + 1) / 2;

/// The sums.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normal {
    a: [f32; HALF],
    pub(super) b: [f32; COUNT],
    /// sum z z, and of how many z.
    pub(super) energy: f32,
    pub(super) count: f32,
}

impl Default for Normal {
    fn default() -> Self {
        Self { a: [0.0; HALF], b: [0.0; COUNT], energy: 0.0, count: 0.0 }
    }
}

impl Normal {
    /// A tick: residuals and signatures, whitened, with a weight.
    #[inline(never)]
    pub(super) fn add(&mut self, row: &Row, z: [f32; 2], weight: f32) {
        let mut place = self.a.iter_mut();
        for (i, phi) in row.iter().enumerate() {
            let weighted = [weight * phi[0], weight * phi[1]];
            self.b[i] += weighted[0] * z[0] + weighted[1] * z[1];
            for (other, a) in row[..=i].iter().zip(&mut place) {
                *a += weighted[0] * other[0] + weighted[1] * other[1];
            }
        }
        self.energy += weight * (z[0] * z[0] + z[1] * z[1]);
        self.count += 2.0 * weight;
    }

    /// All sums, `factor` times as much.
    #[inline(never)]
    pub(super) fn scale(&mut self, factor: f32) {
        self.a.iter_mut().chain(&mut self.b).for_each(|sum| *sum *= factor);
        self.energy *= factor;
        self.count *= factor;
    }

    /// Takes away what these values of all columns explain.
    pub(super) fn explain(&mut self, values: &[f32; COUNT]) {
        for i in 0..COUNT {
            let explained: f32 = (0..COUNT).map(|j| self.a(i, j) * values[j]).sum();
            self.b[i] -= explained;
        }
    }

    /// Forgets some columns wholly.
    pub(super) fn forget(&mut self, columns: core::ops::Range<usize>) {
        let mut place = self.a.iter_mut();
        for i in 0..COUNT {
            for (j, a) in (0..=i).zip(&mut place) {
                if columns.contains(&i) || columns.contains(&j) {
                    *a = 0.0;
                }
            }
            if columns.contains(&i) {
                self.b[i] = 0.0;
            }
        }
    }

    /// sum phi_i phi_j
    #[inline]
    pub(super) fn a(&self, i: usize, j: usize) -> f32 {
        let (i, j) = if i > j { (i, j) } else { (j, i) };
        self.a.get(i * (i + 1) / 2 + j).copied().unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests;
