//! A Kalman filter of the bank.

pub(super) const STATES: usize = 7;
pub(super) const CONSTANT: usize = 6;
pub(super) type Vector = [f64; STATES];
pub(super) type Matrix = [Vector; STATES];

/// One, and how well it does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filter {
    pub(super) state: Vector,
    pub(super) covariance: Matrix,
    /// Evidence of late, a logarithm.
    pub(super) evidence: f64,
    /// Log odds of "as trained" against it, since that is likelier than "disturbed".
    pub(super) behind: f64,
}

impl Filter {
    pub(super) fn predict(&mut self, matrix: &Matrix, added: [f64; 3], comes: &Vector) {
        let mut half = [[0.0; STATES]; STATES];
        for (half, row) in half.iter_mut().zip(matrix) {
            for (share, row) in row.iter().zip(&self.covariance).filter(|(share, _)| **share != 0.0) {
                half.iter_mut().zip(row).for_each(|(sum, x)| *sum += share * x);
            }
        }
        self.state = matrix.map(|row| product(&row, &self.state));
        self.state.iter_mut().zip(added).for_each(|(x, added)| *x += added);
        for (i, (row, half)) in self.covariance.iter_mut().zip(&half).enumerate() {
            row.iter_mut().zip(matrix).for_each(|(x, of)| *x = product(half, of));
            row[i] += comes[i];
        }
    }

    /// Takes a measurement in; the logarithm of how likely it was.
    pub(super) fn correct(&mut self, output: &Vector, e: f64, clip: f64) -> f64 {
        let along = self.covariance.map(|row| product(&row, output));
        let variance = product(output, &along).max(1e-12);
        let innovation = e - product(output, &self.state);
        for ((x, row), along_x) in self.state.iter_mut().zip(&mut self.covariance).zip(along) {
            *x += along_x * innovation / variance;
            row.iter_mut().zip(along).for_each(|(cell, along)| *cell -= along_x * along / variance);
        }
        -0.5 * ((innovation * innovation / variance).min(clip * clip) + libm::log(variance))
    }
}

fn product(a: &Vector, b: &Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
