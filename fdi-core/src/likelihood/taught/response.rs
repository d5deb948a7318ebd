//! What a fault changes, as it is kept.

use heapless::Vec;

use crate::likelihood::hypothesis::Hypothesis;
use crate::likelihood::regressor::Regressor;
use crate::likelihood::tuning::Tuned;
use crate::name::Name;

/// Faults that there is room for.
pub const MAX_TAUGHT: usize = 10;
/// Effects that a fault can have.
pub const EFFECTS: usize = 11;

/// What a fault changes, in the order and the units of [`names`].
pub type Effects = [f32; EFFECTS];

/// What an alarm has changed, and since when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Changed {
    /// The tick on which the alarm is thought to have begun.
    pub onset: u32,
    /// What it has changed.
    pub effects: Effects,
}

/// A mean of effects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mean {
    sums: Effects,
    /// How many it is of.
    pub count: u32,
}

impl Mean {
    /// One more.
    #[inline]
    pub fn add(&mut self, effects: &Effects) {
        self.sums.iter_mut().zip(effects).for_each(|(sum, effect)| *sum += effect);
        self.count = self.count.saturating_add(1);
    }

    /// The mean; `None` of none.
    #[inline]
    pub fn value(&self) -> Option<Effects> {
        (self.count > 0).then(|| self.sums.map(|sum| sum / self.count as f32))
    }
}

/// An effect: its regressor of the bank, and the step that it is kept in.
struct Effect {
    regressor: Regressor,
    step: f32,
}

const fn share(regressor: Regressor) -> Effect {
    Effect { regressor, step: 0.001 }
}

const fn degrees(regressor: Regressor) -> Effect {
    Effect { regressor, step: 0.01 }
}

const ALL: [Effect; EFFECTS] = [
    share(Regressor::Power),
    share(Regressor::LessFlow),
    share(Regressor::MoreFlow),
    degrees(Regressor::Offset1),
    degrees(Regressor::Offset2),
    share(Regressor::Gain1),
    share(Regressor::Gain2),
    share(Regressor::ShortLag),
    share(Regressor::LongLag),
    share(Regressor::ShortLoss),
    share(Regressor::LongLoss),
];

/// Names of the effects, in their order. All are shares, but for both offsets, which are in degC: less and more flow of `1/f - 1`, lags of one of T1
/// of 0.35 and of 1 s on the reference rig, losses of the rise that T1 loses behind these.
pub fn names() -> [&'static str; EFFECTS] {
    core::array::from_fn(|i| ALL[i].regressor.name().0)
}

/// The regressors of the effects.
pub(in crate::likelihood) const REGRESSORS: [Regressor; EFFECTS] = {
    let (mut regressors, mut i) = ([Regressor::Power; EFFECTS], 0);
    while i < EFFECTS {
        regressors[i] = ALL[i].regressor;
        i += 1;
    }
    regressors
};

/// The regressors with their spreads: those of the hypotheses of one regressor each.
pub(in crate::likelihood) fn spreads(tuning: Tuned) -> [(Regressor, f32); EFFECTS] {
    let (t, lag) = (&tuning.hypotheses, tuning.taught.lag_sd);
    let (flow, offset, share) = (t.flow_sd, t.offset_sd, t.share_sd);
    let spreads = [t.share_sd, flow, flow, offset, offset, share, share, lag, lag, share, share];
    core::array::from_fn(|i| (ALL[i].regressor, spreads[i]))
}

/// What a hypothesis changes where it frees these values; `None` where that is no effect. When it began is none, either, and does not matter.
pub(in crate::likelihood) fn of_hypothesis(row: &Hypothesis, values: [f32; 2]) -> Option<Effects> {
    let mut effects = [0.0; EFFECTS];
    for (free, value) in [Some(row.first), row.second].into_iter().flatten().zip(values) {
        for (regressor, weight) in free.direction.regressors().into_iter().zip(free.direction.weights()) {
            match ALL.iter().position(|effect| effect.regressor as usize == regressor) {
                Some(place) => effects[place] += weight * value,
                None if regressor == Regressor::Late as usize => {}
                None => return None,
            }
        }
    }
    Some(effects)
}

/// A fault of the user's own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Response {
    /// What the user calls it.
    pub name: Name,
    /// What it changes, in the order of [`names`]: shares in thousandths, offsets in hundredths of a degC.
    pub effects: [i16; EFFECTS],
}

/// All responses.
pub type Responses = Vec<Response, MAX_TAUGHT>;

/// There is room for no more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;

/// Adds a response, or puts it in the place of the one of its name.
///
/// # Errors
/// There is room for no more; nothing has changed then.
#[inline]
pub fn put(responses: &mut Responses, response: Response) -> Result<(), Full> {
    match responses.iter_mut().find(|known| known.name == response.name) {
        Some(known) => *known = response,
        None => responses.push(response).map_err(|_| Full)?,
    }
    Ok(())
}

impl Response {
    /// A fault with these effects, rounded; what is no number is none.
    #[inline]
    pub fn new(name: Name, effects: &Effects) -> Self {
        let rounded = |i: usize| libm::roundf(effects[i] / ALL[i].step) as i16; // to the nearest that there is
        Self { name, effects: core::array::from_fn(rounded) }
    }

    /// Whether it changes nothing at all.
    #[inline]
    pub fn is_nothing(&self) -> bool {
        self.effects == [0; EFFECTS]
    }

    /// What it changes of each of [`regressors`].
    pub(super) fn weights(&self) -> Effects {
        core::array::from_fn(|i| f32::from(self.effects[i]) * ALL[i].step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str, effects: [i16; EFFECTS]) -> Response {
        Response { name: name.parse().unwrap(), effects }
    }

    /// To a thousandth, or to a hundredth of a degC; what cannot be kept stays within what can.
    #[test]
    fn effects_are_kept_in_steps() {
        let mut effects = [0.0; EFFECTS];
        (effects[0], effects[3], effects[5], effects[6]) = (-0.2504, 1.504, 1e9, f32::NAN);
        let kept = Response::new(Name::NONE, &effects);
        assert_eq!(kept.effects, [-250, 0, 0, 150, 0, i16::MAX, 0, 0, 0, 0, 0]);
        let weights = kept.weights();
        assert_eq!((REGRESSORS[0], REGRESSORS[3]), (Regressor::Power, Regressor::Offset1));
        assert!((weights[0] + 0.25).abs() < 1e-6 && (weights[3] - 1.5).abs() < 1e-6, "{weights:?}");
    }

    #[test]
    fn a_name_has_one_place_and_ten_fit() {
        let mut responses = Responses::new();
        for i in 0..MAX_TAUGHT {
            let name = ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j"][i];
            assert_eq!(put(&mut responses, named(name, [i as i16; EFFECTS])), Ok(()));
        }
        assert_eq!(put(&mut responses, named("k", [1; EFFECTS])), Err(Full));
        assert_eq!(put(&mut responses, named("c", [-7; EFFECTS])), Ok(()));
        assert_eq!((responses.len(), responses[2]), (MAX_TAUGHT, named("c", [-7; EFFECTS])));
    }
}
