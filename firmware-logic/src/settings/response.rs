//! Faults of the user's own as settings: `NAME`, then what each changes, in the order of
//! [`names`](fdi_core::likelihood::taught::names), such as `low 0 -37 31 -14 -113 24 -12 82 -44 13 -4`; or `none`.

use core::fmt;

use fdi_core::likelihood::taught::{EFFECTS, Response, Responses};

use super::error::{Expected, SetError};
use super::table::put;
use crate::decimal::whole;

/// The beginning of their names.
pub(super) const START: &str = "likelihood.taught.";

/// Writes, adds or (with `none`) takes away a response.
pub(super) fn set<'a>(
    responses: &mut Responses,
    place: usize,
    name: &'a str,
    text: &'a str,
) -> Result<(), SetError<'a>> {
    if text == "none" && place < responses.len() {
        responses.remove(place);
        return Ok(());
    }
    let expected = Expected::Words("a name and eleven whole numbers, not all 0; or none");
    let response = parse(text).ok_or(SetError::Value { name, given: text, expected })?;
    put(responses, place, name, response)
}

fn parse(text: &str) -> Option<Response> {
    let mut words = text.split_ascii_whitespace();
    let name = words.next()?.parse().ok()?;
    let mut effects = [0; EFFECTS];
    for effect in &mut effects {
        *effect = whole(words.next()?)?;
    }
    let response = Response { name, effects };
    (words.next().is_none() && !response.is_nothing()).then_some(response)
}

/// The text that [`set`] reads.
pub(super) fn write(f: &mut fmt::Formatter<'_>, response: &Response) -> fmt::Result {
    f.write_str(response.name.as_str())?;
    response.effects.iter().try_for_each(|effect| write!(f, " {}", i32::from(*effect)))
}
