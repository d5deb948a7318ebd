//! A real board at the other end of a serial port: who is there, what it says, what it is asked.

mod gate;
mod port;
mod session;
pub mod settings;
pub mod simulate;
pub mod watch;

pub use gate::Gate;
pub use port::{Lost, find, open};
pub use pt326_lab::board::text::{check_ended, refusal, take_lines};
pub use pt326_lab::board::{ALONE, STOP, record};
pub use session::{Heard, Session};
