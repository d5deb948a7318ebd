//! What is new on a tick: residuals and regressors, whitened by the noise that was learnt.

use crate::likelihood::onset::REMEMBERED;
use crate::likelihood::regressor::{LASTING, Regressors};
use crate::likelihood::tuning::Tuned;
use crate::likelihood::whitening::{Past, WhiteningFilter};

/// The memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct InnovationsState {
    filter: WhiteningFilter,
    /// Of what the tracker leaves, and of the same clipped; of the residuals since training, and of their regressors.
    past: Past,
    past_clipped: Past,
    past_trained: Past,
    past_regressors: [Past; LASTING],
    /// Ticks so far; saturates.
    ticks: u32,
    tuning: Tuned,
}

/// The innovations of a tick, standard deviations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Innovations {
    /// Of what the tracker leaves, and the same for the charts: a spike counts only up to a limit.
    pub(super) z: [f32; 2],
    pub(super) clipped: [f32; 2],
    /// Of the residuals since training.
    pub(super) z_trained: [f32; 2],
    /// The filter has forgotten how it began: there are charts, and later there is something to gather.
    pub(super) charted: bool,
    pub(super) gathered: bool,
}

impl InnovationsState {
    pub(super) fn new(tuning: Tuned, filter: WhiteningFilter) -> Self {
        Self {
            filter,
            past: Past::default(),
            past_clipped: Past::default(),
            past_trained: Past::default(),
            past_regressors: Default::default(),
            ticks: 0,
            tuning,
        }
    }

    /// Begins anew.
    pub(super) fn resume(&mut self) {
        *self = Self::new(self.tuning, self.filter);
    }

    /// A tick: what the tracker leaves of the residuals, and the residuals since training, degC. A spike counts as `clip` beyond what the model may get wrong,
    /// `widened` standard deviations: with less, no jump of any size would show while the temperature moves.
    pub(super) fn step(&mut self, left: [f32; 2], e: [f32; 2], widened: [f32; 2]) -> Innovations {
        let t = &self.tuning.charts;
        self.ticks = self.ticks.saturating_add(1);
        let filter = &self.filter;
        let mut innovations = Innovations {
            z: filter.step(&mut self.past, left),
            clipped: filter.step_clipped(&mut self.past_clipped, left, widened.map(|by| t.clip + by)),
            z_trained: filter.step(&mut self.past_trained, e),
            charted: self.ticks >= t.first as u32,
            gathered: self.ticks > t.first as u32,
        };
        if !innovations.charted {
            (innovations.z, innovations.z_trained) = ([0.0; 2], [0.0; 2]);
        }
        innovations
    }

    /// The same tick's regressors since training, whitened.
    pub(super) fn whiten(&mut self, regressors: &Regressors<LASTING>, whitened: &mut Regressors<LASTING>) {
        self.filter.step_all(&mut self.past_regressors, regressors, whitened);
    }

    /// Both residuals turn out to have been lower by `change`, degC.
    pub(super) fn lower(&mut self, change: [f32; 2]) {
        self.past.lower(change);
        self.past_clipped.lower(change);
    }

    pub(super) fn filter(&self) -> &WhiteningFilter {
        &self.filter
    }

    /// Whether the model has run for as long as an onset looks back.
    pub(super) fn remembers(&self) -> bool {
        self.ticks as usize > REMEMBERED
    }

    /// Finite as long as the filter is; the past leaves by itself.
    pub(super) fn sum(&self) -> f32 {
        self.filter.inv_sigma.iter().sum()
    }
}

#[cfg(test)]
impl InnovationsState {
    /// A place of the memory that a bit may flip in.
    pub(super) fn places(&mut self) -> [&mut f32; 1] {
        [&mut self.filter.inv_sigma[1]]
    }
}
