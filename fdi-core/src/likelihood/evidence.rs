//! How well does a hypothesis explain the residuals, when everything else may have moved a little, too?
//!
//! The whitened residuals are `z = sum theta_i phi_i + noise`. Nuisances have narrow priors N(0, d_i), what a hypothesis frees a wide
//! one, and all are integrated out. With A and b from [`Normal`], both divided by kappa:
//!
//! ```text
//! log evidence = b' (A + D^-1)^-1 b / 2 - log det(I + D A) / 2
//! ```
//!
//! The nuisances' part is factored once, and what they share with all regressors is taken out of A and b (a Schur complement). What is left
//! is the information s of each direction beyond the nuisances, and its score r. Freeing one parameter with the prior N(0, v) gains
//!
//! ```text
//! r^2 / 2 (s + 1/v) - log(1 + v s) / 2
//! ```
//!
//! D is diagonal but for the offsets, which T0's error ties (units.rs).
//!
//! It is a bank of Kalman filters with Schmidt's nuisances in information form (S. F. Schmidt 1966; Bayesian linear regression). kappa is
//! above one, since residuals are never as independent as the sums take them for.

mod beyond;
mod units;

use super::cholesky::Cholesky;
use super::hypothesis::{Pairs, model_errors, nuisances_since_onset, nuisances_since_training};
use super::normal::{Normal, Sums};
use super::regressor::{Direction, FIRST_FREED, FREED};
use super::tuning::NuisanceTuning;
use crate::vector::dot;
pub(super) use beyond::Beyond;
use units::{Tie, Unit, untied};

/// So many nuisances besides T0's are in the longest list: their cost grows with the square of this.
pub(super) const MOST: usize = {
    let t = &NuisanceTuning::DEFAULT;
    let lengths =
        [nuisances_since_onset(t).len(), nuisances_since_training(t).len(), model_errors(t).len() + 1];
    let longest = if lengths[0] > lengths[1] { lengths[0] } else { lengths[1] };
    (if longest > lengths[2] { longest } else { lengths[2] }) - 1
};

/// Regressors that are solved for at once: as many sums as there are registers for.
const AT_ONCE: usize = 8;
const _: () = assert!(FREED.is_multiple_of(AT_ONCE), "those of the last block would not be solved for");

/// A nuisance: what may move without being a fault, and its standard deviation.
pub(super) type Nuisance = (Direction, f32);

/// The residuals as the nuisances explain them.
pub(super) struct Nuisances<'a> {
    sums: Sums<'a>,
    list: &'a [Nuisance],
    inv_kappa: f32,
    units: [Unit; MOST],
    tie: Tie,
    /// Of I + D A D.
    factor: Cholesky<MOST>,
    /// `L^-1` times the scaled b.
    score: [f32; MOST],
    /// What the nuisances alone take from the residual sum of squares.
    pub(super) explained: f32,
}

/// What a hypothesis frees: the direction, with mean and standard deviation of its prior.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prior {
    pub(super) direction: Direction,
    pub(super) mean: f32,
    pub(super) sd: f32,
}

/// What comes of freeing one or two.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Estimate {
    /// By how much the log evidence exceeds that of the nuisances alone.
    pub(super) gain: f32,
    /// The first parameter: posterior mean and variance. The second's mean.
    pub(super) value: f32,
    pub(super) variance: f32,
    pub(super) second: f32,
}

impl<'a> Nuisances<'a> {
    /// Inlined, so that it is built where it stays: a copy would cost as much as to work it out.
    #[inline(always)]
    pub(super) fn new(sums: Sums<'a>, list: &'a [Nuisance], kappa: f32) -> Self {
        let mut new = Self {
            sums,
            list,
            inv_kappa: 1.0 / kappa,
            units: [Unit { regressor: 0, by: 0.0 }; MOST],
            tie: Tie::default(),
            factor: Cholesky::NOTHING,
            score: [0.0; MOST],
            explained: 0.0,
        };
        new.tie = untied(list, &mut new.units);
        new.solve(kappa);
        new
    }

    #[inline(never)]
    fn solve(&mut self, kappa: f32) {
        let (sums, rows) = (self.sums, self.factor.rows());
        for (k, (p, row)) in self.units.iter().zip(rows.iter_mut()).enumerate() {
            let (scale, own) = (p.by * self.inv_kappa, sums.row(p.regressor));
            for (q, element) in self.units.iter().zip(row.iter_mut()).take(k + 1) {
                // What stands before it in the list stands before it in its row.
                let a = own.get(q.regressor).copied();
                *element = scale * q.by * a.unwrap_or_else(|| sums.a(p.regressor, q.regressor));
            }
            self.score[k] = scale * sums.b(p.regressor);
        }
        self.tie.tie_half(rows);
        self.tie.tie(&mut self.score);
        rows.iter_mut().enumerate().for_each(|(k, row)| row[k] += 1.0);
        self.factor.factor();
        self.factor.forward(&mut self.score);
        self.explained = kappa * dot(&self.score, &self.score);
    }

    /// What regressors hold beyond the nuisances, of these pairs: [`Pairs`](super::hypothesis::Pairs). Inlined for the same reason.
    #[inline(always)]
    pub(super) fn beyond(&self, pairs: &Pairs) -> Beyond {
        let mut beyond = Beyond { narrow: [0.0; Direction::COUNT], left: Normal::NOTHING };
        self.leave(pairs, &mut beyond);
        beyond
    }

    #[inline(never)]
    fn leave(&self, pairs: &Pairs, beyond: &mut Beyond) {
        self.list.iter().for_each(|(direction, sd)| beyond.narrow[direction.place()] = *sd);
        // What each nuisance shares with each regressor that can be freed.
        let mut shared = [[0.0; FREED]; MOST];
        for (unit, shared) in self.units.iter().zip(&mut shared) {
            self.sums.add_freed(unit.regressor, unit.by * self.inv_kappa, shared);
        }
        self.tie.tie_rows(&mut shared);
        let of_freed = self.sums.regressors().saturating_sub(FIRST_FREED);
        self.factor.forward_all::<AT_ONCE, FREED>(&mut shared, of_freed);
        self.subtract(&shared, pairs, &mut beyond.left);
    }

    /// The sums less what the nuisances share with them: of these pairs only, row by row the bits of the columns.
    #[inline(never)]
    fn subtract(&self, shared: &[[f32; FREED]; MOST], pairs: &Pairs, left: &mut Normal) {
        let column = |i: usize| -> [f32; MOST] { core::array::from_fn(|k| shared[k][i.min(FREED - 1)]) };
        for (i, &pairs) in pairs.iter().skip(FIRST_FREED).take(FREED).enumerate() {
            if pairs == 0 {
                continue;
            }
            let (own, regressor) = (column(i), FIRST_FREED + i);
            left.b[regressor] = self.inv_kappa * self.sums.b(regressor) - dot(&own, &self.score);
            let mut asked = (pairs & ((2 << regressor) - 1)) >> FIRST_FREED;
            while asked != 0 {
                let j = asked.trailing_zeros() as usize;
                asked &= asked - 1;
                let all = self.sums.a(regressor, FIRST_FREED + j);
                left.put(regressor, FIRST_FREED + j, self.inv_kappa * all - dot(&own, &column(j)));
            }
        }
    }

    /// What the nuisances are thought to be, but for T0's, with which the offsets are thought to be.
    pub(super) fn values(&self) -> [f32; MOST] {
        let mut units = self.score;
        self.factor.backward(&mut units);
        self.tie.untie(&mut units);
        core::array::from_fn(|k| self.units[k].by * units[k])
    }
}

/// phi_p' phi_q, summed.
#[inline]
fn between(sums: Sums, p: Direction, q: Direction) -> f32 {
    match (p, q) {
        (Direction::Of(p), Direction::Of(q)) => sums.a(p as usize, q as usize),
        _ => between_several(sums, p, q),
    }
}

#[inline(never)]
fn between_several(sums: Sums, p: Direction, q: Direction) -> f32 {
    let ([i, j], [u, v]) = (p.regressors(), p.weights());
    let along = |regressor| u * sums.a(i, regressor) + v * sums.a(j, regressor);
    q.moves().map(|(regressor, weight)| weight * along(regressor)).sum()
}

/// b along a direction.
#[inline]
fn along(sums: Sums, p: Direction) -> f32 {
    let ([i, j], [u, v]) = (p.regressors(), p.weights());
    u * sums.b(i) + v * sums.b(j)
}

#[cfg(test)]
mod tests;
