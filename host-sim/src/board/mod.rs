//! A real board at the other end of a serial port: who is there, what it says, what it is asked.

mod gate;
mod port;
pub mod record;
mod rows;
mod session;
pub mod settings;
pub mod simulate;
mod text;
mod visible;
pub mod watch;

pub use gate::Gate;
pub use port::{ALONE, Lost, find, open};
pub use session::{Heard, STOP, Session};
pub use text::{check_ended, refusal, take_lines};
