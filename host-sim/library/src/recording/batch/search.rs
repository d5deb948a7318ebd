//! The parameters that explain all samples best, and how each stretch began: Levenberg and Marquardt.
//!
//! ```text
//! sum of rho((y - model) / sigma) / kappa + priors -> least         rho: Huber's
//! ```
//!
//! kappa says of how many residuals there is one that is independent. What is left is linear in how a stretch began: these are taken out of the
//! normal equations stretch by stretch (Schur complement), so that a hundred stretches cost no more than one that is as long. Parameters and states are
//! counted in standard deviations of their priors.

use fdi_core::likelihood::Parameter;

use super::normal::{Normal, Reduced, Square, inverse};
use super::plant::{PARAMETERS, Pairs, Plant, STATES, State, Stretch, Theta};

/// Standard deviations of how a stretch begins, % and degC.
const STATE_SDS: State = [50.0, 50.0, 15.0, 50.0, 15.0, 1.0, 1.0];
/// A residual counts as the square of its size up to so many standard deviations.
const HUBER: f64 = 4.0;
/// Derivatives by differences over this share of a prior's standard deviation.
const DIFFERENCE: f64 = 1e-4;
/// First damping, by what it falls and grows, and where nothing gets better any more.
const DAMPING: f64 = 1e-3;
const LESS: f64 = 0.2;
const MORE: f64 = 5.0;
const MOST_DAMPING: f64 = 1e6;
/// How often what is left says anew what noise there is.
const NOISES: usize = 2;
/// It has converged where a step makes the sum less by no more than this share.
const CONVERGED: f64 = 1e-4;
/// No residual is taken for smaller in the mean, degC.
const LEAST_SIGMA: f64 = 1e-3;
/// Independent residuals are asked for by means of such a share of all.
const BLOCK: usize = 50;
const LEAST_BLOCK: usize = 10;

/// The weight of priors where the samples are asked alone.
const NEXT_TO_NOTHING: f64 = 1e-3;

/// What is fitted to what.
#[derive(Clone, Debug)]
pub(super) struct Search<'a> {
    /// The model.
    pub(super) plant: Plant<'a>,
    /// The samples.
    pub(super) stretches: &'a [Stretch],
    /// Mean and standard deviation of each parameter.
    pub(super) prior: Pairs,
    /// Within which each stays; one that is fixed has no room.
    pub(super) range: Pairs,
    /// T0 is measured.
    pub(super) t0: bool,
    /// A heater beside is known.
    pub(super) beside: bool,
    /// Spread of the residuals of T1 and T2, degC, and of how many one is independent.
    pub(super) sigma: [f64; 2],
    /// The same of their correlation.
    pub(super) kappa: [f64; 2],
}

/// Where it stands.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// The parameters.
    pub(super) theta: Theta,
    /// How each stretch begins.
    pub(super) starts: Vec<State>,
    /// What is to be least.
    pub(super) cost: f64,
}

impl Search<'_> {
    /// Whether a parameter is looked for.
    pub(super) fn moves(&self, which: usize) -> bool {
        let (low, high) = self.range[which];
        low < high
    }

    fn has_state(&self, stretch: usize, which: usize) -> bool {
        self.plant.has_state(which, self.beside, stretch == 0, self.t0)
    }

    /// What a stretch would begin with, if it had been at rest for long.
    fn at_rest(stretch: &Stretch, t2: bool) -> State {
        let (u, v) = (stretch[0].power, stretch[0].beside);
        [u, 0.0, 0.0, if t2 { 0.0 } else { v }, 0.0, 0.0, 0.0]
    }

    /// From some parameters, each stretch at rest.
    pub(super) fn begin(&self, theta: Theta) -> Point {
        let starts = self.stretches.iter().map(|stretch| Self::at_rest(stretch, self.plant.t2)).collect();
        self.judged(theta, starts)
    }

    /// The same point by what is known of the noise now.
    pub(super) fn judged(&self, theta: Theta, starts: Vec<State>) -> Point {
        let cost = self.cost(&theta, &starts);
        Point { theta, starts, cost }
    }

    fn cost(&self, theta: &Theta, starts: &[State]) -> f64 {
        let mut cost = 0.0;
        for (i, (mean, sd)) in self.prior.iter().enumerate().filter(|(i, _)| self.moves(*i)) {
            cost += ((theta[i] - mean) / sd).powi(2);
        }
        for (stretch, start) in self.stretches.iter().zip(starts) {
            let rest = Self::at_rest(stretch, self.plant.t2);
            cost += (0..STATES).map(|i| ((start[i] - rest[i]) / STATE_SDS[i]).powi(2)).sum::<f64>();
            let simulated = self.plant.simulate(theta, stretch, start);
            for (row, model) in stretch.iter().zip(&simulated) {
                for m in 0..2 {
                    let r = (row.y[m] - model[m]).abs() / self.sigma[m];
                    if r.is_finite() {
                        let rho = if r < HUBER { r * r } else { HUBER * (2.0 * r - HUBER) };
                        cost += rho / self.kappa[m];
                    }
                }
            }
        }
        cost
    }

    /// Residuals of each row; NaN where there is none.
    pub(super) fn residuals(&self, point: &Point) -> Vec<Vec<[f64; 2]>> {
        let parts = self.stretches.iter().zip(&point.starts);
        parts
            .map(|(stretch, start)| {
                let simulated = self.plant.simulate(&point.theta, stretch, start);
                let pairs = stretch.iter().zip(simulated);
                pairs.map(|(row, model)| [row.y[0] - model[0], row.y[1] - model[1]]).collect()
            })
            .collect()
    }

    /// Learns what noise there is, and gets better by that.
    pub(super) fn settle(&mut self, point: &mut Point, most: usize) {
        for _ in 0..NOISES {
            self.learn_noise(point);
            *point = self.descend(self.judged(point.theta, point.starts.clone()), most);
        }
    }

    /// Twice the logarithm of the likelihood ratio of two points, each with the noise that it leaves, by the independent residuals of the first.
    pub(super) fn explains_more(&self, point: &Point, other: &Point) -> f64 {
        let variances = |point: &Point| {
            let residuals = self.residuals(point);
            [0, 1].map(|m| {
                let limit = HUBER * self.sigma[m];
                let e = residuals.iter().flatten().map(|e| e[m]).filter(|e| e.is_finite());
                e.fold((0.0, 0.0), |(count, sum), e| (count + 1.0, sum + e.abs().min(limit).powi(2)))
            })
        };
        let pairs = variances(point).into_iter().zip(variances(other)).zip(self.kappa);
        let least = LEAST_SIGMA * LEAST_SIGMA;
        pairs
            .filter(|(((count, _), _), _)| *count > 0.0)
            .map(|(((count, a), (_, b)), kappa)| count / kappa * (a.max(least) / b.max(least)).ln())
            .sum()
    }

    /// What the residuals say of their noise.
    fn learn_noise(&mut self, point: &Point) {
        let residuals = self.residuals(point);
        for m in 0..2 {
            let e: Vec<f64> = residuals.iter().flatten().map(|e| e[m]).filter(|e| e.is_finite()).collect();
            if e.is_empty() {
                continue;
            }
            let mut sizes: Vec<f64> = e.iter().map(|e| e.abs()).collect();
            let middle = sizes.len() / 2;
            let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
            self.sigma[m] = (1.4826 * median).max(LEAST_SIGMA);
            let limit = HUBER * self.sigma[m];
            let e: Vec<f64> = e.iter().map(|e| e.clamp(-limit, limit)).collect();
            let block = (e.len() / BLOCK).max(LEAST_BLOCK);
            let square = |x: f64| x * x;
            let blocks = e.chunks_exact(block).map(|e| square(e.iter().sum::<f64>()) / block as f64);
            let count = (e.len() / block).max(1) as f64;
            let variance = e.iter().map(|e| e * e).sum::<f64>() / e.len() as f64;
            self.kappa[m] = (blocks.sum::<f64>() / count / variance).max(1.0);
        }
    }

    /// How the residuals change with each parameter and with each number of how a stretch begins.
    fn linearized(&self, point: &Point) -> Normal {
        let mut normal =
            Normal { matrix: [[0.0; PARAMETERS]; PARAMETERS], score: [0.0; PARAMETERS], parts: Vec::new() };
        for i in 0..PARAMETERS {
            let (mean, sd) = self.prior[i];
            normal.matrix[i][i] = 1.0;
            normal.score[i] = if self.moves(i) { (mean - point.theta[i]) / sd } else { 0.0 };
        }
        for (s, (stretch, start)) in self.stretches.iter().zip(&point.starts).enumerate() {
            let part = self.add(&mut normal, point, (s, stretch), start);
            normal.parts.push(part);
        }
        normal
    }

    fn add(
        &self,
        normal: &mut Normal,
        point: &Point,
        (s, stretch): (usize, &Stretch),
        start: &State,
    ) -> Reduced {
        let simulated = self.plant.simulate(&point.theta, stretch, start);
        let moving: Vec<usize> = (0..PARAMETERS).filter(|i| self.moves(*i)).collect();
        let states: Vec<usize> = (0..STATES).filter(|i| self.has_state(s, *i)).collect();
        let columns = self.columns(point, stretch, start, &simulated, (&moving, &states));
        let count = columns.len();
        let (sums, scores) = self.sums(stretch, &simulated, &columns);
        let at = |i: usize, j: usize| sums[i.max(j) * count + i.min(j)];
        for (a, &i) in moving.iter().enumerate() {
            normal.score[i] += scores[a];
            for (b, &j) in moving.iter().enumerate() {
                normal.matrix[i][j] += at(a, b);
            }
        }
        let rest = Self::at_rest(stretch, self.plant.t2);
        let (mut own, mut cross, mut score) =
            ([[0.0; STATES]; STATES], [[0.0; PARAMETERS]; STATES], [0.0; STATES]);
        (0..STATES).for_each(|i| own[i][i] = 1.0);
        for (a, &i) in states.iter().enumerate() {
            let a = a + moving.len();
            score[i] = scores[a] + (rest[i] - start[i]) / STATE_SDS[i];
            for (b, &j) in states.iter().enumerate() {
                own[i][j] += at(a, b + moving.len());
            }
            for (b, &j) in moving.iter().enumerate() {
                cross[i][j] = at(a, b);
            }
        }
        let inverse = inverse(own);
        let reduced = Reduced { inverse, cross, score };
        reduced.take_out_of(normal);
        reduced
    }

    /// What the residuals of a stretch would change by for each parameter that moves, in its unit, and for each free state, in its standard deviation.
    fn columns(
        &self,
        point: &Point,
        stretch: &Stretch,
        start: &State,
        simulated: &[[f64; 2]],
        (moving, states): (&[usize], &[usize]),
    ) -> Vec<Vec<[f64; 2]>> {
        let mut columns = Vec::new();
        for &i in moving {
            let (mut theta, sd) = (point.theta, self.prior[i].1);
            theta[i] += DIFFERENCE * sd;
            let mut column = self.plant.simulate(&theta, stretch, start);
            for (moved, was) in column.iter_mut().zip(simulated) {
                *moved = [0, 1].map(|m| (moved[m] - was[m]) / DIFFERENCE);
            }
            columns.push(column);
        }
        let mut by_state = self.plant.by_state(&point.theta, stretch);
        for &i in states {
            by_state[i].iter_mut().flatten().for_each(|x| *x *= STATE_SDS[i]);
            columns.push(std::mem::take(&mut by_state[i]));
        }
        columns
    }

    /// Products of the columns with each other, of which those at and below the diagonal count, and with the residuals; each weighed by Huber's rule.
    fn sums(
        &self,
        stretch: &Stretch,
        simulated: &[[f64; 2]],
        columns: &[Vec<[f64; 2]>],
    ) -> (Vec<f64>, Vec<f64>) {
        let count = columns.len();
        let (mut sums, mut scores) = (vec![0.0; count * count], vec![0.0; count]);
        let mut row = vec![0.0; count];
        for (k, sample) in stretch.iter().enumerate() {
            for m in 0..2 {
                let r = (sample.y[m] - simulated[k][m]) / self.sigma[m];
                if !r.is_finite() {
                    continue;
                }
                let weight = (HUBER / r.abs()).min(1.0) / self.kappa[m];
                for (x, column) in row.iter_mut().zip(columns) {
                    *x = column[k][m] / self.sigma[m];
                }
                for i in 0..count {
                    let x = weight * row[i];
                    scores[i] += x * r;
                    for (sum, other) in sums[i * count..].iter_mut().zip(&row[..=i]) {
                        *sum += x * other;
                    }
                }
            }
        }
        (sums, scores)
    }

    /// Gets better until nothing does, or as often as that.
    pub(super) fn descend(&self, mut point: Point, most: usize) -> Point {
        let mut damping = DAMPING;
        for _ in 0..most {
            let normal = self.linearized(&point);
            let before = point.cost;
            while damping < MOST_DAMPING {
                let next = self.stepped(&point, &normal, damping);
                if next.cost < point.cost {
                    point = next;
                    damping *= LESS;
                    break;
                }
                damping *= MORE;
            }
            if damping >= MOST_DAMPING || before - point.cost < CONVERGED * before {
                break;
            }
        }
        point
    }

    fn stepped(&self, point: &Point, normal: &Normal, damping: f64) -> Point {
        let mut matrix = normal.matrix;
        (0..PARAMETERS).for_each(|i| matrix[i][i] *= 1.0 + damping);
        let step = self.within(&point.theta, matrix, normal.score);
        let theta = std::array::from_fn(|i| {
            let ((low, high), sd) = (self.range[i], self.prior[i].1);
            (point.theta[i] + sd * step[i]).clamp(low, high)
        });
        let parts = normal.parts.iter().zip(&point.starts);
        let starts = parts.map(|(part, start)| {
            let left: State = std::array::from_fn(|i| {
                part.score[i] - (0..PARAMETERS).map(|p| part.cross[i][p] * step[p]).sum::<f64>()
            });
            std::array::from_fn(|i| {
                start[i] + STATE_SDS[i] * (0..STATES).map(|j| part.inverse[i][j] * left[j]).sum::<f64>()
            })
        });
        self.judged(theta, starts.collect())
    }

    /// The step, in standard deviations of the priors, that does not leave the ranges. What would leave its own goes to its end, and the others are asked
    /// again: cut off alone, it would leave the others on their way to somewhere else.
    fn within(&self, theta: &Theta, mut matrix: Square<PARAMETERS>, mut score: Theta) -> Theta {
        let mut is_at_its_end = [false; PARAMETERS];
        loop {
            let inverse = inverse(matrix);
            let step: Theta =
                std::array::from_fn(|i| (0..PARAMETERS).map(|j| inverse[i][j] * score[j]).sum());
            let ends_at = |i: usize| theta[i] + self.prior[i].1 * step[i];
            let leaves = |i: &usize| {
                let (low, high) = self.range[*i];
                !is_at_its_end[*i] && !(low..=high).contains(&ends_at(*i))
            };
            let Some(i) = (0..PARAMETERS).find(leaves) else { return step };
            is_at_its_end[i] = true;
            let (low, high) = self.range[i];
            let room = (ends_at(i).clamp(low, high) - theta[i]) / self.prior[i].1;
            for j in (0..PARAMETERS).filter(|j| *j != i) {
                score[j] -= matrix[j][i] * room;
                [matrix[i][j], matrix[j][i]] = [0.0; 2];
            }
            (matrix[i][i], score[i]) = (1.0, room);
        }
    }

    /// Covariance of the parameters, in standard deviations of their priors; and what it would be if these counted for next to nothing, but for that of
    /// the curvature: power that is full or off tells nothing of what is between, and need not.
    pub(super) fn covariances(&self, point: &Point) -> [Square<PARAMETERS>; 2] {
        let matrix = self.linearized(point).matrix;
        let mut alone = matrix;
        let asked = |i: &usize| self.moves(*i) && *i != Parameter::Curvature as usize;
        (0..PARAMETERS).filter(asked).for_each(|i| alone[i][i] -= 1.0 - NEXT_TO_NOTHING);
        [matrix, alone].map(inverse)
    }
}
