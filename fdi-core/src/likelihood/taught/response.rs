//! The mean answer of the residuals to a fault, in twelve intervals since its onset that grow longer.

use heapless::Vec;

use crate::bounds::larger;
use crate::error::{ConfigError, in_range};
use crate::name::Name;

/// Faults that there is room for.
pub const MOST: usize = 10;
/// Intervals of a response.
pub const INTERVALS: usize = 12;

/// The tick on which each interval begins, and the one behind the last.
pub(super) const BEGINS: [u16; INTERVALS + 1] = [0, 1, 2, 3, 4, 6, 9, 14, 22, 35, 56, 90, 144];
/// The largest share, %.
const WHOLE: i8 = 100;

/// A response. In each interval it has its mean in the middle; between these it goes straight, and behind the last it stays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Response {
    /// What the user calls the fault.
    pub name: Name,
    /// The largest mean of any interval without its sign, degC.
    pub size: f32,
    /// What T1 does, % of that.
    pub t1: [i8; INTERVALS],
    /// What T2 does, % of that.
    pub t2: [i8; INTERVALS],
}

/// All responses.
pub type Responses = Vec<Response, MOST>;

impl Response {
    /// Rounds means, degC, to whole % of the largest.
    pub fn new(name: Name, means: &[[f32; 2]; INTERVALS]) -> Self {
        let size = means.iter().flatten().fold(0.0, |most, mean| larger(most, mean.abs()));
        let share = |mean: f32| libm::roundf(f32::from(WHOLE) * mean / size) as i8; // saturates; no number is 0
        let of = |m: usize| core::array::from_fn(|i| share(means[i][m]));
        Self { name, size, t1: of(0), t2: of(1) }
    }

    /// What T1 and T2 do so many ticks after the onset, degC.
    pub(super) fn at(&self, age: u32) -> [f32; 2] {
        let (i, on) = place(age);
        [&self.t1, &self.t2].map(|shares| {
            let share = |i: usize| f32::from(shares[i.min(INTERVALS - 1)]);
            0.01 * self.size * (share(i) + on * (share(i + 1) - share(i)))
        })
    }
}

/// The interval whose middle is behind, and the share of the way to the next middle that has been gone.
fn place(age: u32) -> (usize, f32) {
    let twice = 2 * age.min(u32::from(BEGINS[INTERVALS])) as u16;
    let middle = |i: usize| BEGINS[i] + BEGINS[i + 1] - 1; // times two
    let i = (1..INTERVALS).take_while(|i| middle(*i) <= twice).last().unwrap_or(0);
    if i + 1 == INTERVALS {
        return (i, 0.0);
    }
    (i, f32::from(twice - middle(i)) / f32::from(middle(i + 1) - middle(i)))
}

/// Sizes that a response can have, degC.
const SIZES: [f32; 2] = [0.01, 500.0];

/// Checks the numbers of all responses.
///
/// # Errors
/// `likelihood.taught`, with the number and its bounds.
pub(in crate::likelihood) fn validate(responses: &Responses) -> Result<(), ConfigError> {
    let name = "likelihood.taught";
    responses.iter().try_for_each(|response| {
        in_range(name, response.size, SIZES[0], SIZES[1])?;
        let (shares, whole) = ([response.t1, response.t2], f32::from(WHOLE));
        shares.iter().flatten().try_for_each(|share| in_range(name, f32::from(*share), -whole, whole))
    })
}
