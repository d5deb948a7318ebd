//! What must hold on the virtual board. One program, so that it is linked once and all tests share both cores.

mod boot;
mod brown_out;
mod check;
mod clock_speed;
mod command;
mod commission;
mod console;
mod contactor;
mod damaged;
mod debug_halt;
mod dialogue;
mod endurance;
mod erase;
mod flash;
mod flipped_bits;
mod halt;
mod heater_off;
mod host;
mod last_gasp;
mod live;
mod log;
mod paper;
mod pins;
mod process;
mod sample_time;
mod sampling;
mod self_tests;
mod settings;
mod simulated;
mod stop;
mod stream;
mod supply;
mod teach;
mod watch;
mod wraps;

/// Whether the board says that no tick was missed, and none more than a few microseconds late: what else runs at the same
/// moment moves that by one or two.
fn is_punctual(status: &str) -> bool {
    let worst = status.split("missed 0 worst ").nth(1).and_then(|rest| rest.split(" us late").next());
    worst.and_then(|us| us.parse::<u32>().ok()).is_some_and(|us| us <= 5)
}
