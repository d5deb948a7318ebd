//! The parity diagnosis: a second opinion beside the paper's signatures, faster and for more faults.

pub mod verdict;

pub use verdict::{Arming, Channel, Distrust, FaultClass, Finding, Magnitude, ParityReport};
