//! All that touches a register. What is wired where is in one file a board; the rest follows from it.

#[cfg(all(feature = "nucleo-f411re", feature = "nucleo-f446re"))]
compile_error!("one board at a time: add --no-default-features when choosing nucleo-f446re");
#[cfg(not(any(feature = "nucleo-f411re", feature = "nucleo-f446re")))]
compile_error!("choose a board: --features nucleo-f411re or --features nucleo-f446re");

#[cfg_attr(feature = "nucleo-f411re", path = "nucleo_f411re.rs")]
#[cfg_attr(feature = "nucleo-f446re", path = "nucleo_f446re.rs")]
pub(crate) mod board;
mod nucleo_64;

pub(crate) mod clock;
pub(crate) mod control_executor;
pub(crate) mod cycles;
pub(crate) mod fault;
pub(crate) mod halt;
pub(crate) mod heater;
pub(crate) mod inputs;
mod memmove;
pub(crate) mod memory;
pub(crate) mod panel;
pub(crate) mod reset;
pub(crate) mod retained;
pub(crate) mod rtt;
pub(crate) mod serial;
pub(crate) mod settings_flash;
pub(crate) mod slow_clock;
pub(crate) mod stack;
pub(crate) mod supply;
pub(crate) mod tick_timer;
pub(crate) mod undervoltage;
pub(crate) mod watchdog;

use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};

/// Who may interrupt whom. What cuts the heater comes before the control task that it watches; the console's bytes
/// come last, so that a flood of them delays nothing that heats.
pub(crate) fn set_priorities() {
    interrupt::PVD.set_priority(Priority::P0); // the supply falls
    board::TICK_INTERRUPT.set_priority(Priority::P0); // control tick and deadline watchdog
    board::CONTROL_INTERRUPT.set_priority(Priority::P2); // control task
    board::TASK_INTERRUPT.set_priority(Priority::P4); // clock of everything else
    board::CONSOLE_INTERRUPT.set_priority(Priority::P6); // console
}
