//! The PT-326 instrument on the host: the same [`fdi_core`] that the board runs, against a simulated rig.

// `println!` panics when the reader of a pipe goes away (`pt326 run | head`): `commands::terminal::print`.
#![warn(clippy::print_stdout)]

#[cfg(feature = "serial")]
pub mod board;
pub mod campaign;
#[cfg(feature = "cli")]
pub mod commands;
pub mod experiment;
pub mod identify;
pub mod isolability;
pub mod record;
pub mod recording;
pub mod repeat;
pub mod score;
pub mod search;
pub mod settings;
pub mod teach;
pub mod tune;
pub mod words;
