#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

#[cfg(feature = "tuning")]
extern crate std;

mod bounds;
pub mod config;
pub mod control;
pub mod identify;
pub mod likelihood;
mod numbered;
mod root;
mod turn;
mod vector;

// What the other crates of this project need: it may change with any version.
#[doc(hidden)]
pub mod diagnosis;
#[doc(hidden)]
pub mod error;
#[doc(hidden)]
pub mod feedback;
#[doc(hidden)]
pub mod filter;
#[doc(hidden)]
pub mod instrument;
#[doc(hidden)]
pub mod known;
#[doc(hidden)]
pub mod monitor;
#[doc(hidden)]
pub mod name;
#[doc(hidden)]
pub mod observation;
#[doc(hidden)]
pub mod schema;
#[doc(hidden)]
pub mod sense;
#[doc(hidden)]
pub mod settings;
#[doc(hidden)]
pub mod supervisor;
#[doc(hidden)]
pub mod tune;
#[doc(hidden)]
pub mod units;

pub use config::Config;
pub use control::Tick;
pub use diagnosis::Report;
pub use diagnosis::baseline::Baseline;
pub use error::ConfigError;
pub use feedback::Feedback;
pub use instrument::{Instrument, RetuneError};
pub use known::KnownInputs;
pub use likelihood::inputs::Inputs;
pub use likelihood::{FaultClass, Finding, LikelihoodReport};
pub use monitor::{Monitor, Observed, Units};
pub use name::Name;
pub use observation::{Observation, Phase};
pub use sense::{RawSample, Reading, Sample, Validity};
pub use settings::Setting;
pub use supervisor::config::SupervisorConfig;
pub use supervisor::{Command, Mode, Refusal, Trip, TripReason};
pub use units::{AdcCode, Celsius, Ohm, Percent, Seconds, Volt};
