//! A lab session served to browsers, or several: the page, a stream of events, commands, and numbers for Prometheus; and to an MQTT broker ([`mqtt`]).
//!
//! A thread of its own keeps the session's time ([`clock`]). What it gives lies in a bounded `history` that every client reads at its own pace: a
//! slow or vanished one delays nobody, and one that comes back gets what it missed. `guard` says who may ask for what.

pub mod clock;
mod counts;
mod guard;
mod history;
mod metrics;
pub mod mqtt;
mod server;
pub mod source;
mod wall;

pub use guard::Access;
pub use server::{Server, listen};
pub use wall::Rig;
