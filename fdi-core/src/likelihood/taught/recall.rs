//! Is what is seen a fault that was taught? Each response is a hypothesis that frees its size, beside all that the bank has.

use super::response::{MOST, Responses};
use crate::bounds::{larger, smaller};
use crate::likelihood::evidence::{Freed, Nuisances};
use crate::likelihood::hypothesis::IMPOSSIBLE;

/// A fault comes as large as it was taught, give or take this share, and within these.
const SPREAD: f32 = 0.2;
const RANGE: (f32, f32) = (0.3, 3.0);
/// Logarithm of its odds against the common faults beforehand: somebody has seen it on this rig. It is told from the class that it belongs to by its
/// size alone.
const PRIOR: f32 = 4.5;

/// What each response gains over the nuisances.
pub(in crate::likelihood) type Recalled = [Freed; MOST];

/// Judges all of them.
#[inline(never)]
pub(in crate::likelihood) fn recall<const N: usize, const H: usize>(
    responses: &Responses,
    nuisances: &Nuisances<'_, N, H>,
) -> Recalled {
    let mut recalled = [Freed { gain: IMPOSSIBLE, ..Freed::default() }; MOST];
    for (recalled, response) in recalled.iter_mut().zip(responses) {
        let freed = nuisances.free_along(&response.weights(), (1.0, SPREAD));
        if freed.value > RANGE.0 && freed.value < RANGE.1 {
            *recalled = Freed { gain: freed.gain + PRIOR, ..freed };
        }
    }
    recalled
}

/// The place of the likeliest, and its probability beside all classes, whose evidence together has the logarithm `classes`.
pub(in crate::likelihood) fn likeliest(recalled: &Recalled, classes: f32) -> (usize, f32) {
    let mut best = 0;
    for (i, freed) in recalled.iter().enumerate() {
        if freed.gain > recalled[best % MOST].gain {
            best = i;
        }
    }
    let gain = recalled[best % MOST].gain;
    let ratio = |other: f32| libm::expf(smaller(60.0, larger(-60.0, other - gain)));
    (best, 1.0 / (ratio(classes) + recalled.iter().map(|freed| ratio(freed.gain)).sum::<f32>()))
}
