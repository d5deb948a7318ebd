//! What the emulated target and the host both do, so that one can be held against the other.

#![cfg_attr(not(test), no_std)]

#[cfg(target_os = "none")]
pub mod board;
pub mod codes;
#[cfg(target_os = "none")]
pub mod cost;
pub mod digest;
pub mod peers;
pub mod recording;
pub mod runs;
