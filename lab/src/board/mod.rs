//! A real board at the other end of a serial port, as far as no port is needed for it: what it says, what it is asked, what its log holds.
//! Whoever has the port, a page or a program, brings the bytes and the time.

mod conversation;
pub mod log;
pub mod record;
mod rows;
pub mod settings;
#[cfg(test)]
mod tests;
pub mod text;
mod twin;
mod visible;

pub use conversation::{Conversation, Standing, line, stops};
pub use rows::{readings, thermistors};
pub use twin::Agreement;
pub use visible::visible;

/// Forgets what was typed of a line: whoever was here before may have left half of `arm`, which must not be ended now.
pub const FORGET: u8 = 0x15;
/// Ctrl-C: heater off, at once.
pub const STOP: u8 = 0x03;
/// Longest frame, bytes.
pub const FRAME: usize = 1024;

/// What becomes of a board that no computer can reach, and who can stop it.
pub const ALONE: &str = "the board goes on by itself with whatever it does, and trips by itself; its blue button stops it, and so \
                         does opening its interlock or taking its power away";
