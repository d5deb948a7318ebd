//! What whatever is watched tells, in the order in which it happens.

use crate::fields::FIELDS;
use crate::names::Names;
use crate::scene::Order;

/// The numbers of a tick, in the order of [`FIELDS`].
pub type Numbers = [f32; FIELDS.len()];

/// Something that is told to all who watch.
#[derive(Clone, Debug, PartialEq)]
pub enum Told {
    /// A tick.
    Row(Numbers),
    /// An order was carried out, by whomever it was given; in force from the next row on.
    Order(Order),
    /// An order was not carried out, and why.
    Refused(String),
    /// What a user calls faults of his own, from now on.
    Names(Names),
    /// What the board's console has said.
    Said(String),
    /// Whether there is a connection to what is watched.
    Link(bool),
}
