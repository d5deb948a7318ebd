//! On-line identification in closed loop: recursive least squares, the ARX model on top, and what is read off the model.

pub mod arx;
pub mod config;
pub mod observer;
pub mod random_walk;
pub mod rls;
pub mod step_response;
pub mod transfer;

pub use config::{Adaptation, Bandwidth, IdentificationConfig, RlsConfig};
