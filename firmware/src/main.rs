//! The PT-326 instrument on a NUCLEO board. On the host this prints the settings that a board starts with.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod hardware;
#[cfg(target_os = "none")]
mod link;
#[cfg(target_os = "none")]
mod log;
#[cfg(target_os = "none")]
mod panic;
#[cfg(target_os = "none")]
mod shared;
#[cfg(target_os = "none")]
mod simulation;
#[cfg(target_os = "none")]
mod start;
#[cfg(target_os = "none")]
mod tasks;

/// Prints the default settings: name, value, unit, and the bounds that the core puts on each.
#[cfg(not(target_os = "none"))]
fn main() {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    for line in firmware_logic::settings::listing::lines(&fdi_core::Config::default()) {
        if writeln!(out, "{line}").is_err() {
            break; // whoever reads it has had enough
        }
    }
}
