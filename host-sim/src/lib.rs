//! The command `pt326`: what its arguments mean. What it does with them is the library [`pt326_host`].

// `println!` panics when the reader of a pipe goes away (`pt326 run | head`): `commands::terminal::print`.
#![warn(clippy::print_stdout)]

pub mod commands;
