//! Has a change of the heater's power gone? Where the surroundings move as slowly as the rig answers, a residual that lasts says hardly anything by
//! itself, and what the rig does when its heater is right again has to be looked for: its way back.
//!
//! It is assumed to have gone on some tick, and what has been seen since is held against that. Where it is refuted, or nothing has been
//! decided for as long as the rig takes to answer, a new tick is assumed.

use super::process::{Motion, Process};
use super::whitening::{Past, WhiteningFilter};

/// The assumption.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Recovery {
    /// What the power since then has warmed.
    pub(super) power: Motion,
    past: Past,
    odds: f32,
    age: u32,
}

impl Recovery {
    /// A tick: whitened residuals, the whitened answer to the power since the onset, the share `theta` by which that changed.
    /// Says whether it has gone.
    pub(super) fn step(
        &mut self,
        (process, whitening): (&Process, &WhiteningFilter),
        heat: f32,
        [z, since]: [[f32; 2]; 2],
        theta: f32,
        (kappa, longest): (f32, u32),
    ) -> bool {
        let rises = process.step(&mut self.power, heat);
        let after = whitening.step(&mut self.past, rises.y);
        for m in 0..2 {
            let stays = z[m] - theta * since[m];
            let goes = stays + theta * after[m];
            self.odds += (stays * stays - goes * goes) / (2.0 * kappa);
        }
        self.age = self.age.saturating_add(1);
        let decides = process.tuning.alarm.over;
        let gone = self.odds > decides;
        if !gone && (self.odds < -decides || self.age > longest) {
            *self = Self::default();
        }
        gone
    }
}
