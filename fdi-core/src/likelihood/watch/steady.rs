//! What has changed since training, however slowly: the same regression over a minute, held against the trained state.
//!
//! In closed loop the power follows a fault while T1 stays, so that a slow residual regresses on the model's own output. Two bands are
//! therefore kept apart: what is faster than some seconds is gathered in the sums; what is slower counts as two more measurements, the
//! means of both residuals.

use crate::bounds::{bounded, larger, smaller};
use crate::filter::LowPass;
use crate::likelihood::evidence::{Estimate, Nuisance, Nuisances};
use crate::likelihood::hypothesis::{self, IMPOSSIBLE, LASTING_PAIRS};
use crate::likelihood::inputs::Inputs;
use crate::likelihood::normal::LastingNormal;
use crate::likelihood::regressor::{LASTING, Regressors};
use crate::likelihood::tuning::Tuned;
use crate::vector::sum;

/// Its memories.
#[derive(Clone, Copy, Debug)]
pub(super) struct SteadyConstants {
    /// Of the fast band's sums, a share that is kept; of the split into bands; of the means.
    pub(super) keep: f32,
    /// Ticks over which the fast band learns where the model is wrong.
    pub(super) reference: u32,
    pub(super) split: LowPass,
    pub(super) mean: LowPass,
}

/// The memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steady {
    slow: Regressors<LASTING>,
    slow_z: [f32; 2],
    mean: Regressors<LASTING>,
    mean_e: [f32; 2],
    /// Of the gain's error as far from the trained power as the rig has been within the memory of these means: its mean square as a share, and
    /// that of the offset of T1 that comes of it, degC.
    curvature: [f32; 2],
    normal: LastingNormal,
    /// What the fast band seems to have changed by while nothing had: where the model is wrong.
    reference: [f32; LASTING],
    referred: bool,
    /// Means of the residuals that count as trained, degC, and whether they are to be taken anew.
    base: [f32; 2],
    rebasing: bool,
    ticks: u32,
    tuning: Tuned,
}

impl Steady {
    pub(super) fn new(tuning: Tuned) -> Self {
        Self {
            slow: [[0.0; 2]; LASTING],
            slow_z: [0.0; 2],
            mean: [[0.0; 2]; LASTING],
            mean_e: [0.0; 2],
            curvature: [0.0; 2],
            normal: LastingNormal::default(),
            reference: [0.0; LASTING],
            referred: false,
            base: [0.0; 2],
            rebasing: false,
            ticks: 0,
            tuning,
        }
    }

    /// Begins anew.
    pub(super) fn resume(&mut self) {
        *self = Self { base: self.base, ..Self::new(self.tuning) };
    }

    /// Gathers a tick: regressors and residuals, plain and whitened. The gain's error is `curvature` now, its mean
    /// square as a share and that of the offset of T1 that comes of it, degC; gives what it may be in what is gathered.
    #[inline(never)]
    pub(super) fn gather(
        &mut self,
        c: &SteadyConstants,
        regressors: &Regressors<LASTING>,
        whitened: &Regressors<LASTING>,
        e: [f32; 2],
        z: [f32; 2],
        curvature: [f32; 2],
    ) -> [f32; 2] {
        let (clip, jump) = (self.tuning.since_training.clip, self.tuning.since_training.jump);
        if self.ticks == 0 {
            // A step would be in the fast band for seconds, and look as if something answered less or more.
            self.mean = *regressors;
            self.slow = *whitened;
            self.slow_z = z;
            self.curvature = [0.0; 2];
        }
        for (gathered, now) in self.curvature.iter_mut().zip(curvature) {
            c.mean.follow(gathered, now);
            *gathered = larger(*gathered, now);
        }
        self.ticks = self.ticks.saturating_add(1);
        let weight = smaller(1.0, clip / (z[0].abs() + 1e-6)) * smaller(1.0, clip / (z[1].abs() + 1e-6));
        let mut fast = [[0.0; 2]; LASTING];
        let mut fast_z = z;
        for m in 0..2 {
            let slow = self.slow_z[m];
            fast_z[m] = bounded(z[m], slow - clip, slow + clip);
            c.split.follow(&mut self.slow_z[m], fast_z[m]);
            fast_z[m] -= self.slow_z[m];
            let mean = self.mean_e[m];
            c.mean.follow(&mut self.mean_e[m], bounded(e[m], mean - jump, mean + jump));
        }
        for i in 0..LASTING {
            for m in 0..2 {
                c.split.follow(&mut self.slow[i][m], whitened[i][m]);
                fast[i][m] = whitened[i][m] - self.slow[i][m];
                c.mean.follow(&mut self.mean[i][m], regressors[i][m]);
            }
        }
        let keep = if self.referred { c.keep } else { 1.0 };
        self.normal.add(keep, &fast, fast_z, weight);
        if !self.referred && self.ticks >= c.reference {
            self.refer();
        }
        self.curvature
    }

    /// What the fast band says now is what it says without a fault.
    fn refer(&mut self) {
        self.referred = true;
        if self.rebasing {
            self.base = self.mean_e;
            self.rebasing = false;
        }
        let errors = hypothesis::model_errors(&self.tuning.nuisances);
        let nuisances = Nuisances::new(self.normal.sums(), &errors, self.tuning.since_training.kappa);
        let values = nuisances.values();
        for ((direction, _), value) in errors.iter().zip(values) {
            self.reference[direction.regressors()[0] % LASTING] = value;
        }
        self.normal = LastingNormal::default();
        self.ticks = 0;
    }

    /// The rig was changed on purpose: what it is from now on counts as trained.
    pub(super) fn rebase(&mut self) {
        self.normal = LastingNormal::default();
        self.ticks = 0;
        self.referred = false;
        self.rebasing = true;
    }

    /// What was gathered is of a state that is over: residuals are `mean` now, degC.
    pub(super) fn forget(&mut self, mean: [f32; 2]) {
        self.normal = LastingNormal::default();
        self.mean_e = mean;
        self.ticks = 0;
    }

    /// Finite as long as all of it is that stays.
    pub(super) fn sum(&self) -> f32 {
        let regressors = sum(self.slow.as_flattened()) + sum(self.mean.as_flattened()) + sum(&self.reference);
        let residuals = sum(&self.slow_z) + sum(&self.mean_e) + sum(&self.base);
        regressors + residuals + sum(&self.curvature) + self.normal.sum()
    }

    /// Whether there is anything to judge by.
    pub(super) fn is_ready(&self, first: f32) -> bool {
        self.referred
            && self.ticks.is_multiple_of(self.tuning.since_training.every as u32)
            && self.ticks as f32 >= first
    }

    /// The gains of all lasting hypotheses. The size of the best is estimated again, from the means above all.
    #[inline(never)]
    pub(super) fn judge(
        &self,
        nuisances: &[Nuisance],
        estimate: &mut [Estimate; hypothesis::COUNT],
        inputs: Inputs,
    ) {
        let both = self.with_means(1.0, inputs);
        let beyond =
            Nuisances::new(both.sums(), nuisances, self.tuning.since_training.kappa).beyond(&LASTING_PAIRS);
        for (estimate, hypothesis) in estimate.iter_mut().zip(self.tuning.hypotheses()) {
            *estimate = Estimate { gain: IMPOSSIBLE, ..Estimate::default() };
            if hypothesis.lasting && inputs.tell(hypothesis.class) {
                *estimate = hypothesis.judged(beyond.estimate(hypothesis.first, None));
            }
        }
    }

    /// The size of a hypothesis, from the means above all.
    #[inline(never)]
    pub(super) fn size(&self, nuisances: &[Nuisance], h: usize, inputs: Inputs) -> Estimate {
        let mostly_means = self.with_means(self.tuning.since_training.fast_in_size, inputs);
        let hypothesis = &self.tuning.hypotheses()[h % hypothesis::COUNT];
        Nuisances::new(mostly_means.sums(), nuisances, self.tuning.since_training.kappa)
            .beyond(&LASTING_PAIRS)
            .estimate(hypothesis.first, None)
    }

    /// The sums with the means as two more measurements, and a share of the fast band.
    fn with_means(&self, fast: f32, inputs: Inputs) -> LastingNormal {
        let mut normal = self.normal;
        normal.explain(&self.reference);
        let e = [self.mean_e[0] - self.base[0], self.mean_e[1] - self.base[1]];
        let t = &self.tuning.since_training;
        let mut mean = self.mean;
        if !inputs.t2 {
            mean.iter_mut().for_each(|regressor| regressor[1] = 0.0);
        }
        normal.add(fast, &mean, e, t.kappa / (t.mean_sd * t.mean_sd));
        normal
    }
}

#[cfg(test)]
impl Steady {
    /// A place of the memory that a bit may flip in.
    pub(super) fn places(&mut self) -> [&mut f32; 1] {
        [&mut self.mean_e[1]]
    }
}

#[cfg(test)]
mod tests;
