//! What the monitor asks while an alarm stands: see `likelihood/interacting.rs`.

use super::OneRate;
use crate::likelihood::interacting::{Found, Interacting};

impl OneRate {
    /// Its model takes over what that of the samples has of it: heat at T1, air and wall, %.
    pub(in crate::monitor) fn catch_up(&mut self, all: [f32; 3]) {
        self.diagnosis.catch_up(&mut self.state, &mut self.added, all);
    }

    /// Whether it is watched, and known how it began.
    pub(in crate::monitor) fn is_watched(&self) -> bool {
        self.armed && self.start.is_none()
    }

    /// Whether an alarm of the models stands that may be over.
    pub(in crate::monitor) fn asks(&self) -> bool {
        self.start.is_none() && self.diagnosis.left_by_alarm(&self.state).is_some()
    }

    /// The highest confidence of a name.
    pub(in crate::monitor) fn certain(&self) -> f32 {
        self.diagnosis.certain()
    }

    /// What its model has that its power did not give: heat at T1, air and wall, %.
    pub(in crate::monitor) fn added(&self) -> [f32; 3] {
        self.added.at_t1()
    }

    /// The bank that asks whether it is; none before anything was learnt.
    pub(in crate::monitor) fn bank(&self) -> Option<Interacting> {
        self.diagnosis.interacting(&self.state)
    }

    /// What it makes of the last sample.
    pub(in crate::monitor) fn ask(&self, bank: &mut Interacting) -> Found {
        self.diagnosis.ask(&self.state, bank, &self.added, self.beyond)
    }

    /// It is: all is as trained from the state that was found.
    pub(in crate::monitor) fn end_as_found(&mut self, bank: &Interacting, apart: [f32; 3]) {
        self.diagnosis.end_as_found(&mut self.state, bank, &mut self.added, apart);
    }
}
