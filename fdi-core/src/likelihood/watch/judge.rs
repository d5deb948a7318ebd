//! A tick of the watch, from residuals to charts and banks.

use super::super::chart::Sums;
use super::super::regressor::{LASTING, Regressors};
use super::{Charted, Gathered, NowRises, Watch, WatchState};
use crate::bounds::{bounded, larger};

impl Watch {
    /// One whole tick: residuals since training and what the tracker leaves of them, charts, both banks.
    pub(super) fn judge(
        &self,
        s: &mut WatchState,
        g: &mut Gathered,
        tick: u32,
        e: [f32; 2],
        regressors: &Regressors<LASTING>,
        now: &NowRises,
    ) {
        let t = &self.tuning.charts;
        let first = t.first as u32;
        let known = s.tracker.expected(regressors);
        let left = [e[0] - known[0], e[1] - known[1]];
        let mut z = s.whitening.step(&mut s.past, left);
        let mut z_trained = s.steady.residual(&s.whitening, e);
        let whitened = s.steady.whitened(&s.whitening, regressors);
        if s.ticks < first {
            (z, z_trained) = ([0.0; 2], [0.0; 2]);
        }
        let widened = self.widened(s, s.expected[0]);
        let mut clipped = s.whitening.step_clipped(&mut s.past_clipped, left, t.clip);
        if s.is_slow() && s.holdoff == 0 {
            s.confirm(z, &mut clipped);
        }
        // T1 answers to the inlet sooner than T0 does: it is not charted by what the inlet does, but the bank sees all of it.
        let inlet = s.inlet.map_or(0.0, |(_, _, [_, above])| larger(0.0, above.abs() - t.inlet_noise));
        let allowed = [widened[0] + inlet * s.whitening.inv_sigma[0], widened[1]];
        let charted = self.chart(s, if s.ticks < first { [0.0; 2] } else { clipped }, allowed);
        self.follow_onset(s, g, z, widened, &charted, now);
        if s.alarm.is_none() {
            self.decide(s, g, tick, &charted, regressors);
        } else {
            self.follow_alarm(s, g, z, regressors, now.heat);
        }
        let settling = s.settling > 0;
        s.settling = s.settling.saturating_sub(1);
        if s.holdoff > 0 || settling {
            s.holdoff = s.holdoff.saturating_sub(1);
            s.fast = Default::default();
            s.slow = Sums::default();
        }
        let quiet = s.alarm.is_none();
        if quiet && s.lasting.is_none() {
            for (square, x) in s.walk_variance.iter_mut().zip(s.tracker.x) {
                s.times.walk.follow(square, x * x);
            }
        }
        if quiet && (settling || larger(charted.fast, charted.slow) < self.tuning.tracker.below) {
            s.tracker.step(&whitened, z.map(|z| bounded(z, -t.clip, t.clip)));
        }
        if quiet && s.holdoff == 0 && !settling && s.swing[1] < t.swing && s.ticks > first {
            s.steady.gather(&s.times.steady, regressors, &whitened, e, z_trained);
            self.judge_lasting(s, tick);
        }
    }

    /// By how many standard deviations the residuals may be off because the temperature moves.
    fn widened(&self, s: &mut WatchState, rise: f32) -> [f32; 2] {
        let [mean, swing] = &mut s.swing;
        s.times.swing.follow(mean, rise);
        let kept = *swing * (1.0 - s.times.swing.share());
        *swing = larger(kept, (rise - *mean).abs());
        let moved = self.model_uncertainty * larger(0.0, *swing - self.tuning.charts.swing);
        let away = self.model_uncertainty * (*mean - s.trained).abs();
        let gain = s.whitening.dc_gain();
        core::array::from_fn(|m| (moved + away * gain[m]) * s.whitening.inv_sigma[m])
    }

    fn chart(&self, s: &mut WatchState, z: [f32; 2], widened: [f32; 2]) -> Charted {
        let mut fast = 0.0;
        for m in 0..2 {
            fast = larger(fast, self.fast.step(&mut s.fast[m], z[m], widened[m]));
        }
        let slow = self.slow.step(&mut s.slow, z[1], widened[1]);
        Charted { fast: fast / self.fast.interval, slow: slow / self.slow.interval }
    }
}
