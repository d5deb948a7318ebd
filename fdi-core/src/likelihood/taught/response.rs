//! What a fault changes, as it is kept.

use heapless::Vec;

use crate::bounds::bounded;
use crate::likelihood::column::Column;
use crate::name::Name;

/// Faults that there is room for.
pub const MOST: usize = 10;
/// Effects that a fault can have.
pub const EFFECTS: usize = 11;

/// What a fault changes, in the order and the units of [`names`].
pub type Effects = [f32; EFFECTS];

/// An effect: what it is called, its column of the bank, the spread that it may have, and the step that it is kept in.
struct Effect {
    name: &'static str,
    column: Column,
    spread: f32,
    step: f32,
}

const fn share(name: &'static str, column: Column, spread: f32) -> Effect {
    Effect { name, column, spread, step: 0.001 }
}

const fn degrees(name: &'static str, column: Column, spread: f32) -> Effect {
    Effect { name, column, spread, step: 0.01 }
}

/// Spreads are those of the hypotheses of one column each.
static ALL: [Effect; EFFECTS] = [
    share("power", Column::Power, 0.25),
    share("less flow", Column::LessFlow, 0.3),
    share("more flow", Column::MoreFlow, 0.3),
    degrees("offset of T1", Column::Offset1, 2.0),
    degrees("offset of T2", Column::Offset2, 2.0),
    share("gain of T1", Column::Gain1, 0.25),
    share("gain of T2", Column::Gain2, 0.25),
    share("short lag", Column::ShortLag, 0.5),
    share("long lag", Column::LongLag, 0.5),
    share("short loss", Column::ShortLoss, 0.25),
    share("long loss", Column::LongLoss, 0.25),
];

/// Names of the effects, in their order. All are shares, but for both offsets, which are in degC: less and more flow of `1/f - 1`, lags of one of T1
/// of 0.35 and of 1 s on the reference rig, losses of the rise that T1 loses behind these.
pub fn names() -> [&'static str; EFFECTS] {
    core::array::from_fn(|i| ALL[i].name)
}

/// The columns with their spreads.
pub(in crate::likelihood) fn spreads() -> [(Column, f32); EFFECTS] {
    core::array::from_fn(|i| (ALL[i].column, ALL[i].spread))
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
pub type Responses = Vec<Response, MOST>;

/// There is room for no more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;

/// Adds a response, or puts it in the place of the one of its name.
///
/// # Errors
/// There is room for no more; nothing has changed then.
pub fn put(responses: &mut Responses, response: Response) -> Result<(), Full> {
    match responses.iter_mut().find(|known| known.name == response.name) {
        Some(known) => *known = response,
        None => responses.push(response).map_err(|_| Full)?,
    }
    Ok(())
}

impl Response {
    /// A fault with these effects, rounded.
    pub fn new(name: Name, effects: &Effects) -> Self {
        let limit = f32::from(i16::MAX);
        let rounded = |i: usize| libm::roundf(bounded(effects[i] / ALL[i].step, -limit, limit)) as i16;
        Self { name, effects: core::array::from_fn(rounded) }
    }

    /// Its columns, each with what it changes.
    pub(super) fn weights(&self) -> [(Column, f32); EFFECTS] {
        core::array::from_fn(|i| (ALL[i].column, f32::from(self.effects[i]) * ALL[i].step))
    }
}
