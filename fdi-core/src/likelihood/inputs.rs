//! Which of the inputs that the models know a rig has. The trainer has them all; a recording of another heater may lack some.

use super::class::FaultClass;

/// What a rig has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inputs {
    /// The ambient temperature is measured. Without it an intercept takes its place.
    pub t0: bool,
    /// There is a second thermistor behind T1. Without it no fault has a place: what T1 reads, the heater and the air are told apart by
    /// how fast things go alone.
    pub t2: bool,
    /// The power of a sample is what was applied since the last one, not what is applied from then on: samples are means.
    pub since: bool,
    /// Something moves air, so that its flow may fail, and carry dirt to a thermistor.
    pub fan: bool,
}

impl Inputs {
    /// Those of the trainer.
    pub const ALL: Self = Self { t0: true, t2: true, since: false, fan: true };

    /// What has driven the heater since the last tick; `now` is the power of this tick.
    pub(super) fn drove(self, last: &mut f32, now: f32) -> f32 {
        let before = core::mem::replace(last, now);
        if self.since { now } else { before }
    }

    /// How many thermistors are in the air.
    pub(super) fn channels(self) -> usize {
        1 + usize::from(self.t2)
    }

    /// Whether a fault of this class can be told by them.
    pub fn tell(self, class: FaultClass) -> bool {
        let needs = class.needs();
        (self.t0 || !needs.t0) && (self.t2 || !needs.t2) && (self.fan || !needs.fan)
    }
}

#[cfg(test)]
mod tests {
    use super::super::class::Channel;
    use super::*;

    #[test]
    fn what_is_missing_is_not_blamed() {
        let told = |inputs: Inputs| FaultClass::ALL.into_iter().filter(move |class| inputs.tell(*class));
        assert_eq!(told(Inputs::ALL).count(), FaultClass::ALL.len());
        let one = Inputs { t0: false, t2: false, ..Inputs::ALL };
        assert!(told(one).all(|class| !matches!(class.sensor(), Some(Channel::T0 | Channel::T2))
            || matches!(class.sensor(), Some(Channel::T0)) && class != FaultClass::T0Fault));
        assert!(one.tell(FaultClass::T1Offset) && one.tell(FaultClass::AirFlow));
        assert!(!Inputs { fan: false, ..one }.tell(FaultClass::AirFlow));
    }
}
