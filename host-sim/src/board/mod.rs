//! A real board at the other end of a serial port: who is there, what it says, what it is asked.

mod port;
pub mod record;
mod rows;
mod session;
pub mod settings;
pub mod simulate;
pub mod watch;

pub use port::{find, open};
pub use session::{Gate, Heard, STOP, Session, check_ended, refusal, take_lines};
