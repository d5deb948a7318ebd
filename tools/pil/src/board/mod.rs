//! The emulated board: start-up, console and exit by semihosting, the recorded inputs. Not a board that exists.

pub mod console;
pub mod input;
mod startup;

pub use console::{Console, exit};
