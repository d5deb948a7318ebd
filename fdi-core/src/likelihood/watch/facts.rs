//! What is asked of a rig that is watched: what is usual on it, what it should read, its virtual T1 and its air flow.

use super::WatchState;
use crate::bounds::smaller;
use crate::likelihood::interacting::Interacting;
use crate::likelihood::onset::Onset;
use crate::likelihood::process::{Motion, Process};
use crate::likelihood::regressor::Regressors;
use crate::likelihood::usual::Usual;
use crate::vector::sum;

impl WatchState {
    /// What is usual on this rig, as far as is known now.
    pub(in crate::likelihood) fn usual(&self) -> Usual {
        Usual {
            steps: self.tracker.steps(),
            walk: self.tracker.walk(),
            curvature: self.curvature(),
            slow_surroundings: self.times.slow_surroundings,
            tuning: self.tuning,
        }
    }

    /// The bank that asks whether all is as trained, in whatever state.
    pub(in crate::likelihood) fn interacting(&self) -> Interacting {
        Interacting::new(self.tuning, self.simulation.process(), self.innovations.filter())
    }

    /// The model, its state, and the heat of the last tick, %.
    pub(in crate::likelihood) fn moving(&self) -> (&Process, &Motion, f32) {
        self.simulation.moving()
    }

    /// The model's heat at T1, %, and by how much T1 rises with it, degC.
    pub(in crate::likelihood) fn heat_at_t1(&self) -> [f32; 2] {
        self.simulation.heat_at_t1()
    }

    /// Mean square of the gain's error as far from the trained power as the rig is now: a share.
    fn curvature(&self) -> f32 {
        // A fault moves either what is expected or, where the controller cannot help it, what is measured; a new set-point moves both.
        let from_trained = |rise: f32| (rise - self.charts.trained()).abs();
        let away = smaller(from_trained(self.charts.mean_rise()), from_trained(self.measured[0]))
            / self.simulation.gain();
        let error = self.curvature_error * away / self.tuning.model.step;
        error * error
    }

    /// Static gain from the power to T1, degC per %.
    pub(in crate::likelihood) fn gain(&self) -> f32 {
        self.simulation.gain()
    }

    /// What T1 and T2 should be above the ambient now, degC.
    pub(in crate::likelihood) fn expected(&self) -> [f32; 2] {
        self.simulation.expected()
    }

    /// The virtual T1: its rise over the ambient on the next tick by the models and T2, degC; None where they disagree, or T1 and T2 do.
    pub(in crate::likelihood) fn virtual_t1(&self) -> Option<f32> {
        self.heat.virtual_t1(self.simulation.expected_by_own_heater()[0])
    }

    /// Air flow, % of that at which the rig was learnt: an announced level of the fan is what the model expects, not what is enough.
    pub(in crate::likelihood) fn air_flow(&self) -> Option<f32> {
        Some(self.simulation.fan() * self.heat.air_flow()?)
    }

    /// Whether the rig has been hot without power for too long.
    pub(in crate::likelihood) fn heater_stuck_on(&self) -> bool {
        self.heat.heater_stuck_on()
    }

    /// The regressors of the last tick since an onset that is assumed; none before enough is remembered.
    pub(in crate::likelihood) fn regressors(&self, onset: &mut Onset) -> Option<Regressors> {
        let last = self.simulation.last();
        let nominal = self.simulation.nominal(&last);
        let filter = self.innovations.filter();
        self.innovations.remembers().then(|| onset.step(&self.times.onset, filter, &nominal)[1])
    }

    /// Rises of the model on the last tick, degC.
    pub(in crate::likelihood) fn rises(&self) -> [f32; 2] {
        self.simulation.rises()
    }

    /// Finite as long as all of it is that would stay for ever.
    pub(in crate::likelihood) fn sum(&self) -> f32 {
        let stages = [
            self.simulation.sum(),
            self.tracker.sum(),
            self.innovations.sum(),
            self.charts.sum(),
            self.since_training.sum(),
            self.returned.sum(),
            self.heat.sum(),
        ];
        sum(&stages) + sum(&self.measured) + self.curvature_error
    }
}

#[cfg(test)]
impl WatchState {
    /// A bit of the memory has flipped, and what was a number is none; how many such places there are to choose from.
    pub(in crate::likelihood) fn spoil(&mut self, which: usize) -> usize {
        let places = (self.simulation.places().into_iter())
            .chain(self.innovations.places())
            .chain(self.charts.places())
            .chain(self.since_training.places())
            .chain(self.tracker.places());
        let mut count = 0;
        for (i, place) in places.enumerate() {
            count += 1;
            if i == which {
                *place = f32::NAN;
            }
        }
        count
    }
}
