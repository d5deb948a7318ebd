//! What must hold on the virtual board. One program, so that it is linked once and all tests share both cores.

mod boot;
mod console;
mod endurance;
mod heater_off;
mod log;
mod paper;
mod settings;
mod wraps;
