//! The PT-326 instrument on the host: the same [`fdi_core`] that the board runs, against a simulated rig.

// What a library prints its user cannot leave out.
#![warn(clippy::print_stdout)]

pub mod board;
pub mod campaign;
pub mod experiment;
pub mod isolability;
pub mod plant;
pub mod record;
pub mod recording;
pub mod repeat;
pub mod score;
pub mod search;
pub mod settings;
pub mod teach;
pub mod tune;
pub mod words;
