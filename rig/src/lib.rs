//! The simulated PT-326: physics in f64 that knows nothing of the instrument. It takes a drive and gives ADC codes.
//!
//! Between two ticks the drive, the air flow, the mains and the ambient temperature are constant, so every linear part is integrated
//! exactly: the heater node, its dead times (a record of past exponentials), the lags of the sensors, and the turbulence
//! as seen through them. A fault that begins or ends within a tick splits the tick; where
//! flow or power change by themselves within a tick, each part is taken in steps in which they are constant.
//!
//! Ingredients that a real rig has and the reference rig has not (`wall`, `mains`, ...) are a file and a section of settings each,
//! all off by default. One that is off draws no random numbers, and each draws from a stream of its own.
//!
//! No clock and no files: the same crate runs in a browser.

mod air;
mod config;
mod constants;
mod element;
mod fan;
pub mod fault;
mod heater;
mod mains;
mod meter;
mod noise;
mod normal;
mod pickup;
mod preset;
mod rig;
mod room;
mod sensor;
mod thermistor;
mod wall;

pub use config::{Disturbance, RigConfig};
pub use constants::{Constant, Section};
pub use fan::FanConfig;
pub use heater::HeaterConfig;
pub use mains::MainsConfig;
pub use pickup::PickupConfig;
pub use rig::{ELEMENT_OVER_AIR, Rig};
pub use room::RoomConfig;
pub use thermistor::SensorConfig;
pub use wall::WallConfig;
