//! The nuisances as independent ones of variance 1, in which they are integrated out.

use super::{MOST, Nuisance};
use crate::bounds::larger;
use crate::likelihood::regressor::{Direction, Regressor};
use crate::root::sqrt;

/// A nuisance of variance 1, which moves its regressor by this much.
#[derive(Clone, Copy, Default)]
pub(super) struct Unit {
    pub(super) regressor: usize,
    pub(super) by: f32,
}

/// T0's error moves the offsets of T1 and T2 alike, so that it is no nuisance of its own: it widens their priors and ties them. What moves T1's offset
/// moves T2's as well, by this share of what T2's own moves it; both stand at this place and the next.
#[derive(Clone, Copy, Default)]
pub(super) struct Tie {
    place: usize,
    share: f32,
}

/// Makes the nuisances of a list independent ones: Cholesky's factor of the offsets' priors takes T0's into both.
pub(super) fn untied(list: &[Nuisance], units: &mut [Unit; MOST]) -> Tie {
    let of_t0 = |(direction, sd): &Nuisance| (*direction == Direction::Offset0).then_some(sd * sd);
    let t0 = list.iter().find_map(of_t0).unwrap_or(0.0);
    let (mut tie, mut moved) = (Tie::default(), 0.0);
    for (place, (unit, &(direction, sd))) in units.iter_mut().zip(list).enumerate() {
        let Direction::Of(regressor) = direction else { continue };
        *unit = Unit { regressor: regressor as usize, by: sd };
        match regressor {
            Regressor::Offset1 => {
                unit.by = sqrt(sd * sd + t0);
                moved = t0 / unit.by;
            }
            Regressor::Offset2 if t0 > 0.0 => {
                unit.by = sqrt(sd * sd + t0 - moved * moved);
                tie =
                    Tie { place: place.saturating_sub(1), share: moved / larger(f32::MIN_POSITIVE, unit.by) };
            }
            _ => {}
        }
    }
    tie
}

impl Tie {
    /// The places that it ties.
    #[inline]
    fn places(self) -> [usize; 2] {
        let first = self.place.min(MOST - 2);
        [first, first + 1]
    }

    /// What one shares with each nuisance by itself, as it shares it with them tied.
    #[inline]
    pub(super) fn tie(self, shared: &mut [f32; MOST]) {
        let [first, second] = self.places();
        shared[first] += self.share * shared[second];
    }

    /// The same of several side by side.
    #[inline]
    pub(super) fn tie_rows<const C: usize>(self, shared: &mut [[f32; C]; MOST]) {
        let [first, second] = self.places();
        for c in 0..C {
            shared[first][c] += self.share * shared[second][c];
        }
    }

    /// The same of what the nuisances share with each other, of which there is the lower half.
    #[inline]
    pub(super) fn tie_half(self, half: &mut [[f32; MOST]; MOST]) {
        let [first, second] = self.places();
        for c in 0..first {
            half[first][c] += self.share * half[second][c];
        }
        half[first][first] += self.share * (2.0 * half[second][first] + self.share * half[second][second]);
        for row in second..MOST {
            half[row][first] += self.share * half[row][second];
        }
    }

    /// What the nuisances are thought to be, of what they are thought to be untied.
    #[inline]
    pub(super) fn untie(self, values: &mut [f32; MOST]) {
        let [first, second] = self.places();
        values[second] += self.share * values[first];
    }
}
