//! The lab: the instrument and the simulated rig in a session that is talked to, the numbers that it gives on each tick, and the page that
//! shows them. `PROTOCOL.md` says what goes over the wire; the same session runs in a browser (`lab/wasm`) and behind `pt326 live`.
//!
//! No clock, no files, no threads: whoever holds a session decides when it ticks.

pub mod board;
pub mod change;
pub mod exercise;
pub mod names;
pub mod page;
pub mod preset;
pub mod protocol;
pub mod recording;
pub mod refusal;
pub mod scene;
pub mod session;
pub mod time;
pub mod told;
pub mod trace;
