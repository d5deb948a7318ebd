//! What the watch tells of a rig: its alarm, the virtual T1, the air flow, what is expected.

use super::super::alarm::{Alarm, ModelAlarm};
use super::super::evidence::Nuisance;
use super::super::heat::Heat;
use super::super::hypothesis;
use super::super::onset::{Nominal, Onset, REMEMBERED};
use super::super::regressor::Regressors;
use super::super::signatures::NUISANCES;
use super::WatchState;
use super::lasting::Lasting;

impl WatchState {
    /// What is reported: what began at an onset first, then what lasts.
    pub(super) fn reported(&self, heat: &Heat, tick: u32) -> ModelAlarm {
        let finding = match (&self.alarm, self.lasting) {
            (Some(Alarm { finding: Some(finding), .. }), _) => *finding,
            (_, Some(Lasting { finding: Some(finding), .. })) => finding,
            (Some(_), _) | (_, Some(_)) => return ModelAlarm::Unnamed,
            (None, None) => return ModelAlarm::Quiet,
        };
        heat.review(&self.heat, finding, tick)
    }

    /// The virtual T1: its rise over the ambient on the next tick by the models and T2, degC; None where they disagree, or T1 and T2 do.
    pub(in super::super) fn virtual_t1(&self) -> Option<f32> {
        if self.contradict {
            return None;
        }
        self.heat.virtual_t1(self.expected[0])
    }

    /// Air flow, % of that at which the rig was learnt: an announced level of the fan is what the model expects, not what is enough.
    pub(in super::super) fn air_flow(&self) -> Option<f32> {
        Some(self.fan * self.heat.air_flow()?)
    }

    /// Whether the rig has been hot without power for too long.
    pub(in super::super) fn heater_stuck_on(&self) -> bool {
        self.heat.heater_stuck_on()
    }

    /// The regressors of the last tick since an onset that is assumed; none before enough is remembered.
    pub(in super::super) fn regressors(&self, onset: &mut Onset) -> Option<Regressors> {
        let [(heat, rises), (_, before)] = [0, 1].map(|ago| self.history.at(&self.process, ago));
        let nominal = Nominal {
            parameters: &self.parameters,
            fan: self.fan,
            process: &self.process,
            motion: &self.motion,
            history: &self.history.before(),
            heat,
            rises,
            before: before.y,
            inlet: self.inlet.map_or([0.0; 2], |(_, _, moved)| moved),
        };
        (self.ticks as usize > REMEMBERED).then(|| onset.step(&self.times.onset, &self.whitening, &nominal))
    }

    /// What may move since an onset without being a fault, as far as is known now.
    pub(in super::super) fn nuisances(&self) -> [Nuisance; NUISANCES] {
        let mut nuisances =
            hypothesis::since_onset(&self.tuning.nuisances, self.steps, self.curvature_variance());
        if self.is_slow() {
            nuisances[hypothesis::SHIFT].1 = self.tuning.slow.shift;
        }
        nuisances
    }

    /// Rises of the model on the last tick, degC.
    pub(in super::super) fn rises(&self) -> [f32; 2] {
        self.before
    }

    /// What T1 and T2 should be above the ambient now, degC.
    pub(in super::super) fn expected(&self) -> [f32; 2] {
        self.expected.map(|rise| rise + self.beside.added())
    }
}
