//! Does anything stir? Cumulative sums of the innovations, their allowances widened where the model may be wrong.

use super::innovations::Innovations;
use super::times::Times;
use crate::bounds::{larger, smaller};
use crate::likelihood::chart::{Chart, Sums};
use crate::likelihood::tuning::Tuned;
use crate::likelihood::whitening::WhiteningFilter;

/// The charts.
#[derive(Clone, Debug)]
pub(super) struct Charts {
    pub(super) fast: Chart,
    pub(super) slow: Chart,
    /// Share of a swing of the temperature, and of its distance from where it was trained, that the model may get wrong.
    pub(super) model_uncertainty: f32,
    pub(super) tuning: Tuned,
}

/// The memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChartsState {
    fast: [Sums; 2],
    slow: Sums,
    /// What jumped on the tick before, standard deviations; 0 where nothing did.
    jumped: [f32; 2],
    /// Mean of T1's expected rise, and how far that was away from it lately, degC.
    mean_rise: f32,
    swing: f32,
    /// Rise of T1 at which training took place, degC.
    trained: f32,
    /// Ticks without charts after an alarm, and for which a change of the fan settles.
    holdoff: u32,
    settling: u32,
}

/// What the charts say on a tick: their largest sums, as shares of the decision intervals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Charted {
    pub(super) fast: f32,
    pub(super) slow: f32,
    /// The largest of the fast sums, standard deviations.
    pub(super) fast_sum: f32,
}

impl Charts {
    /// One tick: by how many standard deviations the residuals may be off, and by how much T0 is above its mean, degC.
    pub(super) fn step(
        &self,
        s: &mut ChartsState,
        times: &Times,
        filter: &WhiteningFilter,
        innovations: &Innovations,
        widened: [f32; 2],
        inlet: f32,
    ) -> Charted {
        let mut z = innovations.clipped;
        if times.slow_surroundings && s.holdoff == 0 {
            self.confirm(s, innovations.z, &mut z);
        }
        // T1 answers to the inlet sooner than T0 does: it is not charted by what the inlet does, but the bank sees all of it.
        let inlet = larger(0.0, inlet.abs() - self.tuning.sensors.noise);
        let allowed = [widened[0] + inlet * filter.inv_sigma[0], widened[1]];
        if !innovations.charted {
            z = [0.0; 2];
        }
        let mut fast = 0.0;
        for m in 0..2 {
            fast = larger(fast, self.fast.step(&mut s.fast[m], z[m], allowed[m]));
        }
        let slow = self.slow.step(&mut s.slow, z[1], allowed[1]);
        Charted { fast: fast / self.fast.interval, slow: slow / self.slow.interval, fast_sum: fast }
    }

    /// By how many standard deviations the residuals may be off because the temperature moves: where T1 should have risen by `rise`, degC.
    pub(super) fn widened(
        &self,
        s: &mut ChartsState,
        times: &Times,
        filter: &WhiteningFilter,
        rise: f32,
    ) -> [f32; 2] {
        times.swing.follow(&mut s.mean_rise, rise);
        let kept = s.swing * (1.0 - times.swing.share());
        s.swing = larger(kept, (rise - s.mean_rise).abs());
        let moved = self.model_uncertainty * larger(0.0, s.swing - self.tuning.charts.swing);
        let away = self.model_uncertainty * (s.mean_rise - s.trained).abs();
        let gain = filter.dc_gain();
        core::array::from_fn(|m| (moved + away * gain[m]) * filter.inv_sigma[m])
    }

    /// A jump that has not gone back on the next tick is no spike, and counts again, in full: where the surroundings are slow, what stays shows
    /// nothing more.
    fn confirm(&self, s: &mut ChartsState, z: [f32; 2], charted: &mut [f32; 2]) {
        let (clip, back) = (self.tuning.charts.clip, self.tuning.slow.back);
        for m in 0..2 {
            let jumped = core::mem::take(&mut s.jumped[m]);
            if jumped * (z[m] + back * jumped) > 0.0 {
                charted[m] =
                    if jumped > 0.0 { larger(charted[m], jumped) } else { smaller(charted[m], jumped) };
            }
            if z[m].abs() > clip {
                s.jumped[m] = z[m];
            }
        }
    }

    /// Whether T1 moves too little for the model's error to show in a mean.
    pub(super) fn is_calm(&self, s: &ChartsState) -> bool {
        s.swing < self.tuning.charts.swing
    }
}

impl ChartsState {
    pub(super) fn new(trained: f32) -> Self {
        Self {
            fast: Default::default(),
            slow: Sums::default(),
            jumped: [0.0; 2],
            mean_rise: trained,
            swing: 0.0,
            trained,
            holdoff: 0,
            settling: 0,
        }
    }

    /// Another recording begins with this rise of T1, degC.
    pub(super) fn resume(&mut self, rise: f32) {
        (self.mean_rise, self.swing) = (rise, 0.0);
        self.reset();
    }

    /// As if nothing had happened.
    pub(super) fn reset(&mut self) {
        self.fast = Default::default();
        self.slow = Sums::default();
        self.jumped = [0.0; 2];
    }

    /// No charts for so many ticks after an alarm.
    pub(super) fn hold_off(&mut self, ticks: u32) {
        self.reset();
        self.holdoff = ticks;
    }

    /// Nothing is judged for so many ticks, in which the fan settles.
    pub(super) fn settle(&mut self, ticks: u32) {
        self.reset();
        self.settling = ticks;
    }

    /// The end of a tick: says whether the fan settled on it.
    pub(super) fn end_tick(&mut self) -> bool {
        let settling = self.settling > 0;
        self.settling = self.settling.saturating_sub(1);
        if self.holdoff > 0 || settling {
            self.holdoff = self.holdoff.saturating_sub(1);
            self.fast = Default::default();
            self.slow = Sums::default();
        }
        settling
    }

    /// Whether there are charts again after the last alarm.
    pub(super) fn is_charting(&self) -> bool {
        self.holdoff == 0
    }

    /// Mean of T1's expected rise, degC, and the rise at which training took place.
    pub(super) fn mean_rise(&self) -> f32 {
        self.mean_rise
    }

    pub(super) fn trained(&self) -> f32 {
        self.trained
    }

    /// Finite as long as all of it is that stays.
    pub(super) fn sum(&self) -> f32 {
        self.mean_rise + self.swing + self.trained
    }
}

#[cfg(test)]
impl ChartsState {
    /// A place of the memory that a bit may flip in.
    pub(super) fn places(&mut self) -> [&mut f32; 1] {
        [&mut self.mean_rise]
    }
}
