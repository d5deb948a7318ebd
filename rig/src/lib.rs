//! The simulated PT-326: physics in f64 that knows nothing of the instrument. It takes a drive and gives ADC codes.
//!
//! Between two ticks the drive, the air flow, the mains and the ambient temperature are constant, so every linear part is integrated
//! exactly: the heater node, its dead times (a record of past exponentials), the lags of the sensors, and the turbulence
//! as seen through them. A fault that begins or ends within a tick splits the tick.
//!
//! Ingredients that a real rig has and the reference rig has not (`wall`, ...) are a file and a section of settings each,
//! all off by default. One that is off draws no random numbers, and each draws from a stream of its own.
//!
//! No clock and no files: the same crate runs in a browser.

mod air;
mod config;
mod element;
pub mod fault;
mod noise;
mod preset;
mod rig;
mod sensor;
mod wall;

pub use config::{Constant, Disturbance, RigConfig, Section};
pub use rig::Rig;
pub use wall::WallConfig;
