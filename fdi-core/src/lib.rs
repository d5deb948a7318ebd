#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

#[cfg(feature = "tuning")]
extern crate std;

mod bounds;
pub mod config;
pub mod control;
pub mod diagnosis;
pub mod error;
pub mod feedback;
pub mod filter;
pub mod identify;
pub mod instrument;
pub mod known;
pub mod likelihood;
pub mod monitor;
pub mod name;
mod numbered;
pub mod observation;
mod root;
pub mod schema;
pub mod sense;
pub mod settings;
pub mod supervisor;
pub mod tune;
mod turn;
pub mod units;
mod vector;

pub use config::Config;
pub use control::Tick;
pub use diagnosis::Report;
pub use error::ConfigError;
pub use feedback::Feedback;
pub use instrument::{Instrument, RetuneError};
pub use known::KnownInputs;
pub use likelihood::inputs::Inputs;
pub use likelihood::{FaultClass, Finding, LikelihoodReport};
pub use monitor::{Monitor, Observed, Units};
pub use observation::{Observation, Phase};
pub use sense::{RawSample, Reading, Sample, Validity};
pub use settings::Setting;
pub use supervisor::config::SupervisorConfig;
pub use supervisor::{Command, Mode, Refusal, Trip, TripReason};
pub use units::{AdcCode, Celsius, Ohm, Percent, Seconds, Volt};
