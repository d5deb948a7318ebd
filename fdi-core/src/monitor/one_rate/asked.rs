//! What the monitor asks while an alarm stands: see `likelihood/interacting.rs`.

use super::OneRate;
use crate::likelihood::interacting::{Found, Interacting};

impl OneRate {
    /// Whether an alarm of the models stands that may be over.
    pub(in crate::monitor) fn asks(&self) -> bool {
        self.start.is_none() && self.diagnosis.left_by_alarm(&self.state).is_some()
    }

    /// The highest confidence of a name.
    pub(in crate::monitor) fn certain(&self) -> f32 {
        self.diagnosis.certain()
    }

    /// The bank that asks whether it is; none before anything was learnt.
    pub(in crate::monitor) fn bank(&self) -> Option<Interacting> {
        self.diagnosis.interacting(&self.state)
    }

    /// What it makes of the last sample.
    pub(in crate::monitor) fn ask(&self, bank: &mut Interacting) -> Found {
        self.diagnosis.ask(&self.state, bank, self.beyond)
    }

    /// It is: all is as trained from the state that was found.
    pub(in crate::monitor) fn end_as_found(&mut self, bank: &Interacting) {
        self.diagnosis.end_as_found(&mut self.state, bank);
    }
}
