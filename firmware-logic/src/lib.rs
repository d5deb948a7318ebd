//! All of the firmware that is not a register, so that `cargo test` on the host covers it.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

pub mod alarm;
pub mod cadence;
pub mod calibration;
pub mod console;
pub mod control_loop;
pub mod crc;
pub mod decimal;
pub mod diagnosis_loop;
mod doubled;
pub mod duty;
pub mod explain;
pub mod finding;
pub mod history;
pub mod hold_button;
pub mod interlock;
pub mod led;
pub mod log_line;
pub mod notice;
pub mod reset_cause;
pub mod retained;
pub mod sampling;
pub mod self_test;
pub mod settings;
pub mod slow_clock;
pub mod status;
pub mod stream;
pub mod task_watchdog;
pub mod teaching;
pub mod tuning;
