//! The instrument in closed loop with the simulated rig.

mod board_loop;
mod commissioned;
mod contradiction;
mod heat;
mod known;
mod likelihood;
mod limits;
mod micromath;
mod plants;
mod scenarios;
mod search;
mod still_air;
mod taught;
mod tuning;
