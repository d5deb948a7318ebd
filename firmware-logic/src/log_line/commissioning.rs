//! The commissioning in the log: its number and its bits, or that there is none. It is told before the first tick that it counts for.

use core::fmt;

use fdi_core::likelihood::{Commissioned, PARAMETERS};

use super::{LogLineError, number, tick};
use crate::settings::commissioning::Commissioning;

pub(super) fn write(f: &mut fmt::Formatter<'_>, commissioning: Option<&Commissioning>) -> fmt::Result {
    let Some(Commissioning { number, models }) = commissioning else {
        return f.write_str("commissioned none");
    };
    write!(f, "commissioned {number}")?;
    models.parameters.iter().try_for_each(|x| write!(f, " {:x}", x.to_bits()))
}

/// Parses what follows "commissioned "; `None` where it is a sentence.
pub(super) fn parse(text: &str) -> Result<Option<Option<Commissioning>>, LogLineError<'_>> {
    if text.split_ascii_whitespace().next() == Some("none") {
        return Ok(Some(None));
    }
    let Some((number, rest)) = number(text) else { return Ok(None) };
    let bits = rest.split_ascii_whitespace().map_while(tick::word);
    let found = bits.clone().count();
    if found != PARAMETERS {
        return Err(LogLineError::Parameters { found });
    }
    let mut models = Commissioned::default();
    models.parameters.iter_mut().zip(bits).for_each(|(x, bits)| *x = f32::from_bits(bits));
    Ok(Some(Some(Commissioning { number, models })))
}
