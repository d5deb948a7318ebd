//! What a model's state has that its power did not give: what was taken over at the end of an alarm, and fades as the rig forgets it.
//!
//! [`Interacting`] says by how much the rig's state differs from that of the model of the samples. When an alarm's end moves that model, the
//! difference is another one; and the model of the means differs from the rig by what it has not taken over, or has by itself.

use super::interacting::Interacting;
use super::process::{Motion, Process};
use super::second_heater::SecondHeater;
use super::start::Begun;
use super::{Likelihood, LikelihoodState};

/// Of one model.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Added {
    all: Motion,
    /// Heat at T1, air and wall of all of it, and of what came on the last tick, %.
    at_t1: [f32; 3],
    last: [f32; 3],
    /// The model's state before a tick on which an alarm may end.
    before: Option<Motion>,
}

fn at_t1(process: &Process, motion: &Motion) -> [f32; 3] {
    let ([m, _], [w, _]) = (motion.m, motion.w);
    [motion.air.at(process.delay[0]).0, m, w]
}

/// A rig that has so much more heat at T1, air and wall than its model, %.
pub(super) fn begun([x, m, w]: [f32; 3]) -> Begun {
    let mut motion = Motion::steady(x);
    (motion.m, motion.w) = ([m; 2], [w; 2]);
    Begun { motion, beside: SecondHeater::default(), room: [0.0; 2] }
}

impl Added {
    /// All of it: heat at T1, air and wall, %.
    pub(crate) fn at_t1(&self) -> [f32; 3] {
        self.at_t1
    }

    /// What came on the last tick.
    pub(super) fn last(&self) -> [f32; 3] {
        self.last
    }

    fn take(&mut self, process: &Process, motion: &Motion) {
        self.all.add(motion, 1.0);
        self.at_t1 = at_t1(process, &self.all);
    }
}

impl Likelihood {
    /// Before a tick on which an alarm may end.
    pub(crate) fn before_an_end(&self, state: &LikelihoodState, added: &mut Added) {
        added.before = state.trained.as_ref().map(|trained| *trained.moving().1);
    }

    /// Behind each tick.
    pub(crate) fn follow_added(&self, state: &LikelihoodState, added: &mut Added) {
        let Some(trained) = &state.trained else {
            *added = Added::default();
            return;
        };
        let (process, now, heat) = trained.moving();
        process.step(&mut added.all, 0.0);
        added.last = [0.0; 3];
        if let Some(mut by_power) = added.before.take() {
            process.step(&mut by_power, heat);
            let mut came = *now;
            came.add(&by_power, -1.0);
            added.last = at_t1(process, &came);
            added.all.add(&came, 1.0);
        }
        added.at_t1 = at_t1(process, &added.all);
    }

    /// All is as trained, from the state that the bank has found, which differs by `apart` more from this model than from that of the bank: what alarm
    /// stands is over.
    pub(crate) fn end_as_found(
        &self,
        state: &mut LikelihoodState,
        bank: &Interacting,
        added: &mut Added,
        apart: [f32; 3],
    ) {
        self.add(state, added, bank.begun(apart));
    }

    /// From now on the model has so much that its power did not give: heat at T1, air and wall, %.
    pub(crate) fn catch_up(&self, state: &mut LikelihoodState, added: &mut Added, all: [f32; 3]) {
        let more = core::array::from_fn(|i| all[i] - added.at_t1[i]);
        self.add(state, added, begun(more));
    }

    fn add(&self, state: &mut LikelihoodState, added: &mut Added, begun: Begun) {
        if self.end_in(state, &begun)
            && let Some(trained) = &state.trained
        {
            added.take(trained.moving().0, &begun.motion);
        }
    }
}
