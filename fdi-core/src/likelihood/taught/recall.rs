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
const PRIOR: f32 = 3.0;

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

#[cfg(test)]
mod tests {
    use super::*;

    fn recalled(gains: &[(usize, f32)]) -> Recalled {
        let mut recalled = [Freed { gain: IMPOSSIBLE, ..Freed::default() }; MOST];
        gains.iter().for_each(|(place, gain)| recalled[*place].gain = *gain);
        recalled
    }

    #[test]
    fn the_likeliest_has_its_share_of_all_that_is_possible() {
        let close = |(place, p): (usize, f32), wanted: (usize, f64)| {
            assert!(place == wanted.0 && (f64::from(p) - wanted.1).abs() < 1e-4, "{place} {p} {wanted:?}");
        };
        close(likeliest(&recalled(&[(3, 40.0)]), 37.0), (3, 1.0 / (1.0 + (-3.0f64).exp())));
        let two = recalled(&[(3, 40.0), (7, 41.0)]);
        close(likeliest(&two, 39.0), (7, 1.0 / (1.0 + (-1.0f64).exp() + (-2.0f64).exp())));
        close(likeliest(&recalled(&[(0, -2.0)]), 5000.0), (0, 0.0));
        assert!(likeliest(&recalled(&[]), 10.0).1 < 1e-6, "nothing was taught");
    }
}
