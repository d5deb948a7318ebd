//! What the rig was like when it was commissioned: the models that were trained then, kept for good. A rig that loses its heat little by
//! little is learnt anew each time as it is; held against this, the loss shows.

use core::f32::consts::SQRT_2;

use super::class::FaultClass;
use super::tuning::Tuned;
use super::verdict::{Finding, Magnitude};
use super::{Likelihood, LikelihoodState};
use crate::error::ConfigError;
use crate::observation::Phase;

/// Numbers that are kept.
pub const PARAMETERS: usize = 16;

/// Models as numbers, to be kept and given back. What each number is, is the models' own matter; those that are not used are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Commissioned {
    /// The numbers.
    pub parameters: [f32; PARAMETERS],
}

/// What has become of the rig since.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SinceCommissioning {
    /// Change of the rise of T1 that a power gives, as a share: -0.12 where it is 12 % less. Less heat and more air look alike here.
    pub rise: f32,
}

impl SinceCommissioning {
    /// That the rig is another one, where it is: by models that were trained on tick `trained`.
    pub(super) fn finding(&self, tuning: Tuned, trained: u32) -> Option<Finding> {
        let t = &tuning.commissioned;
        (self.rise.abs() > t.least).then(|| Finding {
            class: FaultClass::SinceCommissioning,
            confidence: tuning.naming.certain,
            magnitude: Some(Magnitude { value: 100.0 * self.rise, half_width: 100.0 * SQRT_2 * t.repeats }),
            onset: trained,
        })
    }
}

impl Commissioned {
    /// By the static gain from the power to T1, degC per %.
    pub(super) fn new(gain: f32) -> Self {
        let mut parameters = [0.0; PARAMETERS];
        parameters[0] = gain;
        Self { parameters }
    }

    /// Checks what was kept.
    ///
    /// # Errors
    /// It cannot have been trained.
    #[inline]
    pub fn validate(&self) -> Result<(), ConfigError> {
        let name = "commissioning";
        let [gain, ..] = self.parameters;
        if !self.parameters.iter().all(|x| x.is_finite()) {
            return Err(ConfigError::NonFinite { name });
        }
        if gain > 0.0 {
            Ok(())
        } else {
            Err(ConfigError::NotAbove { name, value: gain, other: "no gain", limit: 0.0 })
        }
    }

    /// What has become of it by now.
    pub(super) fn until(&self, now: &Self) -> SinceCommissioning {
        SinceCommissioning { rise: now.parameters[0] / self.parameters[0] - 1.0 }
    }
}

impl Likelihood {
    /// The models that are in force, as they are kept at a commissioning.
    pub fn trained(&self, state: &LikelihoodState) -> Option<Commissioned> {
        let trained = state.trained.as_ref().filter(|_| state.current)?;
        Some(Commissioned::new(trained.gain()))
    }

    /// Takes over what was trained when the rig was commissioned, which has been checked with [`Commissioned::validate`].
    pub fn commission(&self, state: &mut LikelihoodState, commissioned: Option<Commissioned>) {
        state.commissioned = commissioned;
    }

    /// What has become of the rig since it was commissioned, by the models in force.
    pub fn since_commissioning(&self, state: &LikelihoodState) -> Option<SinceCommissioning> {
        Some(state.commissioned?.until(&self.trained(state)?))
    }

    /// What has become of the rig since it was commissioned, where it is watched and that is more than one training differs from the next by.
    pub(super) fn worn(&self, state: &LikelihoodState, phase: Phase) -> Option<Finding> {
        let since = self.since_commissioning(state).filter(|_| phase == Phase::Watched)?;
        since.finding(self.tuning, state.trained_at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_a_share_of_what_it_was() {
        let since = Commissioned::new(0.25).until(&Commissioned::new(0.2));
        assert!((since.rise + 0.2).abs() < 1e-6);
    }

    /// Below what one training differs from the next by nothing is said.
    #[test]
    fn a_large_change_is_a_finding_with_its_size() {
        let found =
            |gain| Commissioned::new(0.3).until(&Commissioned::new(gain)).finding(Tuned::default(), 7);
        assert!(found(0.26).is_none() && found(0.34).is_none());
        for (gain, size) in [(0.24, -20.0), (0.36, 20.0)] {
            let finding = found(gain).expect("a fifth");
            let value = finding.magnitude.map(|magnitude| magnitude.value);
            assert_eq!((finding.class, finding.onset), (FaultClass::SinceCommissioning, 7));
            assert!(value.is_some_and(|value| (value - size).abs() < 1e-3), "{value:?}");
        }
    }

    #[test]
    fn what_cannot_have_been_trained_is_refused() {
        assert!(Commissioned::new(0.3).validate().is_ok());
        for gain in [0.0, -0.3, f32::NAN, f32::INFINITY] {
            assert!(Commissioned::new(gain).validate().is_err(), "{gain}");
        }
        let mut damaged = Commissioned::new(0.3);
        damaged.parameters[15] = f32::NAN;
        assert!(damaged.validate().is_err());
    }
}
