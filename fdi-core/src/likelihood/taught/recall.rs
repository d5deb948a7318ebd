//! Is what is seen a fault that was taught? Its response is whitened as the residuals are, and set against them and against what
//! may move without being a fault.

use super::TaughtFinding;
use super::response::{MOST, Responses};
use crate::bounds::larger;
use crate::likelihood::column::Row;
use crate::likelihood::evidence::{Apart, Freed, Nuisances, moved};
use crate::likelihood::hypothesis::{IMPOSSIBLE, SINCE_ONSET};
use crate::likelihood::ladder::{Ladder, Past};
use crate::likelihood::verdict::Magnitude;
use crate::root::sqrt;

/// A fault comes as large as it was taught, give or take this share, and within these.
const SPREAD: f32 = 0.25;
const RANGE: (f32, f32) = (0.4, 2.0);
/// Logarithm of its odds against the common faults beforehand: somebody has seen it on this rig.
const PRIOR: f32 = 3.0;
/// Half of the width of a 95 % interval, in standard deviations.
const HALF_OF_95: f32 = 1.96;
/// Error of a size beside that of the estimate, as a share.
const SIZE_ERROR: f32 = 0.1;

/// What has been gathered of each response since the onset.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::likelihood) struct Recall {
    past: [Past; MOST],
    sums: [Apart; MOST],
}

/// What each response is worth.
pub(in crate::likelihood) type Recalled = [Freed; MOST];

impl Recall {
    /// One tick, so many ticks after the onset: the columns and the residuals, all whitened, with a weight.
    pub(in crate::likelihood) fn step(
        &mut self,
        responses: &Responses,
        ladder: &Ladder,
        age: u32,
        (row, z, weight): (&Row, [f32; 2], f32),
    ) {
        if responses.is_empty() {
            return;
        }
        if age == 0 {
            *self = Self::default();
        }
        let moved = moved(&SINCE_ONSET, row);
        for ((response, past), sums) in responses.iter().zip(&mut self.past).zip(&mut self.sums) {
            sums.add(ladder.step(past, response.at(age)), &moved, z, weight);
        }
    }

    /// All sums, `factor` times as much.
    pub(in crate::likelihood) fn scale(&mut self, factor: f32) {
        self.sums.iter_mut().for_each(|sums| sums.scale(factor));
    }

    /// What each response gains over the nuisances.
    pub(in crate::likelihood) fn judge<const N: usize, const H: usize>(
        &self,
        responses: &Responses,
        nuisances: &Nuisances<'_, N, H>,
    ) -> Recalled {
        let mut recalled = [Freed { gain: IMPOSSIBLE, ..Freed::default() }; MOST];
        for ((recalled, sums), _) in recalled.iter_mut().zip(&self.sums).zip(responses) {
            let freed = nuisances.free_apart(sums, (1.0, SPREAD));
            if freed.value > RANGE.0 && freed.value < RANGE.1 {
                *recalled = Freed { gain: freed.gain + PRIOR, ..freed };
            }
        }
        recalled
    }
}

/// The likeliest response beside all classes, whose evidence together has the logarithm `classes`; with what it gains.
pub(in crate::likelihood) fn likeliest(recalled: &Recalled, classes: f32) -> (TaughtFinding, f32) {
    let best = recalled.iter().enumerate().fold(0, |best, (i, freed)| if freed.gain > recalled[best].gain { i } else { best });
    let Freed { gain, value, variance, .. } = recalled[best % MOST];
    let others = recalled.iter().map(|freed| libm::expf(larger(-60.0, freed.gain - gain))).sum::<f32>();
    let confidence = 1.0 / (others + libm::expf(larger(-60.0, classes - gain)));
    let half_width = HALF_OF_95 * sqrt(variance + SIZE_ERROR * SIZE_ERROR * value * value);
    let magnitude = Magnitude { value: 100.0 * value, half_width: 100.0 * half_width };
    (TaughtFinding { place: best as u8, confidence, magnitude }, gain)
}
