//! Whitening of both residuals together: what is left of each when that which follows from the past, and of y2's from y1's
//! as well, is taken away, in standard deviations.
//!
//! ```text
//! z1 = (e1 - sum a_i e1[k-i]) / s1                                i = 1..3
//! z2 = (e2 - sum b_i e2[k-i] - sum c_j e1[k-j]) / s2              i = 1..3, j = 0..4
//! ```
//!
//! z1 and z2 are white and, since z2 knows e1, uncorrelated: their squares add up to a likelihood. A T2 that disagrees with T1 shows
//! in z2 alone.

use super::cholesky::Cholesky;
use super::tuning::WhiteningTuning;
use super::verdict::RejectReason;
use crate::bounds::{bounded, larger};
use crate::root::sqrt;
use crate::vector::{dot, shift};

/// Orders: of e1 and e2 on themselves, and of e2 on e1 from this tick on. Chosen on the reference rig (docs/diagnosis.md, section 3).
const OWN: usize = 3;
const OTHER: usize = 5;
const ALL: usize = OWN + OTHER;
/// Ticks that are remembered, this one among them.
pub(super) const REMEMBERS: usize = OTHER;
/// The noise model of both residuals.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WhiteningFilter {
    own1: [f32; OWN],
    own2: [f32; OWN],
    other: [f32; OTHER],
    /// Standard deviations of the innovations, degC, and their inverses.
    pub(super) sigma: [f32; 2],
    pub(super) inv_sigma: [f32; 2],
}

/// Past values of both, newest first, degC.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Past {
    e1: [f32; OTHER - 1],
    e2: [f32; OWN],
}

impl Past {
    /// As if every value had been lower by `change`.
    pub(super) fn lower(&mut self, change: [f32; 2]) {
        self.e1.iter_mut().for_each(|e| *e -= change[0]);
        self.e2.iter_mut().for_each(|e| *e -= change[1]);
    }
}

impl WhiteningFilter {
    /// That of e1 alone: whatever e2 is counts for nothing.
    fn of_t1(t: &WhiteningTuning, own1: [f32; OWN], variance: f32) -> Result<Self, RejectReason> {
        let sigma = larger(t.least_sigma, sqrt(variance));
        let finite = sigma.is_finite() && own1.iter().all(|x| x.is_finite());
        let whitening = Self { own1, sigma: [sigma, 0.0], inv_sigma: [1.0 / sigma, 0.0], ..Self::default() };
        finite.then_some(whitening).ok_or(RejectReason::PoorFit)
    }

    /// Innovations of several signals, put where they are to stand: the filter is loaded once for all of them.
    #[inline(never)]
    pub(super) fn step_all<const N: usize>(
        &self,
        past: &mut [Past; N],
        signals: &[[f32; 2]; N],
        innovations: &mut [[f32; 2]; N],
    ) {
        for i in 0..N {
            innovations[i] = self.innovations(&mut past[i], signals[i]);
        }
    }

    /// Innovations of a tick, in standard deviations.
    #[inline(never)]
    pub(super) fn step(&self, past: &mut Past, e: [f32; 2]) -> [f32; 2] {
        self.innovations(past, e)
    }

    #[inline(always)]
    fn innovations(&self, past: &mut Past, e: [f32; 2]) -> [f32; 2] {
        let expected = self.expected(past, e[0]);
        shift(&mut past.e1, e[0]);
        shift(&mut past.e2, e[1]);
        [(e[0] - expected[0]) * self.inv_sigma[0], (e[1] - expected[1]) * self.inv_sigma[1]]
    }

    /// The same for charts: an innovation counts and is remembered only up to `limit` standard deviations, so that a single outlier leaves
    /// no echo.
    #[inline(never)]
    pub(super) fn step_clipped(&self, past: &mut Past, e: [f32; 2], limit: [f32; 2]) -> [f32; 2] {
        let mut z = [0.0; 2];
        let mut kept = [0.0; 2];
        for m in 0..2 {
            let expected = self.expected(past, kept[0])[m];
            z[m] = bounded((e[m] - expected) * self.inv_sigma[m], -limit[m], limit[m]);
            kept[m] = expected + z[m] * self.sigma[m];
        }
        shift(&mut past.e1, kept[0]);
        shift(&mut past.e2, kept[1]);
        z
    }

    /// The noise model of e1 alone: shares of its past values, newest first, and the standard deviation of the innovations, degC.
    pub(super) fn of_e1(&self) -> ([f32; OWN], f32) {
        (self.own1, self.sigma[0])
    }

    /// What is left of a constant residual of either by itself, as a share.
    pub(super) fn dc_gain(&self) -> [f32; 2] {
        [1.0 - self.own1.iter().sum::<f32>(), 1.0 - self.own2.iter().sum::<f32>()]
    }

    /// What the past lets expect; of e2 with e1 of this tick.
    #[inline(always)]
    pub(super) fn expected(&self, past: &Past, e1: f32) -> [f32; 2] {
        let [p1, p2, p3, p4] = past.e1;
        let of_e1 = dot(&self.own1, &[p1, p2, p3]);
        let of_e2 = dot(&self.own2, &past.e2) + dot(&self.other, &[e1, p1, p2, p3, p4]);
        [of_e1, of_e2]
    }
}

/// Sums over both residuals and the outputs that they belong to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ResidualStatistics {
    pub(super) count: f32,
    sum: [f32; 2],
    /// e1 e1[k-j] and e2 e2[k-i].
    own1: [f32; OTHER],
    own2: [f32; OWN + 1],
    /// e2 e1[k-d], d from 0, and e1 e2[k-d], d from 1.
    ahead: [f32; OTHER],
    behind: [f32; OWN],
    past: Past,
    first: [f32; 2],
    departure: [f32; 2],
    departure_squares: [f32; 2],
}

impl ResidualStatistics {
    /// Residuals and outputs of a tick, degC.
    #[inline(never)]
    pub(super) fn push(&mut self, e: [f32; 2], y: [f32; 2]) {
        if self.count == 0.0 {
            self.first = y;
        }
        self.count += 1.0;
        for m in 0..2 {
            let departure = y[m] - self.first[m];
            self.departure[m] += departure;
            self.departure_squares[m] += departure * departure;
            self.sum[m] += e[m];
        }
        let Past { e1, e2 } = self.past;
        self.own1[0] += e[0] * e[0];
        self.own2[0] += e[1] * e[1];
        self.ahead[0] += e[1] * e[0];
        for j in 1..OTHER {
            self.own1[j] += e[0] * e1[j - 1];
            self.ahead[j] += e[1] * e1[j - 1];
        }
        for i in 1..=OWN {
            self.own2[i] += e[1] * e2[i - 1];
            self.behind[i - 1] += e[0] * e2[i - 1];
        }
        shift(&mut self.past.e1, e[0]);
        shift(&mut self.past.e2, e[1]);
    }

    /// Means of the residuals, degC.
    pub(super) fn mean(&self) -> [f32; 2] {
        self.sum.map(|sum| sum / larger(1.0, self.count))
    }

    /// Mean of an output, degC.
    pub(super) fn level(&self, m: usize) -> f32 {
        self.first[m] + self.departure[m] / larger(1.0, self.count)
    }

    /// The noise model of `channels` residuals, or why it can't be trusted. With one, what is said of T2 says nothing.
    pub(super) fn finish(
        &self,
        t: &WhiteningTuning,
        channels: usize,
    ) -> Result<WhiteningFilter, RejectReason> {
        let n = larger(1.0, self.count);
        let [m1, m2] = self.mean();
        let own1 = self.own1.map(|sum| sum / n - m1 * m1);
        let own2 = self.own2.map(|sum| sum / n - m2 * m2);
        let ahead = self.ahead.map(|sum| sum / n - m1 * m2);
        let behind = self.behind.map(|sum| sum / n - m1 * m2);
        for (m, variance) in [own1[0], own2[0]].into_iter().take(channels).enumerate() {
            let departure = self.departure[m] / n;
            let output = self.departure_squares[m] / n - departure * departure;
            let small = t.small * self.level(m);
            if !(variance < larger(t.largest_unexplained * output, small * small)) {
                return Err(RejectReason::PoorFit);
            }
        }
        let mut rows = [[0.0; ALL]; ALL];
        fill(&mut rows, 0, OWN, &own1);
        let ([c1, c2, c3, ..], variance1) =
            regression(t, rows, [own1[1], own1[2], own1[3], 0.0, 0.0, 0.0, 0.0, 0.0], own1[0]);
        let c1 = [c1, c2, c3];
        if channels < 2 {
            return WhiteningFilter::of_t1(t, c1, variance1);
        }
        let mut rows = [[0.0; ALL]; ALL];
        fill(&mut rows, 0, OWN, &own2);
        fill(&mut rows, OWN, OTHER, &own1);
        for j in 0..OTHER {
            for i in 0..OWN {
                // e1[k-j] with e2[k-1-i]
                rows[OWN + j][i] = if j > i { ahead[j - i - 1] } else { behind[i - j] };
            }
        }
        let [a0, a1, a2, a3, a4] = ahead;
        let (c2, variance2) = regression(t, rows, [own2[1], own2[2], own2[3], a0, a1, a2, a3, a4], own2[0]);
        let sigma = [variance1, variance2].map(|variance| larger(t.least_sigma, sqrt(variance)));
        if !sigma.iter().chain(&c1).chain(&c2).all(|x| x.is_finite()) {
            return Err(RejectReason::PoorFit);
        }
        Ok(WhiteningFilter {
            own1: c1,
            own2: [c2[0], c2[1], c2[2]],
            other: [c2[3], c2[4], c2[5], c2[6], c2[7]],
            sigma,
            inv_sigma: sigma.map(|sigma| 1.0 / sigma),
        })
    }
}

/// Writes covariances by their lag into the lower half of a block on the diagonal. With iterators, since an optimiser for size
/// can't tell that these indices are within bounds.
fn fill(rows: &mut [[f32; ALL]; ALL], from: usize, size: usize, by_lag: &[f32]) {
    for (i, row) in rows.iter_mut().skip(from).take(size).enumerate() {
        let block = row.iter_mut().skip(from).take(i + 1).rev();
        block.zip(by_lag).for_each(|(element, covariance)| *element = *covariance);
    }
}

/// Coefficients of a linear regression from covariances, and the variance that it leaves. Where there are none, the coefficient is 0.
#[inline(never)]
fn regression(
    t: &WhiteningTuning,
    mut rows: [[f32; ALL]; ALL],
    cross: [f32; ALL],
    variance: f32,
) -> ([f32; ALL], f32) {
    (0..ALL).for_each(|i| rows[i][i] *= t.ridge);
    let factor = Cholesky::new(rows);
    let mut c = cross;
    factor.forward(&mut c);
    factor.backward(&mut c);
    (c, variance - dot(&c, &cross))
}

#[cfg(test)]
mod tests;
