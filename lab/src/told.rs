//! What whatever is watched tells, in the order in which it happens.

use fdi_core::schema::Numbers;

use crate::names::Names;
use crate::scene::Order;

/// Something that is told to all who watch.
#[derive(Clone, Debug, PartialEq)]
pub enum Told {
    /// A tick.
    Row(Numbers),
    /// An order was carried out, by whomever it was given; in force from the next row on.
    Order(Order),
    /// An order was not carried out.
    Refused {
        /// Why, in words.
        why: String,
        /// Name of the trip whose cause persists, where that is why.
        persists: Option<&'static str>,
    },
    /// What a user calls faults of his own, from now on.
    Names(Names),
    /// What the board's console has said.
    Said(String),
    /// Whether there is a connection to what is watched.
    Link(bool),
}
